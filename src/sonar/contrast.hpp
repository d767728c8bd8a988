#pragma once

#include <vector>

#include "pingvox/sonar/polar_image.hpp"
#include "sonar/bin_window.hpp"

namespace pingvox {

/// Contrast of each beam: the rise of intensity that makes an echo at the beam's gain. Half of the upper quartile of
/// the largest rises of the beams around, about 70 in the paper's recording. If that quartile is below 9.7 times the
/// noise (median difference of bins six apart), or the median rise below 8.5 times, most beams hold only noise, and the
/// contrast is 15 times the noise. At least 14.
std::vector<int> contrasts_by_gain(const PolarImage& image, const std::vector<BinWindow>& windows);

}  // namespace pingvox
