#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <system_error>

#include "command_files.hpp"
#include "mapping_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "pingvox/geometry/degree.hpp"
#include "shared_options.hpp"
#include "suggest.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kMotions = {Choice<Motion>{"still", Motion::kStill}, Choice<Motion>{"line", Motion::kLine},
                                 Choice<Motion>{"lawn-mower", Motion::kLawnMower},
                                 Choice<Motion>{"loop", Motion::kLoop}, Choice<Motion>{"by-hand", Motion::kByHand}};
constexpr std::array kCsvOnly = {Choice<Format>{"csv", Format::kCsv}};

}  // namespace

Result<Command> simulate_command(const Args& args) {
  SimulateCommand command;
  TankOptions& tank = command.tank;
  SonarOptions& sonar = command.sonar;
  NavSensorOptions& sensors = command.nav_sensors;
  const Take world = [&](const std::string& text) -> Result<void> {
    const Args known = {"tank", "harbour", "marina", "seabed", "cave"};
    std::error_code error;
    const bool is_known = std::find(known.begin(), known.end(), text) != known.end();
    if (!is_known && !std::filesystem::path(text).has_extension() && !std::filesystem::exists(text, error)) {
      return usage_error(fmt::format("no such world '{}': must be {}, or a mesh (.off, .ply, .stl){}", text,
                                     fmt::join(known, ", "), did_you_mean(text, known)));
    }
    command.world = text;
    return {};
  };
  std::string poses, truth, nav;
  OptionTable table{
      "simulate",
      "Simulates the log of a scanning sonar in a world of your choice, with ground truth if asked. The same options\n"
      "give the same bytes.",
      {{"WORLD", Positional::Count::kOne,
        "tank (square, with a floater), harbour (quay walls, piles, a hull), marina (canals and basins, 400 m long), "
        "seabed (a slope with boulders), cave (a "
        "tunnel), or the file of a mesh in metres (OFF, PLY, STL)",
        world}},
      {{"Output",
        {output_option(command.output,
                       "the log, .csv; - is standard output. For a moving vehicle its reported trajectory is written "
                       "beside it as .tum"),
         {"--truth", 0, "DIR", "folder for ground truth: poses.tum, ranges.csv, world.ply (a mesh), world.bt (a map)",
          "none", store(truth)},
         {"--nav", 0, "FILE",
          "measurements of the vehicle's navigation sensors, as CSV: a DVL, a compass, gyros, depth", "none",
          store(nav)},
         {"--resolution", 0, "M", "edge length of a cell of world.bt", "0.05; marina 0.2",
          within(kResolutions, store_optional(command.truth_resolution_m))},
         quiet_option(command.output_options)}},
       {"World and vehicle",
        {{"--side", 0, "M", "side of the square tank", number_text(tank.side_m),
          within({2.0 * std::max(std::abs(tank.sensor_x_m), std::abs(tank.sensor_y_m)), 1000.0, Limits::Ends::kLowOut},
                 store_number(tank.side_m))},
         choice("--trajectory", kMotions,
                "path of the vehicle; still is at 0,0,0; by-hand is the loop, once, with stops and sudden turns",
                command.motion),
         {"--poses", 0, "FILE", "path of the vehicle as TUM lines, instead of --trajectory", "none", store(poses)},
         mount_option(sonar.body_from_sensor),
         {"--speed", 0, "M/S", "speed of the vehicle", number_text(command.travel.speed_m_s),
          within({0.0, 100.0, Limits::Ends::kLowOut}, store_number(command.travel.speed_m_s))},
         {"--turns", 0, "N", "turns of the head", "5; of a moving vehicle: to the end of its path",
          store_optional(command.turns)},
         {"--drift", 0, "M", "error of the reported position after a minute (standard deviation)",
          number_text(command.drift.position_m), within({0.0, 1000.0}, store_number(command.drift.position_m))},
         {"--heading-drift", 0, "DEG", "error of the reported heading after a minute (standard deviation)",
          number_text(command.drift.heading_rad / kDegree_rad),
          within({0.0, 572.95}, store_number(command.drift.heading_rad, kDegree_rad))}}},
       {"Navigation",
        {{"--dvl-noise", 0, "M/S", "noise of the velocity (standard deviation on each axis)",
          number_text(sensors.dvl_noise_m_s), within({0.0, 10.0}, store_number(sensors.dvl_noise_m_s))},
         {"--dvl-outliers", 0, "F", "fraction of velocities that are wrong by about 1 m/s",
          number_text(sensors.dvl_outliers), within({0.0, 1.0}, store_number(sensors.dvl_outliers))},
         {"--dvl-lost", 0, "F", "fraction of time without bottom lock", number_text(sensors.dvl_lost),
          within({0.0, 1.0, Limits::Ends::kHighOut}, store_number(sensors.dvl_lost))},
         {"--dvl-yaw", 0, "DEG", "mounting angle of the DVL (standard deviation over seeds)",
          number_text(sensors.dvl_yaw_rad / kDegree_rad),
          within({0.0, 57.29}, store_number(sensors.dvl_yaw_rad, kDegree_rad))},
         {"--dvl-scale", 0, "F", "scale error of the velocity: true over measured, less 1 (likewise)",
          number_text(sensors.dvl_scale), within({0.0, 0.1}, store_number(sensors.dvl_scale))},
         {"--compass-deviation", 0, "DEG", "amplitude of the deviation curve of the compass (likewise)",
          number_text(sensors.compass_deviation_rad / kDegree_rad),
          within({0.0, 17.18}, store_number(sensors.compass_deviation_rad, kDegree_rad))},
         {"--attitude-noise", 0, "DEG", "noise of roll, pitch and yaw (standard deviation)",
          number_text(sensors.attitude_noise_rad / kDegree_rad),
          within({0.0, 57.29}, store_number(sensors.attitude_noise_rad, kDegree_rad))},
         {"--gyro-noise", 0, "DEG/S", "noise of the turn rate (standard deviation)",
          number_text(sensors.gyro_noise_rad_s / kDegree_rad),
          within({0.0, 57.29}, store_number(sensors.gyro_noise_rad_s, kDegree_rad))},
         {"--gyro-drift", 0, "DEG/S", "bias of the turn rate, and its change in ten minutes (standard deviation)",
          number_text(sensors.gyro_drift_rad_s / kDegree_rad),
          within({0.0, 57.29}, store_number(sensors.gyro_drift_rad_s, kDegree_rad))},
         {"--depth-noise", 0, "M", "noise of the depth (standard deviation)", number_text(sensors.depth_noise_m),
          within({0.0, 10.0}, store_number(sensors.depth_noise_m))},
         {"--nav-delay", 0, "S", "delay of the navigation's times against those of the sonar",
          number_text(sensors.delay_s), within({-3600.0, 3600.0}, store_number(sensors.delay_s))}}},
       {"Sonar",
        {{"--seed", 0, "N", "seed of the random numbers", fmt::format("{}", sonar.seed), store_number(sonar.seed)},
         {"--range", 0, "M", "range of a beam, where its last bin ends", "by world", store_optional(command.range_m)},
         {"--bins", 0, "N", "number of bins of a beam", fmt::format("{}", sonar.bins),
          within({1.0, 10'000.0}, store_number(sonar.bins))},
         {"--bin-length", 0, "M", "length of a bin, instead of --range", "by world",
          within({1e-6, 1.0}, store_optional(command.bin_length_m))},
         {"--beams-per-turn", 0, "N", "number of beams in a full turn", fmt::format("{}", sonar.beams_per_turn),
          within({4.0, 6400.0}, store_number(sonar.beams_per_turn))},
         {"--beam-width", 0, "DEG", "horizontal beam width, between the points of half power",
          number_text(sonar.beam_width_rad / kDegree_rad),
          within({0.0, 57.29, Limits::Ends::kLowOut}, store_number(sonar.beam_width_rad, kDegree_rad))},
         {"--beam-height", 0, "DEG", "vertical beam width, likewise", number_text(sonar.beam_height_rad / kDegree_rad),
          within({0.0, 114.59, Limits::Ends::kLowOut}, store_number(sonar.beam_height_rad, kDegree_rad))},
         {"--side-lobes", 0, "F", "side lobes: 0 none, 1 those of a rectangular transducer",
          number_text(sonar.side_lobes), within({0.0, 1.0}, store_number(sonar.side_lobes))},
         {"--gain", 0, "F", "fraction of the loss with range that the receiver compensates, 0..1",
          number_text(sonar.gain), within({0.0, 1.0}, store_number(sonar.gain))},
         {"--compression", 0, "C", "exponent that maps amplitudes to 8 bits: 1 is linear, less amplifies weak ones",
          number_text(sonar.compression), within({0.1, 1.0}, store_number(sonar.compression))},
         {"--absorption", 0, "DB/M", "absorption by the water, one way", number_text(sonar.absorption_db_per_m),
          within({0.0, 10.0}, store_number(sonar.absorption_db_per_m))},
         {"--ringing", 0, "M", "range up to which the transducer rings", number_text(sonar.ringing_m),
          within({0.0, 10'000.0}, store_number(sonar.ringing_m))},
         {"--speckle", 0, "F", "speckle: 0 none, 1 full fading of each bin", number_text(sonar.speckle),
          within({0.0, 1.0}, store_number(sonar.speckle))},
         {"--noise", 0, "N", "mean background amplitude near the head, 0..255", number_text(sonar.noise),
          within({0.0, 255.0}, store_number(sonar.noise))},
         {"--multipath", 0, "F", "fraction of the mirrored sound that reaches other surfaces, 0..1",
          number_text(sonar.multipath), within({0.0, 1.0}, store_number(sonar.multipath))},
         {"--bubbles", 0, "F", "fraction of beams with noise only", number_text(sonar.silent),
          within({0.0, 1.0}, store_number(sonar.silent))},
         {"--lost", 0, "F", "fraction of beams missing in the log", number_text(sonar.lost),
          within({0.0, 1.0, Limits::Ends::kHighOut}, store_number(sonar.lost))},
         config_option()}}},
      {"pingvox simulate tank -o tank.csv", "pingvox simulate tank -o - --seed 7 | pingvox map - -o tank.bt",
       "pingvox simulate harbour -o harbour.csv --trajectory loop --truth harbour-truth",
       "pingvox simulate marina -o marina.csv --trajectory by-hand --nav nav.csv --truth marina-truth",
       "pingvox simulate wreck.stl -o wreck.csv --poses dive.tum --drift 0.3 --truth wreck-truth"},
      ""};
  for (auto& group : table.groups) {
    for (Option& option : group.options) {
      if (group.title == "Navigation") option.only_with = {{"--nav"}};
      const Condition moves{"--trajectory", {"line", "lawn-mower", "loop", "by-hand"}}, follows{"--poses"};
      if (option.name == "--side") option.only_with = {{"WORLD", {"tank"}}};
      if (option.name == "--resolution") option.only_with = {{"--truth"}};
      if (option.name == "--speed") option.only_with = {moves};
      if (option.name == "--drift" || option.name == "--heading-drift") option.only_with = {moves, follows};
    }
  }
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    const Result<Format> output_as = output_format(command.output, std::nullopt, kCsvOnly);
    if (!output_as) return tl::unexpected(output_as.error());
    if (!poses.empty()) command.poses = poses;
    if (!truth.empty()) command.truth = truth;
    if (!nav.empty()) command.nav = nav;
    command.drift.seed = sonar.seed;
    sensors.seed = sonar.seed;
    if (command.range_m && command.bin_length_m) return usage_error("--range and --bin-length: exclude each other");
    if (command.poses && command.motion != Motion::kStill)
      return usage_error("--poses and --trajectory: exclude each other");
    if (command.output == "-" && (command.poses || command.motion != Motion::kStill)) {
      return usage_error("-o -: a moving vehicle has two files: give the name of the log");
    }
    if (command.turns && !(*command.turns >= 1 && *command.turns <= 10'000)) {
      return usage_error(fmt::format("--turns: must be 1..10000, is {}", *command.turns));
    }
    if (command.truth_resolution_m) {
      const auto lattice = Lattice::make(*command.truth_resolution_m);
      if (!lattice) return tl::unexpected(lattice.error());
    }
    if (command.range_m) {
      const auto bins = static_cast<double>(sonar.bins);
      const Limits bins_m{1e-6 * bins, bins};
      if (!bins_m.contain(*command.range_m)) {
        return usage_error(fmt::format("--range: must be {} m with {} bins, is {} m", bins_m.text(), sonar.bins,
                                       number_text(*command.range_m)));
      }
    }
    // The bin length may follow from the world.
    SonarOptions set = sonar;
    set.bin_length_m = command.range_m ? *command.range_m / static_cast<double>(std::max<std::size_t>(sonar.bins, 1))
                                       : command.bin_length_m.value_or(sonar.bin_length_m);
    if (const auto valid = set.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = tank.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = command.travel.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = command.drift.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = sensors.validate(); !valid) return tl::unexpected(valid.error());
    CommandFiles files;
    files.read("WORLD", command.world);
    files.read("--poses", poses);
    files.read("--config", parsed.config);
    files.write("-o", command.output);
    if (command.poses || command.motion != Motion::kStill) {
      files.write("the trajectory beside -o,",
                  std::filesystem::path(command.output).replace_extension(".tum").string());
    }
    files.write("--nav", nav);
    if (command.truth) {
      for (const char* name : {"poses.tum", "ranges.csv", "world.ply", "world.bt", "nav.toml"}) {
        files.write("--truth", (std::filesystem::path(truth) / name).string());
      }
    }
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    if (const auto folder = check_folder_of(command.output); !folder) return tl::unexpected(folder.error());
    if (nav == "-") return usage_error("--nav -: give the name of a file");
    if (command.nav) {
      if (const auto folder = check_folder_of(nav); !folder) return tl::unexpected(folder.error());
    }
    return command;
  });
}

}  // namespace pingvox::app
