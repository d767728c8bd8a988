#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// What a ROS message says of its numbers: NavSource::subject, and the names of frames.
struct NavOrigin {
  NavSubject subject = NavSubject::kVehicle;
  std::string frame;  ///< of position, attitude and heading
  std::string child;  ///< whose pose they are, and that of velocity and turn rate
};

/// The sources of a log that is being read, in the order in which they first spoke.
class NavSources {
 public:
  /// Adds a sample; one with a number that is not finite is left out.
  /// @param origin  of the source, if it is a new one
  /// @return where the sample is; nullptr when it was left out
  NavSample* add(const std::string& name, NavQuantity quantity, const NavSample& sample, const NavOrigin& origin = {});

  std::vector<NavSource> take() { return std::move(sources_); }

 private:
  std::vector<NavSource> sources_;
  std::map<std::pair<std::string, NavQuantity>, std::size_t> places_;
};

/// An angle whose degrees and minutes are one number, dddmm.mmm [rad].
double angle_of_degrees_minutes(double number);

}  // namespace pingvox
