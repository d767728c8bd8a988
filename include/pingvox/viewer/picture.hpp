#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <vector>

#include "pingvox/io/png.hpp"
#include "pingvox/limits.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// An sRGB colour.
struct Rgb {
  std::uint8_t red = 0, green = 0, blue = 0;
  friend constexpr bool operator==(const Rgb&, const Rgb&) = default;
};

/// What the size of a drawing may be, without axes and legend.
inline constexpr Limits kPictureSizes_px{16.0, 3072.0};

/// An image; (0, 0) is its upper left pixel.
class Picture {
 public:
  /// Maximum width and height.
  static constexpr std::size_t kMaxSide = 4096;

  /// REQUIRES 0 < width, height <= kMaxSide
  Picture(std::size_t width, std::size_t height, Rgb colour);

  std::size_t width() const { return width_; }
  std::size_t height() const { return height_; }
  /// Red, green, blue; rows from the top.
  std::span<const std::uint8_t> rgb() const { return rgb_; }

  /// REQUIRES a pixel of the picture.
  Rgb at(std::size_t x, std::size_t y) const;
  /// Sets one pixel; ignored outside of the picture.
  void set(std::ptrdiff_t x, std::ptrdiff_t y, Rgb colour);
  /// Fills a rectangle, clipped to the picture.
  void fill(std::ptrdiff_t x, std::ptrdiff_t y, std::ptrdiff_t width, std::ptrdiff_t height, Rgb colour);

 private:
  std::size_t width_, height_;
  std::vector<std::uint8_t> rgb_;
};

/// @return kIo when `out` fails
inline Result<void> write_png(const Picture& picture, std::ostream& out) {
  return write_png(picture.width(), picture.height(), picture.rgb(), out);
}

}  // namespace pingvox
