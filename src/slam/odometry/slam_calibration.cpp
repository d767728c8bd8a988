#include "pingvox/slam/slam_calibration.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace pingvox {
namespace {

/// The iteration that takes the deviation off a heading shrinks its error by this in each step.
constexpr double kMaxSlope = 0.9;

Result<void> check(const std::string& name, const Estimate& estimate) {
  if (!std::isfinite(estimate.value)) return fail(Error::Code::kBadOption, name + ": must be finite");
  if (!(estimate.deviation > 0.0) || !std::isfinite(estimate.deviation)) {
    return fail(Error::Code::kBadOption, name + ": its standard deviation must be finite and above 0");
  }
  return {};
}

}  // namespace

Result<void> SlamCalibration::validate() const {
  struct Named {
    const char* name;
    const Estimate& estimate;
  };
  for (const auto& [name, estimate] :
       std::array{Named{"velocity_yaw_rad", velocity_yaw_rad}, Named{"velocity_scale", velocity_scale},
                  Named{"wall_in_echo", wall_in_echo}, Named{"sonar_x_m", sonar_x_m}, Named{"sonar_y_m", sonar_y_m}}) {
    if (const auto checked = check(name, estimate); !checked) return checked;
  }
  if (!(velocity_scale.value > -1.0)) return fail(Error::Code::kBadOption, "velocity_scale: must be above -1");
  for (const HeadingCalibration& h : headings) {
    for (const auto& [name, estimate] :
         std::array{Named{"constant_rad", h.constant_rad}, Named{"sin1_rad", h.sin1_rad}, Named{"cos1_rad", h.cos1_rad},
                    Named{"sin2_rad", h.sin2_rad}, Named{"cos2_rad", h.cos2_rad}}) {
      if (const auto checked = check(fmt::format("heading {}: {}", h.source, name), estimate); !checked) return checked;
    }
    const double slope =
        std::hypot(h.sin1_rad.value, h.cos1_rad.value) + 2.0 * std::hypot(h.sin2_rad.value, h.cos2_rad.value);
    if (slope > kMaxSlope) {
      return fail(Error::Code::kBadOption, fmt::format("heading {}: its deviation is too large to be corrected: it "
                                                       "changes by up to {:.2g} degrees a degree of yaw",
                                                       h.source, slope));
    }
    if (heading(h.source) != &h) {
      return fail(Error::Code::kBadOption, fmt::format("heading {}: is there twice", h.source));
    }
  }
  return {};
}

const HeadingCalibration* SlamCalibration::heading(const std::string& source) const {
  const auto found = std::ranges::find(headings, source, &HeadingCalibration::source);
  return found == headings.end() ? nullptr : &*found;
}

}  // namespace pingvox
