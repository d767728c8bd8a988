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

#include "io/internal/tf_frames.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

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

  // Of transforms that still come:

  /// The frame of the one vehicle, and the fixed frame at the root above it.
  /// @return kUnsupported where no vehicle is in a fixed frame, or several are, or one in several frames
  Result<TfFrames> vehicle_frames() const;
  /// The poses of a frame in one above it, as sources "TOPIC:map:base_link" of positions and of attitudes. As tf2 does,
  /// a transform that is not static is used between two messages of it, never before or after them. Empty: nothing new.
  /// @param after_s  poses at later times are returned
  /// @param now_s    on the same clock
  /// @return kUnsupported where no transforms join the frames, all are static, or one of them has not come for 5 s
  Result<std::vector<NavSource>> path(const std::string& topic, const TfFrames& frames, double after_s,
                                      double now_s) const;
  /// Forgets transforms of before this time that are not static, but for the last one of each.
  void forget_before(double time_s);

  /// How a sensor is mounted, by transforms that never change.
  struct Mount {
    std::string vehicle;  ///< name of the frame of the vehicle
    Pose body_from_sensor;
  };
  /// nullopt: not in tf.
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

  using Parents = std::span<const Transforms* const>;  ///< of each frame
  /// What is known of transforms that are not static.
  enum class Known {
    kOfLog,  ///< those that never change count at all times
    kSoFar   ///< they count between their messages
  };

  std::optional<std::size_t> frame_of(std::string_view name);
  std::vector<const Transforms*> main_parents() const;
  Chain chain_to_vehicle(const Transforms& top, Parents parents) const;
  std::vector<Chain> chains_to_vehicles(Parents parents) const;
  bool ends_at_vehicle(const Chain& chain) const;
  std::vector<Chain> with_frames_above(Chain chain, Parents parents) const;
  Result<Chain> chain_between(const TfFrames& frames, double now_s) const;
  std::string text_of(const Chain& chain) const;
  std::string source_of(const std::string& topic, const Chain& chain) const;
  bool add_path(const Chain& chain, const NavSource& source, Known known, double after_s,
                std::vector<NavSource>& sources) const;

  std::vector<std::string> names_;
  std::map<std::string, std::size_t, std::less<>> places_;  ///< in names_
  std::vector<Transforms> links_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> links_of_;  ///< of parent and child, in links_
  std::size_t left_out_ = 0;
};

}  // namespace pingvox
