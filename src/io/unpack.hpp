#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace pingvox {

/// Compression of the chunks of a bag.
enum class Compression { kNone, kBz2, kLz4, kZstd };

/// The largest chunk that is unpacked.
inline constexpr std::uint64_t kMaxChunk = std::uint64_t{1} << 30;

/// Unpacks `packed` (lz4: frames) to exactly `size` bytes in `to`.
/// @return false when the data are damaged or `size` is out of proportion to them; then `to` holds the beginning as far
///         as it could be unpacked. REQUIRES a compression other than kNone.
bool unpack(Compression compression, std::span<const std::uint8_t> packed, std::uint64_t size,
            std::vector<std::uint8_t>& to);

}  // namespace pingvox
