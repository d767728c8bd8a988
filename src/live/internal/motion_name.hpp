#pragma once

#include <string_view>

#include "pingvox/live/live_event.hpp"

namespace pingvox {

/// The source of the motion, for reports: "sonar and heading".
inline std::string_view name_of(LiveMotion motion) {
  switch (motion) {
    case LiveMotion::kVelocity:
      return "velocity";
    case LiveMotion::kSonarAndHeading:
      return "sonar and heading";
    case LiveMotion::kSonar:
      return "sonar";
    case LiveMotion::kUndecided:
      break;
  }
  return "undecided";
}

}  // namespace pingvox
