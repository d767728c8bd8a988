#pragma once

#include "pingvox/sonar/polar_image.hpp"

namespace pingvox {

/// How far the head hears itself: what stands near the transducer in (nearly) every beam, and the fading of it, out to
/// where the typical beam falls no further. At most half of the range; 0 when there is nothing of the kind.
/// EchoOptions::kUsualBlanking_m for fewer than 32 beams: what is in all of so few may be a wall.
/// @param image  the sweep's image, filtered or not
/// REQUIRES image.rows() == sweep.beams.size()
double blanking_range_m(const PolarImage& image, const Sweep& sweep);

}  // namespace pingvox
