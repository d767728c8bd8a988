#include "viewer/strokes.hpp"

#include <algorithm>
#include <cmath>

#include "viewer/colours.hpp"

namespace pingvox {
namespace {

Area whole(const Picture& picture) {
  return {0, 0, static_cast<std::ptrdiff_t>(picture.width()), static_cast<std::ptrdiff_t>(picture.height())};
}

/// Fills a shape given by `inside` (signed distance to its edge in pixels, positive inside), with antialiasing.
template <class Inside>
void paint(Picture& picture, Spot least, Spot most, const Area& within, Rgb colour, double share, Inside inside) {
  const Area all = whole(picture);
  const auto first = [](double at, std::ptrdiff_t a, std::ptrdiff_t b) {
    return static_cast<std::ptrdiff_t>(std::clamp(std::floor(at), static_cast<double>(a), static_cast<double>(b)));
  };
  const std::ptrdiff_t left = std::max(all.x, within.x), top = std::max(all.y, within.y);
  const std::ptrdiff_t right = std::max(left, std::min(all.right(), within.right()));
  const std::ptrdiff_t bottom = std::max(top, std::min(all.bottom(), within.bottom()));
  const std::ptrdiff_t end_x = first(most.x + 2.0, left, right), end_y = first(most.y + 2.0, top, bottom);
  for (std::ptrdiff_t y = first(least.y - 1.0, top, bottom); y < end_y; ++y) {
    for (std::ptrdiff_t x = first(least.x - 1.0, left, right); x < end_x; ++x) {
      const double covered =
          std::clamp(inside(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5) + 0.5, 0.0, 1.0) * share;
      if (!(covered > 0.0)) continue;
      const Rgb below = picture.at(static_cast<std::size_t>(x), static_cast<std::size_t>(y));
      picture.set(x, y, mix(below, colour, covered));
    }
  }
}

/// One side of a convex polygon around the origin: its normal and distance.
struct Side {
  double x, y, out;
};

template <std::size_t N>
double inside_of(const Side (&sides)[N], double x, double y) {
  double nearest = sides[0].out - sides[0].x * x - sides[0].y * y;
  for (const Side& side : sides) nearest = std::min(nearest, side.out - side.x * x - side.y * y);
  return nearest;
}

}  // namespace

void draw_line(Picture& picture, Spot from, Spot to, double width, Rgb colour, const Area& within) {
  const double along_x = to.x - from.x, along_y = to.y - from.y;
  const double length2 = along_x * along_x + along_y * along_y;
  const double half = 0.5 * width;
  const Spot least{std::min(from.x, to.x) - half, std::min(from.y, to.y) - half};
  const Spot most{std::max(from.x, to.x) + half, std::max(from.y, to.y) + half};
  paint(picture, least, most, within, colour, 1.0, [&](double x, double y) {
    const double along = length2 > 0.0 ? ((x - from.x) * along_x + (y - from.y) * along_y) / length2 : 0.0;
    const double share = std::clamp(along, 0.0, 1.0);
    return half - std::hypot(x - from.x - share * along_x, y - from.y - share * along_y);
  });
}

void draw_circle(Picture& picture, Spot middle, double radius, double width, Rgb colour, double share,
                 const Area& within) {
  const double out = radius + 0.5 * width;
  paint(picture, {middle.x - out, middle.y - out}, {middle.x + out, middle.y + out}, within, colour, share,
        [&](double x, double y) { return 0.5 * width - std::abs(std::hypot(x - middle.x, y - middle.y) - radius); });
}

void draw_disc(Picture& picture, Spot middle, double radius, Rgb colour) {
  paint(picture, {middle.x - radius, middle.y - radius}, {middle.x + radius, middle.y + radius}, whole(picture), colour,
        1.0, [&](double x, double y) { return radius - std::hypot(x - middle.x, y - middle.y); });
}

void draw_marker(Picture& picture, Marker marker, Spot middle, double radius, Rgb colour) {
  const Area all = whole(picture);
  const auto shape = [&](const auto& sides) {
    paint(picture, {middle.x - 1.5 * radius, middle.y - 1.5 * radius},
          {middle.x + 1.5 * radius, middle.y + 1.5 * radius}, all, colour, 1.0,
          [&](double x, double y) { return inside_of(sides, x - middle.x, y - middle.y); });
  };
  const auto strokes = [&](double dx, double dy) {
    const double width = 0.6 * radius;
    draw_line(picture, {middle.x - dx, middle.y - dy}, {middle.x + dx, middle.y + dy}, width, colour, all);
    draw_line(picture, {middle.x - dy, middle.y + dx}, {middle.x + dy, middle.y - dx}, width, colour, all);
  };
  constexpr double kDiagonal = 0.70710678118654752;
  switch (marker) {
    case Marker::kDisc:
      return draw_disc(picture, middle, radius, colour);
    case Marker::kSquare: {
      const double out = 0.88 * radius;
      const Side sides[] = {{1, 0, out}, {-1, 0, out}, {0, 1, out}, {0, -1, out}};
      return shape(sides);
    }
    case Marker::kTriangle: {
      constexpr double kSlope = 0.8660254037844386;
      const Side sides[] = {{0, 1, 0.65 * radius}, {kSlope, -0.5, 0.65 * radius}, {-kSlope, -0.5, 0.65 * radius}};
      return shape(sides);
    }
    case Marker::kDiamond: {
      const double out = 0.85 * radius;
      const Side sides[] = {{kDiagonal, kDiagonal, out},
                            {-kDiagonal, kDiagonal, out},
                            {kDiagonal, -kDiagonal, out},
                            {-kDiagonal, -kDiagonal, out}};
      return shape(sides);
    }
    case Marker::kRing:
      draw_disc(picture, middle, radius, kPaper);
      return draw_circle(picture, middle, 0.8 * radius, 0.45 * radius, colour, 1.0, all);
    case Marker::kCross:
      return strokes(0.8 * radius, 0.8 * radius);
    case Marker::kPlus:
      return strokes(radius, 0.0);
  }
}

void draw_frame(Picture& picture, const Area& area, std::ptrdiff_t thickness, Rgb colour) {
  picture.fill(area.x - thickness, area.y - thickness, area.width + 2 * thickness, thickness, colour);
  picture.fill(area.x - thickness, area.bottom(), area.width + 2 * thickness, thickness, colour);
  picture.fill(area.x - thickness, area.y, thickness, area.height, colour);
  picture.fill(area.right(), area.y, thickness, area.height, colour);
}

void paste(Picture& into, const Picture& from, std::ptrdiff_t x, std::ptrdiff_t y) {
  for (std::size_t row = 0; row < from.height(); ++row) {
    for (std::size_t column = 0; column < from.width(); ++column) {
      into.set(x + static_cast<std::ptrdiff_t>(column), y + static_cast<std::ptrdiff_t>(row), from.at(column, row));
    }
  }
}

}  // namespace pingvox
