#pragma once

#include <string>

#include "pingvox/nav/nav_log.hpp"

namespace pingvox::app {

/// "jumps by 40.0 m in 0.10 s", "turns by 142 degrees in 0.05 s", or "is back at its origin ...".
std::string step_text(const SourceStep& step);

}  // namespace pingvox::app
