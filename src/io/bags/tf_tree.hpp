#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// The frames of tf and the transforms between them, each with its times.
class TfTree {
 public:
  enum class Link { kMoving, kStatic };

  /// Adds a transform. Those of more frames than a vehicle has are counted and left out.
  void add(std::string_view parent, std::string_view child, double time_s, const Pose& parent_from_child, Link link);

  /// Poses of what moves in fixed frames (map, odom, world), as sources "TOPIC:map:base_link": of `base_link`, where a
  /// chain of transforms joins it to the fixed frame, else of the first frame below that one. Each transform is
  /// interpolated at the times of all others; one that never changes counts at all times.
  std::vector<NavSource> paths(const std::string& topic) const;

  /// How a sensor is mounted, by transforms that never change.
  struct Mount {
    std::string vehicle;  ///< name of the frame of the vehicle
    Pose body_from_sensor;
  };
  /// nullopt: tf does not tell.
  std::optional<Mount> mount_of(std::string_view frame) const;

  /// "tf does not join base_link to map"; empty: it does, or there is nothing to join.
  std::string unjoined_text() const;

 private:
  struct Transforms {
    std::size_t parent, child;  ///< in names_
    Link link;
    std::vector<StampedPose> poses;  ///< in the order in which they came
  };
  using Chain = std::vector<const Transforms*>;  ///< from the fixed frame to the vehicle

  std::optional<std::size_t> frame_of(std::string_view name);
  std::vector<const Transforms*> main_parents() const;
  Chain chain_to_vehicle(const Transforms& top, std::span<const Transforms* const> parents) const;
  std::string text_of(const Chain& chain) const;
  bool add_path(const Chain& chain, const std::string& name, NavSubject subject, std::vector<NavSource>& sources) const;

  std::vector<std::string> names_;
  std::map<std::string, std::size_t, std::less<>> places_;  ///< in names_
  std::vector<Transforms> links_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> links_of_;  ///< of parent and child, in links_
  std::size_t left_out_ = 0;
};

}  // namespace pingvox
