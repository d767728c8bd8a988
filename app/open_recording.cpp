#include "open_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/words.hpp"
#include "open_log.hpp"
#include "option_names.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/folder_logs.hpp"
#include "pingvox/recording/calibration_file.hpp"

namespace pingvox::app {
namespace {

/// Says by which option a trajectory among the navigation is taken.
Error advise_on_trajectory(Error error, const std::vector<InputFile>& files) {
  if (error.code != Error::Code::kUnsupported) return error;
  const bool has_trajectory = std::ranges::any_of(files, [](const InputFile& file) {
    const std::optional<Format> format = format_of_file(file);
    return format && kind_of(*format) == FormatKind::kTrajectory;
  });
  if (has_trajectory) error.message += ": 'map' and 'render' take it by --poses, 'locate' by --odometry";
  return error;
}

}  // namespace

Result<RecordingOptions> recording_options(const RecordingArgs& args) {
  RecordingOptions options;
  options.nav = input_files(args.path.navs);
  options.nav_offset_s = args.path.nav_offset_s;
  options.nav_sources = args.path.nav_sources;
  if (args.path.calibration) {
    Result<CalibrationFile> calibration = read_file(*args.path.calibration).and_then(read_calibration);
    if (!calibration) return tl::unexpected(calibration.error());
    options.calibration = *std::move(calibration);
  }
  if (args.path.poses) options.poses = *args.path.poses;
  options.nav_mounts = args.nav_mounts;
  options.body_from_sonar = args.body_from_sonar;
  options.nav_salinity = args.nav_salinity;
  options.background_m = args.background_m;
  options.cloud_origin_m = args.cloud_origin_m;
  options.head = args.head;
  options.damage = args.damage;
  options.topic = args.bag.beams;
  options.nav_fields = args.bag.nav;
  return options;
}

std::optional<Format> format_of_file(const InputFile& file) {
  if (file.is_standard_input()) return std::nullopt;
  const Result<Format> format = file.open().and_then([](ByteStream stream) { return identify_format(stream); });
  return format ? std::optional(*format) : std::nullopt;
}

Result<void> expand_folders(std::vector<std::string>& logs, Console& console) {
  std::vector<std::string> all;
  for (const std::string& log : logs) {
    std::error_code error;
    if (log == "-" || !std::filesystem::is_directory(log, error)) {
      all.push_back(log);
      continue;
    }
    const Result<ByteStream> bag = ByteStream::open(log);
    if (bag) {
      all.push_back(log);
      continue;
    }
    const Result<FolderLogs> found = logs_in_folder(log);
    if (!found) return tl::unexpected(found.error());
    if (found->logs.empty() && !found->folders.empty()) {
      return fail(Error::Code::kUnsupported,
                  fmt::format("{}: has no log, only folders: name one of them, or give --nav "
                              "FOLDER to map the dives in all of them",
                              log));
    }
    if (found->logs.empty()) return tl::unexpected(bag.error());
    std::string text = fmt::format("{}: takes {} in it", log, counted(found->logs.size(), "log"));
    if (!found->nav.empty()) text += fmt::format("; navigation (--nav): {}", fmt::join(found->nav, ", "));
    if (!found->others.empty()) text += fmt::format("; skipped: {}", fmt::join(found->others, ", "));
    if (!found->folders.empty()) text += fmt::format("; not looked into: {}/", fmt::join(found->folders, "/, "));
    console.say(text);
    all.insert(all.end(), found->logs.begin(), found->logs.end());
  }
  logs = std::move(all);
  return {};
}

std::vector<InputFile> input_files(const std::vector<std::string>& paths) {
  return {paths.begin(), paths.end()};
}

Result<Recording> open_recording(std::vector<InputFile> logs, const RecordingArgs& args) {
  Result<RecordingOptions> options = recording_options(args);
  if (!options) return tl::unexpected(options.error());
  const std::vector<InputFile> navs = options->nav;
  const InputFile first = logs.front();
  return Recording::open(std::move(logs), *std::move(options)).map_error([&](Error error) {
    const std::optional<Format> format = format_of_file(first);
    return advise_on_trajectory(format ? advise_on_log(std::move(error), *format) : std::move(error), navs);
  });
}

Result<Recording> open_recording(const RecordingArgs& args) {
  return open_recording(input_files(args.logs), args);
}

Result<OpenedLog> open_log_of(const Recording& recording, std::size_t number) {
  return recording.open_log(number).map_error([&](Error error) {
    const std::optional<Format> format = format_of_file(recording.logs()[number]);
    return format ? advise_on_log(std::move(error), *format) : std::move(error);
  });
}

Result<VehiclePath> path_of(const Recording& recording) {
  const RecordingOptions& options = recording.options();
  return recording.path().map_error([&](Error error) {
    if (error.code != Error::Code::kUnsupported) return error;
    if (options.poses) {
      const std::optional<Format> format = format_of_file(*options.poses);
      if (format && (kind_of(*format) == FormatKind::kNav || is_bag(*format))) error.message += ": give it with --nav";
    } else if (!has_path(recording.nav().log) && has_turns(recording.nav().log)) {
      error.message += "; 'pingvox slam' estimates the path from sonar and heading, for --poses";
    }
    return error;
  });
}

Result<OpenedRecording> open_with_path(std::vector<InputFile> logs, const RecordingArgs& args) {
  return open_recording(std::move(logs), args).and_then([](Recording recording) {
    return path_of(recording).map(
        [&](VehiclePath path) { return OpenedRecording{std::move(recording), std::move(path)}; });
  });
}

Result<OpenedRecording> open_with_path(const RecordingArgs& args) {
  return open_with_path(input_files(args.logs), args);
}

Result<Trajectory> trajectory_of(const std::optional<std::string>& poses, std::string_view nav_advice) {
  if (!poses) return Trajectory::still(Pose::Identity());
  return read_trajectory(*poses).map_error([&](Error error) {
    if (error.code != Error::Code::kUnsupported) return error;
    const std::optional<Format> format = format_of_file(*poses);
    const bool is_nav = format && (kind_of(*format) == FormatKind::kNav || is_bag(*format));
    if (is_nav) error.message += fmt::format(": {}", nav_advice);
    return error;
  });
}

}  // namespace pingvox::app
