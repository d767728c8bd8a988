#pragma once

#include <cstddef>
#include <vector>

#include "pingvox/sonar/polar_image.hpp"
#include "sonar/bin_window.hpp"

namespace pingvox {

/// The bins over which a rise is measured: longer than any wall's; a background that grows with the range is none.
inline constexpr std::size_t kRise_bins = 48;

/// How many beams to either side decide about one beam's contrast.
inline constexpr std::size_t kContrastReach_beams = 16;

/// The rise of intensity that makes an echo, by the gain that each beam was heard with: half of the largest rise of
/// the beams around it (their upper quartile), which is about 70 in the paper's recording. Where that is not 9.7 times
/// the noise (the median difference of bins six apart), or the middle one of their rises not 8.5 times, most beams hear
/// only noise, and an echo needs a rise of 15 times the noise. 14 or more.
std::vector<int> usual_contrasts(const PolarImage& image, const std::vector<BinWindow>& windows);

}  // namespace pingvox
