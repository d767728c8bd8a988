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

/// The same of a picture in grey: its lightness, and how opaque it is, two bytes a pixel.
/// REQUIRES 0 < width, height < 2^31, grey_alpha.size() == 2 * width * height
Result<void> write_grey_png(std::size_t width, std::size_t height, std::span<const std::uint8_t> grey_alpha,
                            std::ostream& out);

}  // namespace pingvox
