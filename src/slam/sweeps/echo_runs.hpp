#pragma once

#include <vector>

#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox {

/// A run of bins in which something reflected.
struct EchoRun {
  /// What its place is.
  enum class Place {
    kMiddle,  ///< the middle of the run: nobody knows where in it the wall is
    kCrest,   ///< the wall by its intensities, see Echo::range_m
  };
  double time_s = 0.0;
  double bearing_rad = 0.0;    ///< in the frame of the sonar
  double range_m = 0.0;        ///< of its place
  double half_length_m = 0.0;  ///< half of its length along the beam
  Place place = Place::kMiddle;
};

/// The echoes of a sweep, in the order of its beams. In a sweep with intensities one for each beam that has one; of one
/// that was thresholded already the two longest runs of each beam.
/// REQUIRES valid options.
std::vector<EchoRun> echo_runs(const Sweep& sweep, const FilterOptions& filter, const EchoOptions& echo);

}  // namespace pingvox
