#pragma once

#include <optional>
#include <string>

#include "pingvox/result.hpp"

namespace pingvox {

/// A distribution of ROS 2, as far as messages of its own differ.
enum class Ros2Distribution {
  kHumble,  ///< and before
  kIron     ///< and newer: Jazzy, Kilted, Rolling
};

/// Where topics of ROS 2 are: all sides need the same domain, and interfaces that reach each other.
struct Ros2Network {
  static constexpr int kLastDomain = 101;  ///< the ports of higher ones are ephemeral ports of Linux

  int domain = 0;  ///< ROS_DOMAIN_ID
  /// Network interface, as in "eth0"; "lo": this host alone, without multicast. Empty: as configured for Cyclone DDS
  /// (CYCLONEDDS_URI).
  std::string interface = {};
  /// That of the other nodes, which then list pingvox as a node. nullopt: they see its topics only.
  std::optional<Ros2Distribution> distribution = std::nullopt;

  Result<void> validate() const;  ///< kBadOption names every broken field at once
  friend bool operator==(const Ros2Network&, const Ros2Network&) = default;
};

/// @return kUnsupported, with the reason, where pingvox was built without Cyclone DDS
Result<void> check_ros2_is_built();

}  // namespace pingvox
