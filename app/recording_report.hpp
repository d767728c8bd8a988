#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "io/internal/json.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/nav/time_span.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/result.hpp"

/// Says what was found in a recording, and what was made of it.
namespace pingvox::app {

/// What is to be said of the navigation or the poses, and of the mount. Each begins with the name of a file.
std::vector<std::string> warnings_of(const Recording& recording, const VehiclePath& path);

/// "6037 poses from ATTITUDE and LOCAL_POSITION_NED, 2 gaps". REQUIRES a path from navigation.
/// @param damaged  records of the navigation that could not be read
std::string nav_text(const VehiclePath& path, std::size_t damaged);
/// What the axes of the map are. REQUIRES a path from navigation.
std::string frame_text(const VehiclePath& path);
std::string frame_text(const RecordingSlam& slam);
/// "0.25 m, by a range of 50 m and a beam of 3 degrees"
/// @param asked  by the command line
std::string resolution_text(const MapForecast& forecast, const MapOptions& asked);
/// {"range_m": 50, "beam_width_deg": 3}: what a resolution follows, with null where it does not.
JsonObject resolution_json(const MapForecast& forecast, const MapOptions& asked);
/// What a map may take, where that is long or much; empty: it is not.
std::string cost_text(const MapForecast& forecast);
/// The same of a path that begins at 0, 0 and is turned as a heading says.
std::string frame_text(std::string_view heading);

/// The first line of a file of a calibration.
inline constexpr std::string_view kCalibrationComment =
    "# Calibration for --use-calibration; -sd is the standard deviation of the line above.\n";

/// Checks that --max-range is above --min-range: kBadOption names the options.
Result<void> check_ranges(const BuildOptions& options);

/// kUnsupported, with how far they are and what helps, where all poses are outside of the map, as in UTM.
Result<void> check_reach(const Recording& recording, const VehiclePath& path, const Lattice& lattice);

/// What to do where beams have no pose.
inline constexpr std::string_view kNavMustCover = "--nav must cover the log; --nav-offset corrects its clock";
std::string_view gap_advice(const Recording& recording, const VehiclePath& path);
/// "3036 of 4000 beams outside the time of the poses, 0.000 s to 24.000 s, the first at 24.043 s (--poses must cover
/// the log, with times in seconds of the same clock)"; empty: none was skipped.
/// @param unit  of what the log holds: "beam" or "point"
std::string skipped_text(const MappedLog& mapped, std::string_view unit, const Trajectory& trajectory,
                         std::string_view gap_advice, const Lattice& lattice);
/// "dive.csv: nothing could be mapped: it is empty". @param skipped  as skipped_text has it
std::string text_of_nothing(const std::string& name, const std::string& skipped);
/// Names the logs of which nothing is on the map; kCorrupt when these are all of them.
/// @param texts  one for each of these logs
Result<void> say_nothing_mapped(const std::vector<std::string>& texts, std::size_t logs, Console& console);

/// What is odd about the path of a log, as in "dive.tum: its poses last 156750 s, the log 157 s: are their times in
/// seconds?" or "dive.tum: its poses move but never turn: is the attitude known?".
std::vector<std::string> odd_path_texts(const Recording& recording, const VehiclePath& path, const PathArgs& args,
                                        const BuildReport& report);

/// For a log that was mapped without a trajectory: where one may be, as in "its trajectory may be --poses dive.tum" or
/// "its navigation may be --nav dive.tlog" (files beside it), or "navigation in the bag is used with --nav dive.db3";
/// empty: nowhere. Reads the beginning of a bag.
std::string hint_at_path(const std::string& log, Format format);
/// "dive.db3: mapped as if the vehicle did not move; navigation in the bag is used with --nav dive.db3" of a log of a
/// vehicle whose path may be known and is not given; empty: nothing is to be said.
std::string still_vehicle_text(const std::string& log, Format format, const PathArgs& path);
/// The same of a file whose format is not known yet.
std::string still_vehicle_text(const InputFile& log, const PathArgs& path);

/// "the logs are of several dates, 2021-06-11 to 2021-08-29, and ..." of logs that are mapped as if the head stood in
/// one place all the time; empty: they are of one dive.
/// @param logs  seconds since 1970 of those that tell them
std::string several_dates_text(std::vector<TimeSpan> logs);

/// The same as `hint_at_path` of a log that is a bag; empty also for others and for standard input.
std::string hint_at_nav(const std::string& log);

}  // namespace pingvox::app
