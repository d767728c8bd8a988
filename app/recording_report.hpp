#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "io/internal/json.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/result.hpp"

/// Says what was found in a recording, and what was made of it.
namespace pingvox::app {

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

/// "dive.csv: nothing could be mapped: it is empty". @param skipped  as skipped_text has it
std::string text_of_nothing(const std::string& name, const std::string& skipped);
/// Names the logs of which nothing is on the map; kCorrupt when these are all of them.
/// @param texts  one for each of these logs
Result<void> say_nothing_mapped(const std::vector<std::string>& texts, std::size_t logs, Console& console);

}  // namespace pingvox::app
