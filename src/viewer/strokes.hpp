#pragma once

#include <cstddef>

#include "pingvox/viewer/picture.hpp"

namespace pingvox {

/// Subpixel position: (0, 0) is the upper left corner of the picture, (0.5, 0.5) the centre of its first pixel.
struct Spot {
  double x = 0.0, y = 0.0;
};

/// A rectangle of pixels.
struct Area {
  std::ptrdiff_t x = 0, y = 0, width = 0, height = 0;

  std::ptrdiff_t right() const { return x + width; }
  std::ptrdiff_t bottom() const { return y + height; }
};

/// Shape of a marker.
enum class Marker { kDisc, kSquare, kTriangle, kDiamond, kRing, kCross, kPlus };

/// An antialiased line with round ends, clipped to `within`. REQUIRES finite spots.
void draw_line(Picture& picture, Spot from, Spot to, double width, Rgb colour, const Area& within);

/// An antialiased circle, clipped to `within`; `share` is its opacity.
void draw_circle(Picture& picture, Spot middle, double radius, double width, Rgb colour, double share,
                 const Area& within);

/// A filled disc.
void draw_disc(Picture& picture, Spot middle, double radius, Rgb colour);

/// A marker about 2 `radius` wide.
void draw_marker(Picture& picture, Marker marker, Spot middle, double radius, Rgb colour);

/// A frame around the outside of an area.
void draw_frame(Picture& picture, const Area& area, std::ptrdiff_t thickness, Rgb colour);

/// Copies a picture into another at (x, y), clipped.
void paste(Picture& into, const Picture& from, std::ptrdiff_t x, std::ptrdiff_t y);

}  // namespace pingvox
