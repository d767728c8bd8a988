#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pingvox/geometry/lattice.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/input_file.hpp"
#include "pingvox/nav/time_span.hpp"
#include "pingvox/recording/recording.hpp"

/// What is odd about a recording and what was mapped of it, and what helps: options are named as on the command line.
namespace pingvox::app {

/// What is left out of navigation and why, sources with a fault and steps that no vehicle makes. Each begins with the
/// names of files.
std::vector<std::string> nav_warnings(const Recording& recording);

/// "dive.bag: /tf has the sonar's frame sonar_link on base_link: --mount 0.1,0,-0.4,180,0,0"; empty: the bags among the
/// navigation do not tell how the sonar is mounted, or the mount is given.
std::string mount_hint(const Recording& recording);

/// What is to be said of the navigation or the poses, and of the mount. Each begins with the name of a file.
std::vector<std::string> warnings_of(const Recording& recording, const VehiclePath& path);

/// What is to be said of a log that was mapped along the path, as in "dive.csv: skipped 3 damaged records, the first:
/// ..." or "dive.tum: its poses move but never turn: is the attitude known?".
std::vector<std::string> warnings_of(const Recording& recording, const VehiclePath& path, const MappedLog& mapped,
                                     const Lattice& lattice);

/// What to do where beams have no pose.
inline constexpr std::string_view kNavMustCover = "--nav must cover the log; --nav-offset corrects its clock";
std::string_view gap_advice(const Recording& recording, const VehiclePath& path);
/// "3036 of 4000 beams outside the time of the poses, 0.000 s to 24.000 s, the first at 24.043 s (--poses must cover
/// the log, with times in seconds of the same clock)"; empty: none was skipped.
std::string skipped_text(const MappedLog& mapped, const Trajectory& trajectory, std::string_view gap_advice,
                         const Lattice& lattice);

/// "dive.db3: mapped as if the vehicle did not move; navigation in the bag is used with --nav dive.db3" of a log of a
/// vehicle whose path may be known and is not given: files beside it, or a bag that has it, whose beginning is read.
/// Empty: nothing is to be said.
std::string still_vehicle_text(const std::string& log, Format format, const RecordingOptions& options);
/// The same of a file whose format is not known yet.
std::string still_vehicle_text(const InputFile& log, const RecordingOptions& options);
/// "navigation in the bag is used with --nav dive.db3"; empty also for other logs and for standard input.
std::string hint_at_nav(const std::string& log);

/// "the logs are of several dates, 2021-06-11 to 2021-08-29, and ..." of logs that are mapped as if the head stood in
/// one place all the time; empty: they are of one dive.
/// @param logs  seconds since 1970 of those that tell them
std::string several_dates_text(std::vector<TimeSpan> logs);

}  // namespace pingvox::app
