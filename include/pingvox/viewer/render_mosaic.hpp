#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pingvox/geometry/raster.hpp"
#include "pingvox/io/grids.hpp"

namespace pingvox {

/// A picture in grey; what is not known is transparent.
struct GreyPicture {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> grey_alpha;  ///< lightness, then 255 or 0; rows from the top
};

/// Draws the intensities of a mosaic, 0..255, a pixel each: lightness is (intensity / 255)^gamma, as in
/// EchoPictureOptions. REQUIRES gamma > 0, finite
GreyPicture render_mosaic(const Raster<float>& mosaic, PictureUp up, double gamma);

}  // namespace pingvox
