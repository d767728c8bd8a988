#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pingvox/sonar/polar_image.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox {

/// Beams to either side whose mean separates a near wall from speckle: more than a filter joins.
inline constexpr std::size_t kNearFieldReach_beams = 4;

/// Means of a beam and those around it that have bins as long, of bins [first, end).
/// REQUIRES first <= end <= image.bins_in(beam)
std::vector<std::uint8_t> mean_of_beams(const PolarImage& image, const Sweep& sweep, std::size_t beam,
                                        std::size_t first, std::size_t end);

/// How far behind the blanking range a near wall may begin: no head sends a pulse that long. Where the bins are still
/// loud beyond, as in the long echo of a bottom, the mean rises and falls without walls: all twelve near walls of our
/// recordings that began there were false.
inline constexpr double kNearWalls_m = 1.75;

/// The loud bins next to the blanking range: ringing that goes on beyond it, reverberation, or a near wall whose echo
/// begins within it.
struct NearField {
  std::vector<std::uint8_t> mean;  ///< of the beams around, all bins
  int level = 0;                   ///< lowest intensity of a loud bin
  std::size_t ringing_end = 0;     ///< end of the first loud bins of the mean
  std::size_t begin = 0,
              end = 0;  ///< of the loud bins next to the blanking range; those of the ringing: begin < ringing_end
  std::size_t walls_end = 0;  ///< of those where a near wall may begin
};

/// @param mean          of the beams around, all bins
/// @param nearest       first bin beyond the blanking range. REQUIRES mean[nearest] >= level
/// @param level         lowest intensity of a loud bin
/// @param bin_length_m  of the beam
NearField near_field_of(std::vector<std::uint8_t> mean, std::size_t nearest, int level, double bin_length_m);

}  // namespace pingvox
