#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/sonar/polar_image.hpp"

namespace pingvox {

/// A sweep as it lies in the water, seen from above: ahead (x) is up, left (y) is left.
struct CartesianImage {
  std::size_t size_px = 0;           ///< width and height
  double pixel_m = 0.0;              ///< edge of a pixel
  std::vector<std::uint8_t> pixels;  ///< row by row from the top; 0 where nothing was heard

  /// Where the middle of a pixel is in the sensor's frame. The head is in the middle of the image.
  double x_m(std::size_t row) const {
    return (0.5 * static_cast<double>(size_px) - static_cast<double>(row) - 0.5) * pixel_m;
  }
  double y_m(std::size_t column) const {
    return (0.5 * static_cast<double>(size_px) - static_cast<double>(column) - 0.5) * pixel_m;
  }
  std::uint8_t at(std::size_t row, std::size_t column) const { return pixels[row * size_px + column]; }
};

/// What is drawn between the axes of two beams.
enum class BetweenBeams {
  kNothing,      ///< each bin is a dot on its axis (paper, figure 2)
  kInterpolate,  ///< the beams that reach there, weighted by how near their axes are (figure 4)
};

struct CartesianOptions {
  BetweenBeams between = BetweenBeams::kInterpolate;
  std::size_t size_px = 800;          ///< 16..8192
  double beam_width_rad = 0.0523599;  ///< full angle that a beam reaches over, > 0, at most 2 pi

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Draws a sweep out to the range of its longest beam.
/// - kInterpolate: a pixel takes, from each beam whose axis is less than half a width away, the bin at its range, and
///   weights it with 1 at the axis falling to 0 at half a width. Where the beams are farther apart than that, nothing
///   is known and it stays 0.
/// - kNothing: the loudest bin whose middle lies in the pixel.
/// @param image  the sweep's image, filtered or not
/// REQUIRES valid options, image.rows() == sweep.beams.size()
CartesianImage cartesian_image(const PolarImage& image, const Sweep& sweep, const CartesianOptions& options);

}  // namespace pingvox
