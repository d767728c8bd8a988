#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/result.hpp"

/// Opens recordings by the options of the command line.
namespace pingvox::app {

/// The format of a file that could not be used; nullopt: standard input, or it is unknown.
std::optional<Format> format_of_file(const InputFile& file);

/// Puts the logs of folders in their places, and says which those are; a folder that is one bag stays as it is.
/// @return as InputFile::open for a folder without a log
Result<void> expand_folders(std::vector<std::string>& logs, Console& console);

/// The options of a recording. @return errors of reading the calibration
Result<RecordingOptions> recording_options(const RecordingArgs& args);
/// Recording::open, with advice in its errors.
/// @param logs  in place of those of `args`
Result<Recording> open_recording(std::vector<InputFile> logs, const RecordingArgs& args);
Result<Recording> open_recording(const RecordingArgs& args);
/// Paths of the command line as files.
std::vector<InputFile> input_files(const std::vector<std::string>& paths);
/// Recording::open_log, with advice in its errors.
Result<OpenedLog> open_log_of(const Recording& recording, std::size_t number);
/// Recording::path, with advice in its errors.
Result<VehiclePath> path_of(const Recording& recording);

/// A recording, and where the vehicle was.
struct OpenedRecording {
  Recording recording;
  VehiclePath path;
};
/// open_recording and path_of.
Result<OpenedRecording> open_with_path(std::vector<InputFile> logs, const RecordingArgs& args);
Result<OpenedRecording> open_with_path(const RecordingArgs& args);

/// The trajectory in a file of TUM lines, as it is; without one the vehicle stays at the origin.
/// @param nav_advice  what to do with a file of navigation
Result<Trajectory> trajectory_of(const std::optional<std::string>& poses,
                                 std::string_view nav_advice = "'pingvox convert' makes one of positions");

}  // namespace pingvox::app
