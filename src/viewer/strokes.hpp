#pragma once

#include <cstddef>

#include "pingvox/viewer/picture.hpp"

namespace pingvox {

/// A place between pixels: (0, 0) is the upper left corner of the picture, (0.5, 0.5) the middle of its first pixel.
struct Spot {
  double x = 0.0, y = 0.0;
};

/// Pixels of a picture.
struct Area {
  std::ptrdiff_t x = 0, y = 0, width = 0, height = 0;

  std::ptrdiff_t right() const { return x + width; }
  std::ptrdiff_t bottom() const { return y + height; }
};

/// A mark that is told from others by its shape.
enum class Marker { kDisc, kSquare, kTriangle, kDiamond, kRing, kCross, kPlus };

/// A straight line with round ends and soft edges, drawn as far as it lies in `within`. REQUIRES finite spots.
void draw_line(Picture& picture, Spot from, Spot to, double width, Rgb colour, const Area& within);

/// A circle's line, drawn as far as it lies in `within`; `share` of the colour covers what is below.
void draw_circle(Picture& picture, Spot middle, double radius, double width, Rgb colour, double share,
                 const Area& within);

/// A filled disc.
void draw_disc(Picture& picture, Spot middle, double radius, Rgb colour);

/// A mark about 2 `radius` wide.
void draw_marker(Picture& picture, Marker marker, Spot middle, double radius, Rgb colour);

/// A frame around an area, outside of it.
void draw_frame(Picture& picture, const Area& area, std::ptrdiff_t thickness, Rgb colour);

/// Copies a picture into another, its upper left pixel to (x, y), as far as it fits.
void paste(Picture& into, const Picture& from, std::ptrdiff_t x, std::ptrdiff_t y);

}  // namespace pingvox
