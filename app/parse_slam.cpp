#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "command_files.hpp"
#include "echo_options.hpp"
#include "input_kinds.hpp"
#include "mapping_options.hpp"
#include "nav_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"
#include "shell_words.hpp"
#include "slam_options.hpp"

namespace pingvox::app {
namespace {

/// What is typed, where it is not in the command as such.
struct SlamArgs {
  std::string output, map, calibration, known_calibration, covariance, graph;
  BuildArgs build;
};

/// Options of the beam, which depend on each other.
constexpr auto kOfBeam = std::to_array<std::string_view>({"--beam-width", "--beam-height", "--device", "--free-share"});

/// How a map is made, but for the echoes, which are those of the trajectory.
OptionTable::Group map_of_slam(BuildArgs& args) {
  constexpr auto kOfSensor = std::to_array<std::string_view>({"--beam", "--hit-from", "--silent"});
  OptionTable::Group group = map_group(args);
  for (Option& option : tree_options(args)) group.options.push_back(std::move(option));
  for (Option& option : group.options) option.only_with = {{"--map"}};
  for (Option& option : sensor_group(args).options) {
    const bool is_of_beam = std::ranges::find(kOfBeam, option.name) != kOfBeam.end();
    if (!is_of_beam && std::ranges::find(kOfSensor, option.name) == kOfSensor.end()) continue;
    // With --beam, those have a condition already.
    if (!is_of_beam) option.only_with = {{"--map"}};
    group.options.push_back(std::move(option));
  }
  return group;
}

/// Refuses the size of a beam where there is no map.
Result<void> check_has_map(const std::string& map, const std::vector<LimitedOption>& given) {
  if (!map.empty()) return {};
  for (const LimitedOption& option : given) {
    if (std::ranges::find(kOfBeam, option.name) == kOfBeam.end()) continue;
    return usage_error(fmt::format("{}: has no effect without --map", option.name));
  }
  return {};
}

OptionTable::Group slam_output_group(SlamCommand& command, SlamArgs& typed) {
  const std::vector<std::string> beams = {std::string(kBeamLogs)};
  Option calibration_option{"--calibration",
                            0,
                            "FILE",
                            "write the estimated calibration of the sensors, as TOML for --use-calibration",
                            "",
                            store(typed.calibration)};
  calibration_option.only_for = beams;
  calibration_option.only_with = {{"--matching", {"pairs"}}};
  Option covariance_option{
      "--covariance",
      0,
      "FILE",
      "covariances of the poses, about four per sweep, as CSV: time, x x, x y, y y, x yaw, y yaw, yaw yaw [m, "
      "rad]",
      "",
      store(typed.covariance)};
  covariance_option.only_for = beams;
  Option graph_option{"--graph", 0,
                      "FILE",    "graph of the poses of point scans as .g2o: key frames, odometry and loops",
                      "",        store(typed.graph)};
  graph_option.only_for = {std::string(kPointLogs)};
  return {
      "Output",
      {output_option(typed.output,
                     "the trajectory of the vehicle as TUM lines 't x y z qx qy qz qw'; - is standard output"),
       {"--map", 0, "FILE", "map of the logs along the trajectory: .bt .ot .pvx .ply .pcd .xyz", "", store(typed.map)},
       std::move(calibration_option),
       std::move(covariance_option),
       std::move(graph_option),
       json_option(command.output_options),
       quiet_option(command.output_options)}};
}

Result<Command> finish_slam(SlamCommand command, const SlamArgs& typed, const Parsed& parsed, const Args& args) {
  command.limited = parsed.limited;
  if (const auto valid = typed.build.echoes.validate(command.recording.path.navs); !valid)
    return tl::unexpected(valid.error());
  command.slam.sound_speed_ratio = typed.build.echoes.sound_speed_ratio();
  command.recording.nav_salinity = typed.build.echoes.nav_salinity;
  command.slam.filter = typed.build.echoes.filter_options();
  command.slam.echo = typed.build.echoes.echo;
  if (const auto valid = command.slam.validate(); !valid) return tl::unexpected(valid.error());
  if (const auto has_map = check_has_map(typed.map, parsed.limited); !has_map) return tl::unexpected(has_map.error());
  command.map_options = typed.build.map;
  command.build = typed.build.build_options();
  command.recording.head = typed.build.head;
  if (const auto valid = command.map_options.validate(); !valid) return tl::unexpected(valid.error());
  if (const auto valid = check_options(command.build); !valid) return tl::unexpected(valid.error());
  if (typed.output.empty()) return usage_error("-o FILE is missing");
  if (typed.output == "-" && command.output_options.report == Report::kJson) {
    return usage_error("-o - and --json: both write to standard output");
  }
  CommandFiles files;
  files.read("LOG", command.recording.logs);
  files.read("--nav", command.recording.path.navs);
  files.read("--use-calibration", typed.known_calibration);
  files.read("--fields", command.recording.bag.file);
  files.read("--config", parsed.config);
  files.write("-o", typed.output);
  files.write("--map", typed.map);
  files.write("--calibration", typed.calibration);
  files.write("--covariance", typed.covariance);
  files.write("--graph", typed.graph);
  if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
  if (const auto valid = check_trajectory_output(typed.output); !valid) return tl::unexpected(valid.error());
  if (!typed.map.empty()) {
    const Result<Format> format = output_format(typed.map, std::nullopt, kMapFormats);
    if (!format) return tl::unexpected(format.error());
    command.map = typed.map;
    command.map_format = *format;
    const int depth = command.map_options.depth;
    if (depth != Lattice::kDefaultDepth && (*format == Format::kBt || *format == Format::kOt)) {
      return usage_error(fmt::format("{}: .{} holds maps of {} levels, not of {}: use .pvx", typed.map,
                                     name_of(*format), Lattice::kDefaultDepth, depth));
    }
    if (std::ranges::find(command.recording.logs, "-") != command.recording.logs.end()) {
      return usage_error("--map: reads each log twice, and standard input can be read only once");
    }
  }
  if (!typed.known_calibration.empty()) command.recording.path.calibration = typed.known_calibration;
  if (!typed.calibration.empty()) command.calibration = typed.calibration;
  if (!typed.covariance.empty()) {
    if (command.estimation == Estimation::kCausal) {
      return usage_error("--covariance and --causal: exclude each other: covariances need the whole log");
    }
    command.covariance = typed.covariance;
  }
  if (!typed.graph.empty()) command.graph = typed.graph;
  for (const std::string& file : {typed.output, typed.map, typed.calibration, typed.covariance, typed.graph}) {
    if (file.empty()) continue;
    if (const auto folder = check_folder_of(file); !folder) return tl::unexpected(folder.error());
  }
  command.output = typed.output;
  command.made_by = command_text("slam", args);
  return command;
}

}  // namespace

Result<Command> slam_command(const Args& args) {
  SlamCommand command;
  SlamArgs typed;
  RecordingArgs& recording = command.recording;
  OptionTable::Group map_options = map_of_slam(typed.build);
  OptionTable::Group echo_options = echo_group(typed.build.echoes, WaterOfNav::kYes);
  std::erase_if(echo_options.options, [](const Option& option) { return option.name == "--background"; });
  const std::vector<std::string> beams = {std::string(kBeamLogs)};
  OptionTable::Group navigation{
      "Navigation",
      {nav_option(recording.path.navs,
                  "navigation log of the vehicle (MAVLink .tlog, DataFlash .BIN, NMEA, A50, ROS bag, CSV)"),
       nav_source_option(recording.path.nav_sources), nav_offset_option(recording.path.nav_offset_s),
       mount_option(recording.body_from_sonar, recording.has_mount), nav_mount_option(recording.nav_mounts),
       use_calibration_option(typed.known_calibration,
                              "calibration of the same sensors by an earlier run, taken as a prior")}};
  OptionTable::Group estimation{"Estimation", slam_options(command.slam, command.estimation)};
  for (OptionTable::Group* group : {&navigation, &estimation}) {
    for (Option& option : group->options) option.only_for = beams;
  }
  const OptionTable table{
      "slam",
      "Estimates the trajectory of the vehicle from beams and navigation: velocity over ground and at least one\n"
      "heading. The mounting angles of the sensors and the deviation of the headings are estimated, too. Without a\n"
      "velocity, the motion is estimated from the sonar; this needs a heading or turn rates, unless the vehicle "
      "hardly\n"
      "turns. For point scans, whose poses are taken as odometry, the drift is corrected at loop closures.",
      {{"LOG", Positional::Count::kMany,
        "beams, as for 'map', or one log of point scans (OctoMap's .graph and .log); - is standard input",
        store_each(recording.logs)}},
      {slam_output_group(command, typed),
       std::move(navigation),
       std::move(estimation),
       std::move(map_options),
       std::move(echo_options),
       {"Input",
        {strict_option(recording.damage), topic_option(recording.bag), fields_option(recording.bag), config_option()}}},
      {"pingvox slam dive.csv --nav nav.csv -o dive.tum --map dive.bt",
       "pingvox slam dive.csv --nav dive.tlog --nav dvl.csv --nav-mount A50=0,0,0,0,0,-45 -o dive.tum",
       "pingvox slam scans.graph -o scans.tum --map scans.bt"},
      "A log with only one intensity besides 0 is taken to hold detected echoes. Trajectories of point scans have the\n"
      "number of the scan, from 0, as time.\n"
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  return parse_command(table, args, [&](const Parsed& parsed) { return finish_slam(command, typed, parsed, args); });
}

}  // namespace pingvox::app
