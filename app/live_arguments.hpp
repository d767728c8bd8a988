#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "head_motion.hpp"
#include "mapping_options.hpp"
#include "option_table.hpp"
#include "pingvox/device/head_settings.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/live/live_options.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/locate_recording.hpp"

/// Options of mapping while a device runs, for 'live' and the Python module.
namespace pingvox::app {

/// Whether poses are by SLAM.
enum class Slam { kNo, kYes };

/// LiveOptions as typed.
struct LiveArgs {
  LiveOptions live;  ///< what has an option of its own: head, nav, obstacles, ros2 and publish
  BuildArgs build;
  std::string record;
  HeadMotion motion;
  double range_m = Ping360Settings().range_m;
  std::optional<double> timeout_s;
  Slam slam = Slam::kNo;
  std::map<std::string, Pose> nav_mounts;
  std::string known_map;
  std::optional<StartPose> start;
  double publish_every_s = Ros2Publish().every_s;

  /// What follows from them, once all options are parsed.
  /// @return kBadOption when one is invalid, or when two exclude each other
  Result<LiveOptions> options() const;
  /// The same of the head alone.
  Result<LiveHead> head() const;
};

/// The device: "ping360:udp://192.168.2.2:9092".
Take store_head(LiveHead& target);
/// Refuses options that have no effect on a head of this kind.
Result<void> check_limited(const std::vector<LimitedOption>& options, LiveHead::Kind kind);

Option record_option(std::string& target);
/// How a head is driven.
OptionTable::Group head_group(LiveArgs& args);
/// All groups of options but the device and --record: they write into `args`, which must outlive them.
std::vector<OptionTable::Group> live_groups(LiveArgs& args);

}  // namespace pingvox::app
