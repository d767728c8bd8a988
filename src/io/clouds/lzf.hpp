#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace pingvox {

/// Maximum expansion of a byte: three bytes encode a copy of 264.
inline constexpr std::size_t kLzfMaxExpansion = 264 / 3;

/// Decompresses LZF (Marc Lehmann's liblzf), used by PCL.
/// @return whether `compressed` is valid and fills `out` exactly
bool lzf_decompress(std::span<const std::uint8_t> compressed, std::span<std::uint8_t> out);

}  // namespace pingvox
