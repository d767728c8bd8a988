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

/// An angle whose degrees and minutes are one number, dddmm.mmm [rad].
double angle_of_degrees_minutes(double number);

}  // namespace pingvox
