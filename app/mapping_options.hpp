#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "command_files.hpp"
#include "commands.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/mapping/head_options.hpp"
#include "pingvox/slam/locate_recording.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "pingvox/sonar/background.hpp"
#include "pingvox/sonar/sound_speed.hpp"

/// Options for detecting echoes and building maps, shared by 'map' and 'render'.
namespace pingvox::app {

/// The kinds of input that options may be limited to (Option::only_for).
inline constexpr std::string_view kBeamLogs = "logs of beams", kPointLogs = "point scans", kClouds = "clouds of points",
                                  kNavLogs = "navigation logs", kMaps = "maps", kMeshes = "meshes",
                                  kBagScans = "scans in ROS bags", kEchoTables = "tables of echoes (--echoes)",
                                  kRayBeams = "beams as rays (--beam ray)", kMadeMaps = "logs that are mapped";

/// Echo options of the command line. The default filter follows from the detector.
struct EchoArgs {
  Filter filter = FilterOptions{}.filter;
  std::optional<int> kernel;
  std::optional<double> sigma;
  EchoOptions echo;
  std::optional<double> background_m;     ///< nullopt: none is subtracted
  std::optional<double> sound_speed_m_s;  ///< nullopt: of `water`, else as the device assumes
  std::optional<Water> water;
  std::optional<double> nav_salinity;  ///< of water whose temperature the navigation log tells

  double sound_speed_ratio() const;
  /// kBadOption when both say what the speed of sound is, or when a navigation log should and there is none.
  Result<void> validate(const std::vector<std::string>& navs = {}) const;

  FilterOptions filter_options() const {
    const FilterOptions usual = default_filter(echo.detector);
    return {filter, kernel.value_or(usual.kernel), sigma.value_or(usual.sigma)};
  }
};

/// Mapping options of the command line.
struct BuildArgs {
  MapOptions map;
  BuildOptions build;  ///< filter and echo: see `echoes`
  HeadOptions head;
  EchoArgs echoes;
  std::string poses;
  std::vector<std::string> navs;
  std::optional<double> nav_offset_s;
  std::vector<NamedSource> nav_sources;
  std::string calibration;
  bool has_mount = false;  ///< it was given

  BuildOptions build_options() const {
    BuildOptions all = build;
    all.model = head.apply_to(build.model, nullptr);
    all.filter = echoes.filter_options();
    all.echo = echoes.echo;
    all.sound_speed_ratio = echoes.sound_speed_ratio();
    all.timing = all.vote == Vote::kPerBeam ? Timing::kByBeam : Timing::kBySweep;
    return all;
  }
  /// What follows from them, once all options are parsed.
  /// @param map  its thresholds are set by the caller
  /// @return kBadOption when one is invalid, or when two exclude each other
  Result<void> apply_to(RecordingArgs& recording, MapOptions& map, BuildOptions& build) const;
  /// The same with the thresholds of `occupancy`, whose depth is checked.
  Result<void> apply_to(RecordingArgs& recording, const OccupancyArgs& occupancy, MapOptions& map,
                        BuildOptions& build) const;
  void name_files(CommandFiles& files) const;
};

/// Validates options, except the minimum range, which scans of points do not have: see `check_ranges`.
Result<void> check_options(BuildOptions options);

/// --mount: "x,y,z,roll,pitch,yaw", metres and degrees, as a pose.
Option mount_option(Pose& target);
/// The same, and whether it was given.
Option mount_option(Pose& target, bool& is_given);
/// "x,y,z,roll,pitch,yaw", metres and degrees.
Take store_mount(Pose& target);
/// "NAME=x,y,z,roll,pitch,yaw", once for each.
/// @param name  of what, for the error: "SOURCE"
Take store_pose_of(std::map<std::string, Pose>& target, std::string name);
/// --nav: navigation logs.
Option nav_option(Args& targets, std::string help);
/// --nav-source, without the condition that there is --nav.
Option source_option(std::vector<NamedSource>& targets);
/// What has an effect only with --nav: the sources to take, seconds to add to its times, mounts of its sources, and the
/// output of 'slam --calibration'.
Option nav_source_option(std::vector<NamedSource>& targets);
Option nav_offset_option(std::optional<double>& target_s);
Option nav_mount_option(std::map<std::string, Pose>& body_from_source);
/// --origin: of the rays of a cloud.
Option origin_option(std::optional<Eigen::Vector3d>& target_m);
/// How 'slam' estimates: --matching, --causal and --seed.
std::vector<Option> slam_options(SlamOptions& slam, Estimation& estimation);
/// --folds, of 'evaluate'.
Option folds_option(std::size_t& folds);
/// How 'locate' estimates: --causal and --seed.
std::vector<Option> locate_options(LocalizerOptions& localizer, Estimation& estimation);
/// --min-z and --max-z: heights of a known map.
std::vector<Option> height_options(std::optional<double>& min_z_m, std::optional<double>& max_z_m);
/// Where the vehicle begins in a known map; nullopt: anywhere.
Option start_option(std::optional<StartPose>& start);
Option use_calibration_option(std::string& target, std::string help);

/// Whether a command has a navigation log that can tell of the water.
enum class WaterOfNav { kNo, kYes };
/// Groups of options that write into their arguments, which must outlive them.
OptionTable::Group echo_group(EchoArgs& args, WaterOfNav water);
std::vector<Option> occupancy_options(OccupancyArgs& args);
OptionTable::Group map_group(BuildArgs& args);
/// --threads: for tracing.
Option threads_option(std::size_t& target);
/// --parents and --threads: of maps that are made at once.
std::vector<Option> tree_options(BuildArgs& args);
OptionTable::Group sensor_group(BuildArgs& args);

}  // namespace pingvox::app
