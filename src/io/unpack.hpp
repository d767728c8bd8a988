#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pingvox {

/// Compression of the chunks of a bag.
enum class Compression { kNone, kBz2, kLz4, kZstd };

/// The largest chunk that is unpacked.
inline constexpr std::uint64_t kMaxChunk = std::uint64_t{1} << 30;

struct Unpacked {
  bool is_whole = false;   ///< else `to` holds the beginning as far as it could be unpacked
  std::size_t packed = 0;  ///< bytes that were needed; an end mark may follow
};

/// Unpacks `packed` (lz4: frames) to exactly `size` bytes in `to`, unless the data are damaged or `size` is out of
/// proportion to them. REQUIRES a compression other than kNone.
Unpacked unpack(Compression compression, std::span<const std::uint8_t> packed, std::uint64_t size,
                std::vector<std::uint8_t>& to);

}  // namespace pingvox
