#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace pingvox {

/// The most bytes that LZF makes of one: three say to repeat 264.
inline constexpr std::size_t kLzfMaxExpansion = 264 / 3;

/// Undoes LZF (Marc Lehmann's liblzf), with which PCL compresses point clouds.
/// @return whether `compressed` is whole and filled exactly `out`
bool lzf_decompress(std::span<const std::uint8_t> compressed, std::span<std::uint8_t> out);

}  // namespace pingvox
