#pragma once

#include "pingvox/result.hpp"
#include "pingvox/sonar/polar_image.hpp"

namespace pingvox {

enum class Filter { kNone, kGaussian };

struct FilterOptions {
  Filter filter = Filter::kGaussian;
  int kernel = 5;      ///< edge of the square window, in beams and bins; odd, 1..99
  double sigma = 1.0;  ///< standard deviation of the Gaussian [beams, bins], > 0, at most 1000

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// The smoothed image (paper, section 8.1), in polar coordinates: across the seam of a full turn it sees the beams on
/// the other side, at the ends of a sector and of a beam it repeats the outermost value. Where beams are of different
/// lengths, the bins that one lacks count as those of the nearest beam that has them. REQUIRES valid options.
PolarImage filtered(const PolarImage& image, const FilterOptions& options);

}  // namespace pingvox
