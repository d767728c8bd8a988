#include "pingvox/viewer/render_mosaic.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace pingvox {

GreyPicture render_mosaic(const Raster<float>& mosaic, PictureUp up, double gamma) {
  assert(gamma > 0.0 && std::isfinite(gamma));
  constexpr double kWhite = 255.0;
  const bool is_y_up = up == PictureUp::kY;
  GreyPicture picture{mosaic.columns, mosaic.rows, {}};
  if (!is_y_up) std::swap(picture.width, picture.height);
  picture.grey_alpha.reserve(2 * picture.width * picture.height);
  for (std::size_t row = 0; row < picture.height; ++row) {
    for (std::size_t column = 0; column < picture.width; ++column) {
      const std::size_t down = picture.height - 1 - row, left = picture.width - 1 - column;
      const float intensity = is_y_up ? mosaic.at(column, down) : mosaic.at(down, left);
      const double share = std::isnan(intensity) ? 0.0 : std::clamp(static_cast<double>(intensity) / kWhite, 0.0, 1.0);
      picture.grey_alpha.push_back(static_cast<std::uint8_t>(std::lround(kWhite * std::pow(share, gamma))));
      picture.grey_alpha.push_back(std::isnan(intensity) ? 0 : static_cast<std::uint8_t>(kWhite));
    }
  }
  return picture;
}

}  // namespace pingvox
