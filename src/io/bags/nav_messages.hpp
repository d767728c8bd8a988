#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/bags/bag_topics.hpp"
#include "io/bags/stamped_queue.hpp"
#include "io/bags/tf_tree.hpp"
#include "io/nav/dvl_a50.hpp"
#include "io/nav/nav_sources.hpp"
#include "nav/internal/nav_frames.hpp"
#include "pingvox/nav/device_clock.hpp"

// The messages of navigation in bags, by their type and fields (docs/formats.md).
namespace pingvox {

/// A pose that is recorded again and again until another one is known, and for ever when none comes any more.
struct RepeatedPose {
  Eigen::Vector3d attitude = Eigen::Vector3d::Zero(), place = Eigen::Vector3d::Zero();
  double since_s = 0.0;
  bool is_known = false;
  double longest_s = 0.0, longest_from_s = 0.0;  ///< how long it stayed the same at most, and from when on
};

/// What the messages of a topic so far say about later ones.
struct NavTopicState {
  double altitude_m = 0.0;               ///< the last one that a receiver knew
  std::vector<DeviceTime> report_times;  ///< of a DVL, where they have a time of the device
  std::vector<NavOrigin> origins;        ///< of its messages, the first one's first
  std::vector<MessageTime> times;        ///< of its messages
  StampWatch stamps;
  std::size_t upward = 0, downward = 0;  ///< accelerations of an Imu, by its own attitude
  RepeatedPose pose;                     ///< of Ping Viewer 2
  std::string no_attitude;               ///< why the last message that should have one does not
};

/// Where the samples of one message go.
class NavSamples {
 public:
  NavSamples(NavSources& sources, const std::string& name, double time_s, NavTopicState& state, const NavOrigin& origin)
      : sources_(sources), name_(name), time_s_(time_s), state_(state), origin_(origin) {}

  /// Adds a position by dead reckoning and its attitude.
  void add_dead_reckoning(const Eigen::Vector3d& position_m, const Eigen::Vector3d& attitude);

  /// A report of a DVL in its own format, which contains the delay of the message.
  void add(const A50Report& report);

  /// Whether a pose is another one than that of the message before. It is of this message then.
  bool is_new_pose(const Eigen::Vector3d& attitude, const Eigen::Vector3d& place);

  /// Why a message that should have an attitude does not.
  void refuse_attitude(std::string reason) { state_.no_attitude = std::move(reason); }

  /// Of an Imu, by its own attitude. At rest it is that of what it lies on, upward (REP-145).
  void count_acceleration(double upward_m_s2);

  /// Degrees; NaN for an altitude that is not known. The last one is taken then, so that the height does not jump.
  void add_fix(double latitude_deg, double longitude_deg, double altitude_m, bool valid);

  void add(NavQuantity quantity, const Eigen::Vector3d& value, bool valid = true);

 private:
  void add(NavQuantity quantity, const Eigen::Vector3d& value, bool valid, const NavOrigin& origin);

  NavSources& sources_;
  const std::string& name_;
  double time_s_;
  NavTopicState& state_;
  const NavOrigin& origin_;
};

/// What `header.frame_id` of a type of message is.
enum class FrameId {
  kNotUsed,      ///< the driver's axes are known
  kOfPose,       ///< that a pose is in, of something
  kOfOdometry,   ///< that the vehicle's pose is in; `child_frame_id` is the vehicle, and what its twist is in
  kOfSensor,     ///< of a sensor on the vehicle
  kOfTwist,      ///< that a velocity is in, which may be another one than the vehicle's
  kOfTransforms  ///< of tf: of each of them
};

struct NavType {
  RosType type;
  void (*add)(const RosFields& message, NavSamples& samples);  ///< nullptr: of transforms
  FrameId frame_id = FrameId::kNotUsed;
};

/// Those that we know.
std::span<const NavType> nav_types();

/// The frames of a message.
NavOrigin origin_of(FrameId frame_id, const KnownTopic& topic, const RosMessage& message);
/// Of messages that are read by the fields that a user named: a frame that does not stand still is that of a sensor.
NavOrigin origin_by_name(const KnownTopic& topic, const RosMessage& message);

/// Adds the transforms of a message of tf. REQUIRES that `read` has read the first of them; it reads the others.
void add_transforms(const KnownTopic& topic, std::span<const std::uint8_t> message, double recorded_s,
                    TfTree::Link link, RosMessage& read, TfTree& tree);

/// Three numbers from the field of the first on.
Eigen::Vector3d vector_at(const RosFields& message, std::size_t first);

}  // namespace pingvox
