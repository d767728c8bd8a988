#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/internal/json.hpp"
#include "pingvox/nav/nav_log.hpp"

namespace pingvox::app {

/// A line for each source with samples that are left out: "position of LOCAL_POSITION_NED jumps by 40.0 m in 0.10 s at
/// 115.000 s: 150 of 300 samples are left out, those from 115.000 to 129.900 s".
std::vector<std::string> step_texts(const NavLog& log);
/// The same of a trajectory of `poses` poses: where it is cut, and poses that are left out.
std::vector<std::string> step_texts(const std::vector<SourceStep>& steps, std::size_t poses);

/// Samples or poses that are left out.
std::size_t left_out(const std::vector<SourceStep>& steps);
/// The first steps, each with its times, size and the samples that are left out.
std::vector<JsonObject> steps_json(const std::vector<SourceStep>& steps);

}  // namespace pingvox::app
