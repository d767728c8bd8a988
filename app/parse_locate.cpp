#include <fmt/format.h>

#include <optional>
#include <string>

#include "command_files.hpp"
#include "echo_options.hpp"
#include "nav_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"
#include "slam_options.hpp"

namespace pingvox::app {

Result<Command> locate_command(const Args& args) {
  LocateCommand command;
  std::string output, odometry;
  EchoArgs echoes;
  LocalizerOptions& localizer = command.localizer;
  RecordingArgs& recording = command.recording;
  std::string calibration;
  OptionTable::Group echo_options = echo_group(echoes, WaterOfNav::kYes);
  std::erase_if(echo_options.options, [](const Option& option) { return option.name == "--background"; });
  for (Option& option : echo_options.options) option.only_for.clear();
  OptionTable::Group estimation{"Estimation", {start_option(command.start)}};
  for (Option& option : locate_options(localizer, command.estimation)) estimation.options.push_back(std::move(option));
  Option map{"--map", 0, "FILE", "the map, .bt, .ot or .pvx", "", store(command.map)};
  map.is_required = true;
  OptionTable::Group known_map{"Map", {std::move(map)}};
  for (Option& option : height_options(command.min_z_m, command.max_z_m))
    known_map.options.push_back(std::move(option));
  const OptionTable table{
      "locate",
      "Finds the vehicle in a known map by the echoes of a scanning sonar, and by navigation where there is any. If\n"
      "several places fit equally well, all are reported. Poses that may be wrong are counted; --only-sure drops\n"
      "them.",
      {{"LOG", Positional::Count::kMany, "beams, as for 'map'; - is standard input", store_each(recording.logs)}},
      {{"Output",
        {output_option(output,
                       "the trajectory of the vehicle as TUM lines 't x y z qx qy qz qw'; - is standard output"),
         flag("--only-sure", "leave out poses that may be wrong: while several places fit, or none does",
              command.written, WrittenPoses::kSure),
         json_option(command.output_options), quiet_option(command.output_options)}},
       std::move(known_map),
       {"Navigation",
        {nav_option(recording.path.navs,
                    "navigation log, as for 'slam': a heading, and velocity over ground where it has one"),
         nav_source_option(recording.path.nav_sources),
         nav_offset_option(recording.path.nav_offset_s),
         nav_mount_option(recording.nav_mounts),
         use_calibration_option(calibration, "correct --nav with a file of 'slam --calibration'"),
         {"--odometry", 0, "FILE", "odometry of the vehicle as TUM lines, in a frame that may drift, instead of --nav",
          "", store(odometry)},
         mount_option(recording.body_from_sonar)}},
       std::move(estimation),
       std::move(echo_options),
       {"Input",
        {strict_option(recording.damage), topic_option(recording.bag), fields_option(recording.bag), config_option()}}},
      {"pingvox locate dive.csv --map harbour.bt --nav dvl.csv -o dive.tum",
       "pingvox locate tank.csv --map tank.bt --start 0.1,0.2,45 -o tank.tum --json"},
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    if (const auto valid = echoes.validate(recording.path.navs); !valid) return tl::unexpected(valid.error());
    localizer.sound_speed_ratio = echoes.sound_speed_ratio();
    recording.nav_salinity = echoes.nav_salinity;
    localizer.filter = echoes.filter_options();
    localizer.echo = echoes.echo;
    if (const auto valid = localizer.validate(); !valid) return tl::unexpected(valid.error());
    if (command.min_z_m && command.max_z_m && !(*command.min_z_m < *command.max_z_m)) {
      return usage_error("--min-z must be below --max-z");
    }
    if (command.map.empty()) return usage_error("--map is missing: the map to find the vehicle in");
    if (output.empty()) return usage_error("-o FILE is missing");
    if (output == "-" && command.output_options.report == Report::kJson) {
      return usage_error("-o - and --json: both write to standard output");
    }
    if (!odometry.empty()) {
      if (!recording.path.navs.empty()) return usage_error("--nav and --odometry: exclude each other");
      recording.path.poses = odometry;
    }
    if (!calibration.empty()) recording.path.calibration = calibration;
    CommandFiles files;
    files.read("LOG", recording.logs);
    files.read("--map", command.map);
    files.read("--nav", recording.path.navs);
    files.read("--odometry", odometry);
    files.read("--use-calibration", calibration);
    files.read("--fields", recording.bag.file);
    files.read("--config", parsed.config);
    files.write("-o", output);
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = check_trajectory_output(output); !valid) return tl::unexpected(valid.error());
    if (const auto folder = check_folder_of(output); !folder) return tl::unexpected(folder.error());
    command.output = output;
    return command;
  });
}

}  // namespace pingvox::app
