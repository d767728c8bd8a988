#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <system_error>

#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"
#include "suggest.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kMotions = {Word<Motion>{"still", Motion::kStill}, Word<Motion>{"line", Motion::kLine},
                                 Word<Motion>{"lawn-mower", Motion::kLawnMower}, Word<Motion>{"loop", Motion::kLoop}};
constexpr std::array kCsvOnly = {Word<Format>{"csv", Format::kCsv}};

}  // namespace

Result<Command> simulate_command(const Words& words) {
  SimulateCommand command;
  TankOptions& tank = command.tank;
  SonarOptions& sonar = command.sonar;
  const Take world = [&](const std::string& text) -> Result<void> {
    const Words known = {"tank", "harbour", "seabed", "cave"};
    std::error_code error;
    const bool is_known = std::find(known.begin(), known.end(), text) != known.end();
    if (!is_known && !std::filesystem::path(text).has_extension() && !std::filesystem::exists(text, error)) {
      return off(fmt::format("there is no world '{}', only: {}, or a mesh (.off, .ply, .stl){}", text,
                             fmt::join(known, ", "), did_you_mean(text, known)));
    }
    command.world = text;
    return {};
  };
  std::string poses, truth;
  const OptionTable table{
      "simulate",
      "Makes the log of a turning sonar in a world of your choice, and tells the truth about it if asked. The same\n"
      "options give the same bytes.",
      {{"WORLD", Positional::Count::kOne,
        "tank (square, with a floater), harbour (quay walls, piles, a hull), seabed (a slope with boulders), cave (a "
        "tunnel), or the file of a mesh in metres (OFF, PLY, STL)",
        world}},
      {{"Output",
        {output_option(command.output,
                       "the log, .csv; - is standard output. Of a vehicle that moves, a .tum beside it holds where it "
                       "reports to have been"),
         {"--truth", 0, "DIR",
          "write there what is true: poses.tum, ranges.csv, and the world as world.ply (a mesh) and world.bt (a map)",
          "none", into(truth)},
         {"--resolution", 0, "M", "edge of a cell of world.bt", shown(command.truth_resolution_m),
          into_number(command.truth_resolution_m)},
         quiet_option(command.manner)}},
       {"World and vehicle",
        {{"--side", 0, "M", "of the square tank", shown(tank.side_m),
          within({2.0 * std::max(std::abs(tank.sensor_x_m), std::abs(tank.sensor_y_m)), 1000.0, Limits::Ends::kLowOut},
                 into_number(tank.side_m))},
         choice("--trajectory", kMotions, "what the vehicle does; still is at 0,0,0", command.motion),
         {"--poses", 0, "FILE", "its way as TUM lines, instead of a trajectory of ours", "none", into(poses)},
         {"--speed", 0, "M/S", "of the vehicle", shown(command.travel.speed_m_s),
          within({0.0, 100.0, Limits::Ends::kLowOut}, into_number(command.travel.speed_m_s))},
         {"--turns", 0, "N", "how often the head turns round", "5; of a vehicle that moves, until it has arrived",
          into_optional(command.turns)},
         {"--drift", 0, "M", "how far reported positions stray in a minute (standard deviation)",
          shown(command.drift.position_m), within({0.0, 1000.0}, into_number(command.drift.position_m))},
         {"--heading-drift", 0, "DEG", "how far reported headings stray in a minute",
          shown(command.drift.heading_rad / kDegree_rad),
          within({0.0, 572.95}, into_number(command.drift.heading_rad, kDegree_rad))}}},
       {"Sonar",
        {{"--seed", 0, "N", "of speckle, noise, dropouts and drift", fmt::format("{}", sonar.seed),
          into_number(sonar.seed)},
         {"--range", 0, "M", "to the end of the last bin", "by world", into_optional(command.range_m)},
         {"--bins", 0, "N", "of a beam", fmt::format("{}", sonar.bins),
          within({1.0, 10'000.0}, into_number(sonar.bins))},
         {"--bin-length", 0, "M", "of a bin, instead of --range", "by world",
          within({1e-6, 1.0}, into_optional(command.bin_length_m))},
         {"--beams-per-turn", 0, "N", "directions of the head", fmt::format("{}", sonar.beams_per_turn),
          within({4.0, 6400.0}, into_number(sonar.beams_per_turn))},
         {"--beam-width", 0, "DEG", "horizontally, between the points of half power",
          shown(sonar.beam_width_rad / kDegree_rad),
          within({0.0, 57.29, Limits::Ends::kLowOut}, into_number(sonar.beam_width_rad, kDegree_rad))},
         {"--beam-height", 0, "DEG", "the same vertically", shown(sonar.beam_height_rad / kDegree_rad),
          within({0.0, 114.59, Limits::Ends::kLowOut}, into_number(sonar.beam_height_rad, kDegree_rad))},
         {"--side-lobes", 0, "S", "0 none, 1 those of a plain rectangular face", shown(sonar.side_lobes),
          within({0.0, 1.0}, into_number(sonar.side_lobes))},
         {"--gain", 0, "G", "share of the loss with range that is made up for, 0..1", shown(sonar.gain),
          within({0.0, 1.0}, into_number(sonar.gain))},
         {"--compression", 0, "C", "exponent by which amplitudes become 8 bits: 1 linear, less brings out the faint",
          shown(sonar.compression), within({0.1, 1.0}, into_number(sonar.compression))},
         {"--absorption", 0, "DB/M", "by the water, one way", shown(sonar.absorption_db_per_m),
          within({0.0, 10.0}, into_number(sonar.absorption_db_per_m))},
         {"--ringing", 0, "M", "up to which the head hears itself", shown(sonar.ringing_m),
          within({0.0, 10'000.0}, into_number(sonar.ringing_m))},
         {"--speckle", 0, "S", "0 none, 1 full fading of each bin", shown(sonar.speckle),
          within({0.0, 1.0}, into_number(sonar.speckle))},
         {"--noise", 0, "N", "mean amplitude of the background near the head, of 255", shown(sonar.noise),
          within({0.0, 255.0}, into_number(sonar.noise))},
         {"--multipath", 0, "S", "share of what surfaces mirror that goes on, 0..1", shown(sonar.multipath),
          within({0.0, 1.0}, into_number(sonar.multipath))},
         {"--bubbles", 0, "S", "share of beams in which nothing is heard but noise", shown(sonar.silent),
          within({0.0, 1.0}, into_number(sonar.silent))},
         {"--lost", 0, "S", "share of beams that are missing in the log", shown(sonar.lost),
          within({0.0, 1.0, Limits::Ends::kHighOut}, into_number(sonar.lost))},
         config_option()}}},
      {"pingvox simulate tank -o tank.csv", "pingvox simulate tank -o - --seed 7 | pingvox map - -o tank.bt",
       "pingvox simulate harbour -o harbour.csv --trajectory loop --truth harbour-truth",
       "pingvox simulate wreck.stl -o wreck.csv --poses dive.tum --drift 0.3 --truth wreck-truth"},
      ""};
  return parsed(table, words, [&]() -> Result<Command> {
    const Result<Format> output_as = output_format(command.output, std::nullopt, kCsvOnly);
    if (!output_as) return tl::unexpected(output_as.error());
    if (!poses.empty()) command.poses = poses;
    if (!truth.empty()) command.truth = truth;
    command.drift.seed = sonar.seed;
    if (command.range_m && command.bin_length_m) return off("--range and --bin-length: say one of the two");
    if (command.poses && command.motion != Motion::kStill) return off("--poses and --trajectory: say one of the two");
    if (command.output == "-" && (command.poses || command.motion != Motion::kStill)) {
      return off("-o -: of a vehicle that moves, two files are written: name the first one");
    }
    if (command.turns && !(*command.turns >= 1 && *command.turns <= 10'000)) {
      return off(fmt::format("--turns: must be 1..10000, is {}", *command.turns));
    }
    if (const auto lattice = Lattice::make(command.truth_resolution_m); !lattice) {
      return tl::unexpected(lattice.error());
    }
    if (command.range_m) {
      const auto bins = static_cast<double>(sonar.bins);
      const Limits bins_m{1e-6 * bins, bins};
      if (!bins_m.hold(*command.range_m)) {
        return off(fmt::format("--range: must be {} m with {} bins, is {} m", bins_m.text(), sonar.bins,
                               shown(*command.range_m)));
      }
    }
    // Of the sonar all but the bin length, which waits for the world.
    SonarOptions set = sonar;
    set.bin_length_m = command.range_m ? *command.range_m / static_cast<double>(std::max<std::size_t>(sonar.bins, 1))
                                       : command.bin_length_m.value_or(sonar.bin_length_m);
    if (const auto valid = set.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = tank.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = command.travel.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = command.drift.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto once = check_standard_input({command.world, poses}); !once) return tl::unexpected(once.error());
    if (const auto folder = check_folder_of(command.output); !folder) return tl::unexpected(folder.error());
    return command;
  });
}

}  // namespace pingvox::app
