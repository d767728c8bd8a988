#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/sonar/polar_image.hpp"

namespace pingvox {

/// A sweep seen from above: ahead (x) is up, left (y) is left.
struct CartesianImage {
  std::size_t size_px = 0;           ///< width and height
  double pixel_m = 0.0;              ///< edge of a pixel
  std::vector<std::uint8_t> pixels;  ///< row by row from the top; 0 where no beam reaches

  /// Centre of a pixel in the sensor frame. The head is at the centre of the image.
  double x_m(std::size_t row) const {
    return (0.5 * static_cast<double>(size_px) - static_cast<double>(row) - 0.5) * pixel_m;
  }
  double y_m(std::size_t column) const {
    return (0.5 * static_cast<double>(size_px) - static_cast<double>(column) - 0.5) * pixel_m;
  }
  std::uint8_t at(std::size_t row, std::size_t column) const { return pixels[row * size_px + column]; }
};

/// How the space between the axes of two beams is filled.
enum class BetweenBeams {
  kNothing,      ///< each bin is a dot on its axis (paper, figure 2)
  kInterpolate,  ///< mean of the beams that reach there, weighted by the angle to their axes (figure 4)
};

struct CartesianOptions {
  BetweenBeams between = BetweenBeams::kInterpolate;
  std::size_t size_px = 800;          ///< 16..8192
  double beam_width_rad = 0.0523599;  ///< full angle that a beam covers, > 0, at most 2 pi

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// How far from its axis a beam of the sweep is drawn [rad]: half its width, or the usual step to the next beam where
/// that is more (up to 12 degrees), so that heads with coarse steps leave no gaps.
double drawn_reach_rad(const Sweep& sweep, double beam_width_rad);

/// Draws a sweep out to the range of its longest beam.
/// - kInterpolate: mean of the bins at the pixel's range of all beams whose axis is less than drawn_reach_rad away; the
///   weight falls from 1 at the axis to 0 there. Pixels that no beam reaches are 0.
/// - kNothing: the strongest bin whose centre lies in the pixel.
/// @param image  the sweep's image, filtered or not
/// REQUIRES valid options, image.rows() == sweep.beams.size()
CartesianImage cartesian_image(const PolarImage& image, const Sweep& sweep, const CartesianOptions& options);

}  // namespace pingvox
