#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// Poses of a moving vehicle from navigation samples as they arrive. The sources are chosen as by nav_trajectory, after
/// one second of an attitude and of a position, and kept from then on.
/// Fixes become positions relative to the first one, at the last known depth. The samples of the last minute are kept.
class LivePoses {
 public:
  /// Takes a sample; those that are not valid, not finite or not later than the last one of their source are left out.
  void add(const std::string& source, NavQuantity quantity, const NavSample& sample);

  /// map_from_body; nullopt: not known (yet): a pose needs samples of each source before and after it, without a gap.
  std::optional<Pose> at(double time_s) const;
  /// Later poses may become known by further samples; earlier ones do not. nullopt: none is known so far.
  std::optional<double> known_until_s() const;

  /// Whether a valid sample came so far: of an attitude, or of a position (a fix is one).
  bool has(NavQuantity quantity) const;

  /// Names of the sources; empty: not chosen yet.
  const std::string& attitude() const { return attitude_; }
  const std::string& position() const { return position_; }

 private:
  using Name = std::pair<std::string, NavQuantity>;
  void decide();

  std::map<Name, std::vector<NavSample>> samples_;  ///< of attitudes and positions
  std::optional<Eigen::Vector3d> first_fix_;
  std::optional<double> depth_m_;
  std::string attitude_, position_;
};

}  // namespace pingvox
