#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <system_error>

#include "base/suggest.hpp"
#include "command_files.hpp"
#include "nav_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kMotions = {Choice<Motion>{"still", Motion::kStill}, Choice<Motion>{"line", Motion::kLine},
                                 Choice<Motion>{"lawn-mower", Motion::kLawnMower},
                                 Choice<Motion>{"loop", Motion::kLoop}, Choice<Motion>{"by-hand", Motion::kByHand}};
constexpr std::array kCsvOnly = {Choice<Format>{"csv", Format::kCsv}};

OptionTable::Group simulated_nav_group(NavSensorOptions& nav) {
  OptionTable::Group group = {
      "Navigation",
      {number("--dvl-noise", "M/S", "noise of the velocity (standard deviation on each axis)", nav, nav.dvl_noise_m_s),
       number("--dvl-outliers", "F", "fraction of velocities that are wrong by about 1 m/s", nav, nav.dvl_outliers),
       number("--dvl-lost", "F", "fraction of time without bottom lock", nav, nav.dvl_lost),
       number("--dvl-yaw", "DEG", "mounting angle of the DVL (standard deviation over seeds)", nav, nav.dvl_yaw_rad),
       number("--dvl-scale", "F", "scale error of the velocity: true over measured, less 1 (likewise)", nav,
              nav.dvl_scale),
       number("--compass-deviation", "DEG", "amplitude of the deviation curve of the compass (likewise)", nav,
              nav.compass_deviation_rad),
       number("--attitude-noise", "DEG", "noise of roll, pitch and yaw (standard deviation)", nav,
              nav.attitude_noise_rad),
       number("--gyro-noise", "DEG/S", "noise of the turn rate (standard deviation)", nav, nav.gyro_noise_rad_s),
       number("--gyro-drift", "DEG/S", "bias of the turn rate, and its change in ten minutes (standard deviation)", nav,
              nav.gyro_drift_rad_s),
       number("--depth-noise", "M", "noise of the depth (standard deviation)", nav, nav.depth_noise_m),
       number("--nav-delay", "S", "seconds by which the times of the navigation are later than those of the sonar", nav,
              nav.delay_s)}};
  for (Option& option : group.options) option.only_with = {{"--nav"}};
  return group;
}

OptionTable::Group simulated_sonar_group(SimulateCommand& command) {
  SonarOptions& sonar = command.sonar;
  return {
      "Sonar",
      {number("--seed", "N", "seed of the random numbers", sonar.seed),
       {"--range", 0, "M", "range of a beam, where its last bin ends", "by world", store_optional(command.range_m)},
       number("--bins", "N", "number of bins of a beam", sonar, sonar.bins),
       {"--bin-length", 0, "M", "length of a bin, instead of --range", "by world",
        store_optional(command.bin_length_m)},
       number("--beams-per-turn", "N", "number of beams in a full turn", sonar, sonar.beams_per_turn),
       number("--beam-width", "DEG", "horizontal beam width, full angle at half power", sonar, sonar.beam_width_rad),
       number("--beam-height", "DEG", "vertical beam width, full angle at half power", sonar, sonar.beam_height_rad),
       number("--side-lobes", "F", "side lobes: 0 none, 1 those of a rectangular transducer", sonar, sonar.side_lobes),
       number("--gain", "F", "fraction of the loss with range that the receiver compensates, 0..1", sonar, sonar.gain),
       number("--compression", "C", "exponent that maps amplitudes to 8 bits: 1 linear, less amplifies weak echoes",
              sonar, sonar.compression),
       number("--absorption", "DB/M", "absorption by the water, one way", sonar, sonar.absorption_db_per_m),
       number("--ringing", "M", "range up to which the transducer rings", sonar, sonar.ringing_m),
       number("--speckle", "F", "speckle: 0 none, 1 full fading of each bin", sonar, sonar.speckle),
       number("--noise", "N", "mean background amplitude near the head, 0..255", sonar, sonar.noise),
       number("--multipath", "F", "fraction of the mirrored sound that reaches other surfaces, 0..1", sonar,
              sonar.multipath),
       number("--bubbles", "F", "fraction of beams with only noise", sonar, sonar.silent),
       number("--lost", "F", "fraction of beams missing in the log", sonar, sonar.lost),
       config_option()}};
}

/// Refuses a bin length that is out of range, which may follow from the world.
Result<void> check_sonar(const SimulateCommand& command) {
  SonarOptions set = command.sonar;
  const auto bins = static_cast<double>(command.sonar.bins);
  set.bin_length_m =
      command.range_m ? *command.range_m / bins : command.bin_length_m.value_or(command.sonar.bin_length_m);
  if (const auto limits = set.errors().limits_of(&set.bin_length_m)) {
    return usage_error(
        command.range_m
            ? fmt::format("--range: must be {} m with {} bins, is {} m", limits->text(1.0 / bins), command.sonar.bins,
                          number_text(*command.range_m))
            : fmt::format("--bin-length: must be {}, is {}", limits->text(), number_text(*command.bin_length_m)));
  }
  return set.validate();
}

Result<Command> finish_simulate(SimulateCommand command, const Parsed& parsed) {
  const Result<Format> output_as = output_format(command.output, std::nullopt, kCsvOnly);
  if (!output_as) return tl::unexpected(output_as.error());
  command.drift.seed = command.nav_sensors.seed = command.sonar.seed;
  if (command.range_m && command.bin_length_m) return usage_error("--range and --bin-length: exclude each other");
  if (command.poses && command.motion != Motion::kStill)
    return usage_error("--poses and --trajectory: exclude each other");
  if (command.output == "-" && (command.poses || command.motion != Motion::kStill)) {
    return usage_error("-o -: a moving vehicle has two files: give the name of the log");
  }
  if (command.truth_resolution_m) {
    const auto lattice = Lattice::make(*command.truth_resolution_m);
    if (!lattice) return tl::unexpected(lattice.error());
  }
  if (const auto valid = check_sonar(command); !valid) return tl::unexpected(valid.error());
  for (const Result<void>& valid :
       {command.tank.validate(), command.travel.validate(), command.drift.validate(), command.nav_sensors.validate()}) {
    if (!valid) return tl::unexpected(valid.error());
  }
  CommandFiles files;
  files.read("WORLD", command.world);
  files.read("--poses", command.poses.value_or(""));
  files.read("--config", parsed.config);
  files.write("-o", command.output);
  if (command.poses || command.motion != Motion::kStill) {
    files.write("the trajectory beside -o,", std::filesystem::path(command.output).replace_extension(".tum").string());
  }
  files.write("--nav", command.nav.value_or(""));
  if (command.truth) {
    for (const char* name : {"poses.tum", "ranges.csv", "world.ply", "world.bt", "nav.toml"}) {
      files.write("--truth", (std::filesystem::path(*command.truth) / name).string());
    }
  }
  if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
  if (command.nav == "-") return usage_error("--nav -: give the name of a file");
  for (const std::string& file : {command.output, command.nav.value_or(command.output)}) {
    if (const auto folder = check_folder_of(file); !folder) return tl::unexpected(folder.error());
  }
  return command;
}

}  // namespace

Result<Command> simulate_command(const Args& args) {
  SimulateCommand command;
  TankOptions& tank = command.tank;
  SonarOptions& sonar = command.sonar;
  TravelOptions& travel = command.travel;
  DriftOptions& drift = command.drift;
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
  const std::vector<Condition> moves = {{"--trajectory", {"line", "lawn-mower", "loop", "by-hand"}}};
  const std::vector<Condition> drifts = {moves.front(), {"--poses"}};
  const OptionTable table{
      "simulate",
      "Simulates the log of a scanning sonar in a world of your choice, with ground truth on request. The same "
      "options\n"
      "give the same bytes.",
      {{"WORLD", Positional::Count::kOne,
        "tank (square, with a floater), harbour (quay walls, piles, a hull), marina (canals and basins, 400 m long), "
        "seabed (a slope with boulders), cave (a tunnel), or the file of a mesh in metres (OFF, PLY, STL)",
        world}},
      {{"Output",
        {output_option(command.output,
                       "the log, .csv; - is standard output. The reported trajectory of a moving vehicle is written "
                       "beside it as .tum"),
         {"--truth", 0, "DIR", "folder for ground truth: poses.tum, ranges.csv, world.ply (a mesh), world.bt (a map)",
          "none", store(command.truth)},
         {"--nav", 0, "FILE",
          "measurements of the vehicle's navigation sensors as CSV: a DVL, a compass, gyros and a depth sensor", "none",
          store(command.nav)},
         only_with({{"--truth"}}, {"--resolution", 0, "M", "edge length of a cell of world.bt", "0.05; marina 0.2",
                                   within(kResolutions, store_optional(command.truth_resolution_m))}),
         quiet_option(command.output_options)}},
       {"World and vehicle",
        {only_with({{"WORLD", {"tank"}}}, number("--side", "M", "side of the square tank", tank, tank.side_m)),
         choice("--trajectory", kMotions,
                "path of the vehicle; still: at 0,0,0; by-hand: the loop, once, with stops and sudden turns",
                command.motion),
         {"--poses", 0, "FILE", "path of the vehicle as TUM lines, instead of --trajectory", "none",
          store(command.poses)},
         mount_option(sonar.body_from_sensor),
         only_with(moves, number("--speed", "M/S", "speed of the vehicle", travel, travel.speed_m_s)),
         {"--turns", 0, "N", "turns of the head", "5; of a moving vehicle: to the end of its path",
          within({1.0, 10'000.0}, store_optional(command.turns))},
         only_with(drifts, number("--drift", "M", "error of the reported position after a minute (standard deviation)",
                                  drift, drift.position_m)),
         only_with(drifts,
                   number("--heading-drift", "DEG", "error of the reported heading after a minute (standard deviation)",
                          drift, drift.heading_rad))}},
       simulated_nav_group(command.nav_sensors),
       simulated_sonar_group(command)},
      {"pingvox simulate tank -o tank.csv", "pingvox simulate tank -o - --seed 7 | pingvox map - -o tank.bt",
       "pingvox simulate harbour -o harbour.csv --trajectory loop --truth harbour-truth",
       "pingvox simulate marina -o marina.csv --trajectory by-hand --nav nav.csv --truth marina-truth",
       "pingvox simulate wreck.stl -o wreck.csv --poses dive.tum --drift 0.3 --truth wreck-truth"},
      ""};
  return parse_command(table, args, [&](const Parsed& parsed) { return finish_simulate(command, parsed); });
}

}  // namespace pingvox::app
