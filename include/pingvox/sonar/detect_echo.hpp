#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/sonar/polar_image.hpp"

namespace pingvox {

/// The detected return of one beam: the run of bins that it was found in.
struct Echo {
  std::size_t first = 0;       ///< bin where it was detected
  std::size_t peak = 0;        ///< its strongest bin (the nearest one of several)
  std::size_t last = 0;        ///< its last bin
  double range_m = 0.0;        ///< where we take the wall to be, from the transducer: the middle of the crest
  std::uint8_t intensity = 0;  ///< of the peak, 0..255, as it was detected (after filtering)
};

enum class Detector {
  /// Differences of successive bins, as in the paper (section 8.2), summed over a rise: a bin is an echo's first when
  /// the differences from bin to bin, added up since the last valley, reach the threshold. Without noise and smoothing
  /// a wall rises in one step, and the sum is that one difference. A real wall rises over some ten bins (pulse,
  /// slanting beam, smoothing): of the smoothed tank recording no beam has a single difference of 70, few one of 35.
  /// A rise, before and after it is detected, goes on across dips and ends where the beam has fallen by more than half
  /// the threshold below its top: speckle stays inside the echo, and a falling edge starts none. The echo runs from its
  /// first bin to the last one before that fall. Its range is the middle of its crest: the mean of its bins, weighted
  /// with what they stand above a quarter of the threshold below the peak.
  kRise,
};

struct EchoOptions {
  Detector detector = Detector::kRise;
  double min_range_m = 0.75;  ///< the blanking range: nearer bins are the vehicle and the ringing transducer
  double max_range_m = std::numeric_limits<double>::infinity();
  int threshold = 70;  ///< kRise: the least sum of differences of successive bins over a rise, 1..255

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// The first echo of each beam (paper, section 8.2): one per row of the image. No echo is none, not an echo at maximum
/// range; a falling edge is none either. Only bins that lie between the minimum and the maximum range as a whole are
/// evidence: what stands in others changes nothing.
/// @param image  the sweep's image, filtered or not
/// @param sweep  the sweep it was made of (each beam's own bin length turns its bins into metres)
/// REQUIRES valid options, image.rows() == sweep.beams.size()
std::vector<std::optional<Echo>> detect_echoes(const PolarImage& image, const Sweep& sweep, const EchoOptions& options);

}  // namespace pingvox
