#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// The sources of a log that is being read, in the order in which they first spoke.
class NavSources {
 public:
  /// Adds a sample; one with a number that is not finite is left out.
  /// @return where the sample is; nullptr when it was left out
  NavSample* add(const std::string& name, NavQuantity quantity, const NavSample& sample);

  std::vector<NavSource> take() { return std::move(sources_); }

 private:
  std::vector<NavSource> sources_;
  std::map<std::pair<std::string, NavQuantity>, std::size_t> places_;
};

/// Detects when a dead reckoning was reset to zero during the recording: later positions are in another frame.
class DeadReckoningFrame {
 public:
  /// Whether the next position is still in the frame of the first one: no step was faster than 10 m/s, and none led to
  /// the origin after a pause.
  bool holds(double time_s, const Eigen::Vector3d& position_m);

 private:
  struct Last {
    double time_s;
    Eigen::Vector3d position_m;
  };
  std::optional<Last> last_;
  bool was_reset_ = false;
};

/// An angle whose degrees and minutes are one number, dddmm.mmm [rad].
double angle_of_degrees_minutes(double number);

}  // namespace pingvox
