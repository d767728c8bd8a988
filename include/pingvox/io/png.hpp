#pragma once

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>

#include "pingvox/result.hpp"

namespace pingvox {

/// Writes a picture as PNG, 8 bits a channel, compressed for speed.
/// @param rgb  rows from the top, pixels from the left, red, green, blue
/// @return kIo when `out` fails
/// REQUIRES 0 < width, height < 2^31, rgb.size() == 3 * width * height
Result<void> write_png(std::size_t width, std::size_t height, std::span<const std::uint8_t> rgb, std::ostream& out);

}  // namespace pingvox
