#include <array>
#include <string>
#include <utility>

#include "command_files.hpp"
#include "echo_options.hpp"
#include "mapping_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kFits = {Choice<FitParameter>{"sound-speed", FitParameter::kSoundSpeed},
                              Choice<FitParameter>{"mount-yaw", FitParameter::kMountYaw},
                              Choice<FitParameter>{"nav-offset", FitParameter::kNavOffset},
                              Choice<FitParameter>{"mount-xy", FitParameter::kMountXy}};

}  // namespace

Result<Command> evaluate_command(const Args& args) {
  EvaluateCommand command;
  RecordingArgs& recording = command.recording;
  BuildArgs build;
  OccupancyArgs occupancy;
  OptionTable::Group map_options = map_group(build);
  map_options.options.push_back(threads_option(build.build.threads));
  for (Option& option : occupancy_options(occupancy)) {
    if (option.name != "--cut-depth") map_options.options.push_back(std::move(option));
  }
  const OptionTable table{
      "evaluate",
      "Estimates how far a map of these logs can be trusted, without ground truth: holds echoes out, predicts\n"
      "them by the map of the other sweeps, and counts how many come from where the map has a wall. The options are\n"
      "those of 'map'; no map is written.",
      {{"LOG", Positional::Count::kMany, "beams, as for 'map'; - is standard input", store_each(recording.logs)}},
      {{"Evaluation",
        {folds_option(command.evaluation.folds),
         choice("--fit", kFits,
                "also estimate the value that predicts most echoes, with its standard deviation; takes some 20 times "
                "as long",
                command.fit, "nothing"),
         json_option(command.output_options), quiet_option(command.output_options),
         choice("--progress", kProgress, "show the progress on standard error; auto: on a terminal",
                command.output_options.progress)}},
       std::move(map_options),
       sensor_group(build),
       echo_group(build.echoes, WaterOfNav::kYes),
       {"Input",
        {strict_option(recording.damage), topic_option(recording.bag), fields_option(recording.bag), config_option()}}},
      {"pingvox evaluate tank.csv", "pingvox evaluate dive.csv --poses dive.tum --resolution 0.1 --json",
       "pingvox evaluate dive.db3 --nav dive.db3"},
      "Exit status: 0 done, 1 failed, 2 invalid usage. A bad map is not a failure: see the verdict."};
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    command.limited = parsed.limited;
    if (const auto valid = occupancy.validate(); !valid) return tl::unexpected(valid.error());
    command.evaluation.map = build.map;
    command.evaluation.map.thresholds = occupancy.apply_to(build.map.thresholds);
    if (const auto valid = build.apply_to(recording, command.evaluation.map, command.evaluation.build); !valid) {
      return tl::unexpected(valid.error());
    }
    if (command.fit == FitParameter::kNavOffset && recording.path.navs.empty() && !recording.path.poses) {
      return usage_error("--fit nav-offset: needs --nav or --poses");
    }
    CommandFiles files;
    files.read("LOG", recording.logs);
    files.read("--config", parsed.config);
    files.read("--fields", recording.bag.file);
    build.name_files(files);
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    return command;
  });
}

}  // namespace pingvox::app
