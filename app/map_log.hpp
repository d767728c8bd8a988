#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// The trajectory in a file of TUM lines, as it is; without one the vehicle stays at the origin.
/// @param nav_advice  what to do with a file of navigation
Result<Trajectory> trajectory_of(const std::optional<std::string>& poses,
                                 std::string_view nav_advice = "'pingvox convert' makes one of positions");

/// Trajectory of the vehicle, and the navigation that it was made from.
struct VehiclePath {
  Trajectory trajectory;
  struct Nav {
    std::string attitude, position;  ///< its sources
    std::string velocity;            ///< dead reckoning: its source; there is no position then
    std::size_t damaged = 0;         ///< records that could not be read
    NavOffset offset;                ///< that was added to its times
    std::optional<WaterAround> water;
    std::optional<Eigen::Vector3d> origin_fix;  ///< NavTrajectory::origin_fix
    NavOthers others = {};                      ///< sources that were not used
    std::string frame_note = {};                ///< how the frame of the position was read; empty: as it is
  };
  std::optional<Nav> nav;                                   ///< nullopt: it is not from a navigation log
  Eigen::Vector3d sonar_moved_m = Eigen::Vector3d::Zero();  ///< added to the place of the sonar: by a calibration
  std::string_view advice = kPosesMustCover;                ///< where beams have no pose
  std::vector<std::string> warnings = {};                   ///< each begins with the name of a file
  static constexpr std::string_view kPosesMustCover =
      "--poses must cover the log, with times in seconds of the same clock";
  static constexpr std::string_view kNavMustCover = "--nav must cover the log; --nav-offset corrects its clock";
  static constexpr std::string_view kLeftOut = "what lies behind a jump is left out";
};
/// Without a file the vehicle stays at the origin. Navigation without a position, but with a velocity, is dead
/// reckoning.
/// @param log  whose clock its times are to be on
Result<VehiclePath> vehicle_path(const PathArgs& path, const SonarLog& log, const BagArgs& bag, Damage damage);
/// Trajectory of one navigation log; positions without an attitude give poses without rotation.
/// @param fields  as for read_nav_log
/// @param chosen  as for read_navs
Result<VehiclePath> vehicle_positions(ByteStream nav, Damage damage, std::span<const NavFields> fields,
                                      std::span<const NamedSource> chosen);
/// "6037 poses from ATTITUDE and LOCAL_POSITION_NED, 2 gaps". REQUIRES a path from a navigation log.
std::string nav_text(const VehiclePath& path);
/// What the axes of the map are. REQUIRES a path from a navigation log.
std::string frame_text(const VehiclePath::Nav& nav);
/// The same of a path that begins at 0, 0 and is turned as a heading says.
std::string frame_text(std::string_view heading);

/// Checks that --max-range is above --min-range: kBadOption names the options.
Result<void> check_ranges(const BuildOptions& options);

/// Result of mapping a log.
struct MappedLog {
  BuildReport report;
  BeamModelOptions beam;      ///< as used: width and height may be those of the log's device
  bool assumes_beam = false;  ///< width or height are defaults: neither options nor log tell them
  std::size_t damaged = 0;    ///< records that could not be read
  std::string first_damage;   ///< place and reason of the first one
  std::string note;           ///< how its beams are read, where that is not as its format says; empty: as it says
  std::string skipped_text;   ///< skipped beams by reason, and what to do; empty: none
  bool is_nothing = false;    ///< no beam or point of it is on the map
};
/// "dive.csv: nothing could be mapped: it is empty". REQUIRES one of which nothing is on the map.
std::string text_of_nothing(const MappedLog& mapped, const std::string& name);
/// Names the logs of which nothing is on the map; kCorrupt when these are all of them.
/// @param texts  one for each of these logs
Result<void> say_nothing_mapped(const std::vector<std::string>& texts, std::size_t logs, Console& console);

/// Adds a log of either kind to the map.
/// @param name  of the log, for messages
/// @param head  of the command line
Result<MappedLog> map_log(const Log& log, const std::string& name, const VehiclePath& path, const BuildOptions& options,
                          const HeadArgs& head, OccupancyMap& map, const Progress& progress = {});

/// "its poses last 156750 s, the log 157 s: are their times in seconds?"; empty: nothing is odd.
std::string odd_times_text(const Trajectory& trajectory, const BuildReport& report);

/// "its poses move but never turn: is the attitude known?"; empty: nothing is odd.
std::string odd_attitudes_text(const Trajectory& trajectory);

/// For a log that was mapped without a trajectory: where one may be, as in "its trajectory may be --poses dive.tum" or
/// "its navigation may be --nav dive.tlog" (files beside it), or "navigation in the bag is used with --nav dive.db3";
/// empty: nowhere. Reads the beginning of a bag.
std::string hint_at_path(const std::string& log, Format format);
/// The same of a log that is a bag; empty also for others and for standard input.
std::string hint_at_nav(const std::string& log);

}  // namespace pingvox::app
