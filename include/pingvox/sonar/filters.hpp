#pragma once

#include <cstddef>

#include "pingvox/result.hpp"
#include "pingvox/sonar/polar_image.hpp"

namespace pingvox {

enum class Filter {
  kNone,
  kMean,      ///< mean of the window
  kMedian,    ///< median of the window: removes single bright bins, keeps edges sharp
  kGaussian,  ///< weighted by the distance from the centre
};

struct FilterOptions {
  Filter filter = Filter::kGaussian;
  int kernel = 5;      ///< edge of the square window, in beams and bins; odd, 1..99
  double sigma = 1.0;  ///< kGaussian: standard deviation [beams, bins], > 0, at most 1000

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Smooths a polar image (paper, section 8.1). A full turn wraps around; at the ends of a sector and of a beam the
/// outermost value is repeated. Bins that a shorter beam lacks are taken from the nearest beam within half a kernel
/// that has them, else its own last bin is repeated. REQUIRES valid options.
PolarImage apply_filter(const PolarImage& image, const FilterOptions& options);

/// How many beams to either side decide the filtered row of one: half a kernel, and as many again that fill the
/// bins that shorter beams lack.
std::size_t reach_beams(const FilterOptions& options);

}  // namespace pingvox
