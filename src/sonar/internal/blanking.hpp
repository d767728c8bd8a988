#pragma once

#include "pingvox/sonar/polar_image.hpp"

namespace pingvox {

/// Blanking range [m] measured from a sweep: the ringing that nearly every beam has near the transducer, and its decay,
/// out to where the median beam stops falling. At most half of the range; 0 if there is no ringing.
/// EchoOptions::kDefaultBlanking_m for fewer than 32 beams, all of which might see the same wall.
/// @param image  the sweep's image, filtered or not
/// REQUIRES image.rows() == sweep.beams.size()
double blanking_range_m(const PolarImage& image, const Sweep& sweep);

}  // namespace pingvox
