#include "pingvox/viewer/picture.hpp"

#include <algorithm>

namespace pingvox {

Picture::Picture(std::size_t width, std::size_t height, Rgb colour)
    : width_(width), height_(height), rgb_(width * height * 3) {
  assert(width > 0 && width <= kMaxSide && height > 0 && height <= kMaxSide);
  fill(0, 0, static_cast<std::ptrdiff_t>(width), static_cast<std::ptrdiff_t>(height), colour);
}

Rgb Picture::at(std::size_t x, std::size_t y) const {
  assert(x < width_ && y < height_);
  const std::uint8_t* const pixel = rgb_.data() + (y * width_ + x) * 3;
  return {pixel[0], pixel[1], pixel[2]};
}

void Picture::set(std::ptrdiff_t x, std::ptrdiff_t y, Rgb colour) {
  fill(x, y, 1, 1, colour);
}

void Picture::fill(std::ptrdiff_t x, std::ptrdiff_t y, std::ptrdiff_t width, std::ptrdiff_t height, Rgb colour) {
  const auto right = std::min(x + width, static_cast<std::ptrdiff_t>(width_));
  const auto bottom = std::min(y + height, static_cast<std::ptrdiff_t>(height_));
  for (std::ptrdiff_t row = std::max<std::ptrdiff_t>(y, 0); row < bottom; ++row) {
    for (std::ptrdiff_t column = std::max<std::ptrdiff_t>(x, 0); column < right; ++column) {
      std::uint8_t* const pixel =
          rgb_.data() + (static_cast<std::size_t>(row) * width_ + static_cast<std::size_t>(column)) * 3;
      pixel[0] = colour.red;
      pixel[1] = colour.green;
      pixel[2] = colour.blue;
    }
  }
}

}  // namespace pingvox
