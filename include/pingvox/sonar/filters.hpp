#pragma once

#include <cstddef>

#include "pingvox/result.hpp"
#include "pingvox/sonar/polar_image.hpp"

namespace pingvox {

enum class Filter {
  kNone,
  kMean,      ///< all of the window alike
  kMedian,    ///< of the window: a single bright bin vanishes, an edge stays sharp
  kGaussian,  ///< the window weighted by the distance from its middle
};

struct FilterOptions {
  Filter filter = Filter::kGaussian;
  int kernel = 5;      ///< edge of the square window, in beams and bins; odd, 1..99
  double sigma = 1.0;  ///< kGaussian: standard deviation [beams, bins], > 0, at most 1000

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// The smoothed image (paper, section 8.1), in polar coordinates: across the seam of a full turn it sees the beams on
/// the other side, at the ends of a sector and of a beam it repeats the outermost value. Where beams are of different
/// lengths, the bins that one lacks count as those of the nearest beam that has them, no more than half a kernel away,
/// and beyond that as its own last one. REQUIRES valid options.
PolarImage filtered(const PolarImage& image, const FilterOptions& options);

/// How many beams to either side decide what `filtered` makes of one: half a kernel, and as many again that fill up the
/// bins that shorter ones among them lack.
std::size_t reach_beams(const FilterOptions& options);

}  // namespace pingvox
