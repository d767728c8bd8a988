#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "command_files.hpp"
#include "mapping_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"
#include "shell_words.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kMatchings = {Choice<Matching>{"pairs", Matching::kPairs},
                                   Choice<Matching>{"none", Matching::kNone}};

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

}  // namespace

Result<Command> slam_command(const Args& args) {
  SlamCommand command;
  std::string output, map, calibration, known_calibration, covariance, graph;
  BuildArgs build;
  EchoArgs& echoes = build.echoes;
  SlamOptions& slam = command.slam;
  OptionTable::Group map_options = map_of_slam(build);
  Option seed{"--seed", 0,
              "N",      "seed of the random choice of sweeps that a sweep is matched with",
              "1",      store_number(slam.seed)};
  seed.only_with = {{"--matching", {"pairs"}}};
  OptionTable::Group echo_options = echo_group(echoes, WaterOfNav::kYes);
  std::erase_if(echo_options.options, [](const Option& option) { return option.name == "--background"; });
  const std::vector<std::string> beams = {std::string(kBeamLogs)};
  Option calibration_option{
      "--calibration",   0, "FILE", "write the estimated calibration of the sensors, as TOML for --use-calibration", "",
      store(calibration)};
  calibration_option.only_for = beams;
  calibration_option.only_with = {{"--matching", {"pairs"}}};
  Option covariance_option{
      "--covariance",
      0,
      "FILE",
      "covariances of the poses, about four per sweep, as CSV: time, x x, x y, y y, x yaw, y yaw, yaw yaw [m, "
      "rad]",
      "",
      store(covariance)};
  covariance_option.only_for = beams;
  Option graph_option{"--graph", 0,
                      "FILE",    "graph of the poses of point scans as .g2o: key frames, odometry and loops",
                      "",        store(graph)};
  graph_option.only_for = {std::string(kPointLogs)};
  OptionTable::Group navigation{
      "Navigation",
      {nav_option(command.navs,
                  "navigation log of the vehicle (MAVLink .tlog, DataFlash .BIN, NMEA, A50, ROS bag, CSV)"),
       nav_source_option(command.nav_sources), nav_offset_option(command.nav_offset_s),
       mount_option(slam.body_from_sonar), nav_mount_option(slam.body_from_source),
       use_calibration_option(known_calibration,
                              "calibration of the same sensors by an earlier run, taken as a prior")}};
  OptionTable::Group estimation{
      "Estimation",
      {choice("--matching", kMatchings, "match pairs of echoes of different sweeps; none: dead reckoning only",
              slam.matching),
       flag("--causal", "estimate each pose only from what was recorded before it, as on board", command.estimation,
            Estimation::kCausal),
       std::move(seed)}};
  for (OptionTable::Group* group : {&navigation, &estimation}) {
    for (Option& option : group->options) option.only_for = beams;
  }
  const OptionTable table{
      "slam",
      "Estimates the trajectory of the vehicle from beams and navigation: velocity over ground and at least one\n"
      "heading. The mounting angles of the sensors and the deviation of the headings are estimated, too. Without a\n"
      "velocity, the motion is estimated from the sonar; this needs a heading or turn rates, unless the vehicle "
      "hardly\n"
      "turns. For point scans, whose poses are taken as odometry, the drift is corrected where a place is seen again.",
      {{"LOG", Positional::Count::kMany,
        "beams, as for 'map', or one log of point scans (OctoMap's .graph and .log); - is standard input",
        store_each(command.logs)}},
      {{"Output",
        {output_option(output,
                       "the trajectory of the vehicle as TUM lines 't x y z qx qy qz qw'; - is standard output"),
         {"--map", 0, "FILE", "map of the logs along the trajectory: .bt .ot .pvx .ply .pcd .xyz", "", store(map)},
         std::move(calibration_option),
         std::move(covariance_option),
         std::move(graph_option),
         json_option(command.output_options),
         quiet_option(command.output_options)}},
       std::move(navigation),
       std::move(estimation),
       std::move(map_options),
       std::move(echo_options),
       {"Input",
        {strict_option(command.damage), topic_option(command.bag), fields_option(command.bag), config_option()}}},
      {"pingvox slam dive.csv --nav nav.csv -o dive.tum --map dive.bt",
       "pingvox slam dive.csv --nav dive.tlog --nav dvl.csv --nav-mount A50=0,0,0,0,0,-45 -o dive.tum",
       "pingvox slam scans.graph -o scans.tum --map scans.bt"},
      "A log with only one intensity besides 0 is taken to hold detected echoes. Trajectories of point scans have the\n"
      "number of the scan, from 0, as time.\n"
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    command.limited = parsed.limited;
    if (const auto valid = echoes.validate(command.navs); !valid) return tl::unexpected(valid.error());
    slam.sound_speed_ratio = echoes.sound_speed_ratio();
    command.nav_salinity = echoes.nav_salinity;
    slam.filter = echoes.filter_options();
    slam.echo = echoes.echo;
    if (const auto valid = slam.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto has_map = check_has_map(map, parsed.limited); !has_map) return tl::unexpected(has_map.error());
    command.map_options = build.map;
    command.build = build.build_options();
    command.head = build.head;
    if (const auto valid = command.map_options.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = check_options(command.build); !valid) return tl::unexpected(valid.error());
    if (output.empty()) return usage_error("-o FILE is missing");
    if (output == "-" && command.output_options.report == Report::kJson) {
      return usage_error("-o - and --json: both write to standard output");
    }
    CommandFiles files;
    files.read("LOG", command.logs);
    files.read("--nav", command.navs);
    files.read("--use-calibration", known_calibration);
    files.read("--fields", command.bag.file);
    files.read("--config", parsed.config);
    files.write("-o", output);
    files.write("--map", map);
    files.write("--calibration", calibration);
    files.write("--covariance", covariance);
    files.write("--graph", graph);
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = check_trajectory_output(output); !valid) return tl::unexpected(valid.error());
    if (!map.empty()) {
      const Result<Format> format = output_format(map, std::nullopt, kMapFormats);
      if (!format) return tl::unexpected(format.error());
      command.map = map;
      command.map_format = *format;
      if (build.map.depth != Lattice::kDefaultDepth && (*format == Format::kBt || *format == Format::kOt)) {
        return usage_error(fmt::format("{}: .{} holds maps of {} levels, not of {}: use .pvx", map, name_of(*format),
                                       Lattice::kDefaultDepth, build.map.depth));
      }
      if (std::ranges::find(command.logs, "-") != command.logs.end()) {
        return usage_error("--map: reads each log twice, and standard input can be read only once");
      }
    }
    if (!known_calibration.empty()) command.known_calibration = known_calibration;
    if (!calibration.empty()) command.calibration = calibration;
    if (!covariance.empty()) {
      if (command.estimation == Estimation::kCausal) {
        return usage_error("--covariance and --causal: exclude each other: covariances need the whole log");
      }
      command.covariance = covariance;
    }
    if (!graph.empty()) command.graph = graph;
    for (const std::string& file : {output, map, calibration, covariance, graph}) {
      if (file.empty()) continue;
      if (const auto folder = check_folder_of(file); !folder) return tl::unexpected(folder.error());
    }
    command.output = output;
    command.made_by = "pingvox " PINGVOX_VERSION " slam";
    for (const std::string& word : args) {
      command.made_by += ' ';
      command.made_by += quote_for_shell(word);
    }
    return command;
  });
}

}  // namespace pingvox::app
