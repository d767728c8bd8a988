#pragma once

#include <optional>
#include <vector>

#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox {

/// Where an arc ends that ringing leaves around the head [m]: nearly all directions of nearly a full turn have their
/// first echo at the same short range. nullopt: there is none. No walls are: seen from within a box, their range
/// changes with the direction, unless the box is hardly larger than 1.5 m.
/// @param echoes  the first of each beam. REQUIRES one for each beam of the sweep
std::optional<double> end_of_ringing_arc_m(const std::vector<std::optional<Echo>>& echoes, const Sweep& sweep);

}  // namespace pingvox
