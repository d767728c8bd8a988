#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <vector>

#include "pingvox/io/png.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// A colour as screens show it (sRGB).
struct Rgb {
  std::uint8_t red = 0, green = 0, blue = 0;
  friend constexpr bool operator==(const Rgb&, const Rgb&) = default;
};

/// A picture of pixels; (0, 0) is the upper left one.
class Picture {
 public:
  /// No picture that we draw is wider or higher.
  static constexpr std::size_t kMaxSide = 4096;

  /// REQUIRES 0 < width, height <= kMaxSide
  Picture(std::size_t width, std::size_t height, Rgb colour);

  std::size_t width() const { return width_; }
  std::size_t height() const { return height_; }
  /// Red, green, blue; rows from the top.
  std::span<const std::uint8_t> rgb() const { return rgb_; }

  /// REQUIRES a pixel of the picture.
  Rgb at(std::size_t x, std::size_t y) const;
  /// Colours one pixel; outside of the picture nothing happens.
  void set(std::ptrdiff_t x, std::ptrdiff_t y, Rgb colour);
  /// Colours a rectangle, as far as it lies in the picture.
  void fill(std::ptrdiff_t x, std::ptrdiff_t y, std::ptrdiff_t width, std::ptrdiff_t height, Rgb colour);

 private:
  std::size_t width_, height_;
  std::vector<std::uint8_t> rgb_;
};

/// kIo when the stream does not take it.
inline Result<void> write_png(const Picture& picture, std::ostream& out) {
  return write_png(picture.width(), picture.height(), picture.rgb(), out);
}

}  // namespace pingvox
