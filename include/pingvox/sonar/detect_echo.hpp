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
  std::size_t first = 0;        ///< bin where it rises
  std::size_t peak = 0;         ///< its strongest bin (the nearest one of several)
  std::size_t last = 0;         ///< its last bin
  double range_m = 0.0;         ///< where we take the wall to be, from the transducer
  std::uint8_t intensity = 0;   ///< of the peak, 0..255, as it was detected (after filtering)
};

enum class Detector { kRise };

struct EchoOptions {
  Detector detector = Detector::kRise;
  double min_range_m = 0.75;  ///< the blanking range: nearer bins are the vehicle and the ringing transducer
  double max_range_m = std::numeric_limits<double>::infinity();
  int threshold = 70;  ///< kRise: the least difference of successive bins, 1..255

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// The first echo of each beam (paper, section 8.2): one per row of the image. No echo is none, not an echo at maximum
/// range; a falling edge is none either.
/// @param image  the sweep's image, filtered or not
/// @param sweep  the sweep it was made of (its bin lengths turn bins into metres)
/// REQUIRES valid options, image.rows() == sweep.beams.size()
std::vector<std::optional<Echo>> detect_echoes(const PolarImage& image, const Sweep& sweep, const EchoOptions& options);

}  // namespace pingvox
