#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
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

/// Takes options out of their groups, in this order, for a group that comes first.
OptionTable::Group options_first(std::vector<OptionTable::Group>& groups, std::string title,
                                 std::initializer_list<std::string_view> names) {
  OptionTable::Group first{std::move(title), {}};
  for (const std::string_view name : names) {
    for (OptionTable::Group& group : groups) {
      const auto option = std::ranges::find(group.options, name, &Option::name);
      if (option == group.options.end()) continue;
      first.options.push_back(std::move(*option));
      group.options.erase(option);
    }
  }
  return first;
}

}  // namespace

Result<Command> map_command(const Args& args) {
  MapCommand command;
  std::string output;
  std::optional<Format> asked_format;
  BuildArgs build;
  MapOptions& map = build.map;
  const Take origin = [&](const std::string& text) -> Result<void> {
    const auto n = numbers_from<3>(text);
    if (!n) return tl::unexpected(n.error());
    const Eigen::Vector3d place(n->data());
    if (!place.allFinite()) return usage_error(fmt::format("'{}': must be finite", text));
    command.cloud_origin_m = place;
    return {};
  };

  OptionTable::Group map_options = map_group(build);
  for (Option& option : tree_options(build)) map_options.options.push_back(std::move(option));
  for (Option& option : occupancy_options(command.occupancy)) map_options.options.push_back(std::move(option));
  OptionTable::Group sensor_options = sensor_group(build);
  Option origin_option{
      "--origin", 0, "X,Y,Z", "position from which a cloud was recorded, in the map frame", "0,0,0; PCD: its VIEWPOINT",
      origin};
  origin_option.only_for = {std::string(kClouds)};
  sensor_options.options.push_back(std::move(origin_option));
  std::vector<OptionTable::Group> groups = {
      {"Output",
       {output_option(output,
                      "the map: .bt or .ot (OctoMap), .pvx (any depth), .ply .pcd .xyz (occupied cells as "
                      "points); - is standard output"),
        choice("--format", kMapFormats, "format of the map where its name has none of these suffixes", asked_format,
               "by suffix, else bt"),
        json_option(command.output_options), quiet_option(command.output_options),
        choice("--progress", kProgress, "show the progress on standard error; auto: on a terminal",
               command.output_options.progress)}},
      std::move(map_options),
      std::move(sensor_options),
      echo_group(build.echoes, WaterOfNav::kYes),
      {"Input",
       {strict_option(command.damage), topic_option(command.bag), fields_option(command.bag), config_option()}}};
  groups.insert(groups.begin(), options_first(groups, "Most used",
                                              {"--output", "--nav", "--nav-offset", "--poses", "--mount",
                                               "--resolution", "--min-range", "--max-range", "--beam", "--threshold"}));
  const OptionTable table{
      "map",
      "Builds a 3D occupancy map from sonar logs, in the order given: detects the echo of each beam, marks the cells\n"
      "up to it free and those at its range occupied.",
      {{"LOG", Positional::Count::kMany,
        "beams (Ping Viewer's .bin, SonarView's .svlog, SeaNet, ROS bags, MATLAB 5, CSV), point scans (OctoMap's "
        ".graph and .log, .xtf of a multibeam) or "
        "clouds of points (PLY, PCD, XYZ), recognised by content; - is standard input",
        store_each(command.logs)}},
      std::move(groups),
      {"pingvox map tank.csv -o tank.bt",
       "pingvox map dive1.csv dive2.csv -o reef.ot --poses dive.tum --mount 0.4,0,-0.2,180,0,0",
       "pingvox map dive.csv -o reef.ot --nav dive.tlog --nav-offset -1712333808.974",
       "pingvox map dive.db3 -o net.bt --nav dive.db3", "pingvox map scans.graph -o scans.bt --resolution 0.1",
       "pingvox map multibeam.ply -o bottom.ot --origin 0,0,-0.5", "pingvox map - -o - < tank.csv > tank.bt"},
      "Point scans and clouds have no beam: only the options of the map (except --vote), --ray, --max-range and, for\n"
      "clouds, --origin apply; for scans in ROS bags also --topic, --mount, and the options of poses.\n"
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    const Result<Format> output_as = output_format(output, asked_format, kMapFormats);
    if (!output_as) return tl::unexpected(output_as.error());
    command.format = *output_as;
    command.limited = parsed.limited;
    if (const auto valid = command.occupancy.validate(); !valid) return tl::unexpected(valid.error());
    if (command.occupancy.cut_depth > map.depth) {
      return usage_error(fmt::format("--cut-depth: must be in 1..{}, the levels of the map, is {}", map.depth,
                                     *command.occupancy.cut_depth));
    }
    map.thresholds = command.occupancy.apply_to(map.thresholds);
    command.map = map;
    if (const auto valid = build.echoes.validate(build.navs); !valid) return tl::unexpected(valid.error());
    command.build = build.build_options();
    command.head = build.head;
    command.background_m = build.echoes.background_m;
    command.nav_salinity = build.echoes.nav_salinity;
    if (const auto valid = command.map.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = check_options(command.build); !valid) return tl::unexpected(valid.error());
    if (map.depth != Lattice::kDefaultDepth && (*output_as == Format::kBt || *output_as == Format::kOt)) {
      return usage_error(fmt::format("{}: .{} holds maps of {} levels, not of {}: use .pvx", output,
                                     name_of(*output_as), Lattice::kDefaultDepth, map.depth));
    }
    if (output == "-" && command.output_options.report == Report::kJson) {
      return usage_error("-o - and --json: both write to standard output");
    }
    const Result<PathArgs> path = build.path();
    if (!path) return tl::unexpected(path.error());
    command.path = *path;
    CommandFiles files;
    files.read("LOG", command.logs);
    files.read("--config", parsed.config);
    files.read("--fields", command.bag.file);
    build.name_files(files);
    files.write("-o", output);
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    if (const auto folder = check_folder_of(output); !folder) return tl::unexpected(folder.error());
    command.output = output;
    command.made_by = command_text("map", args);
    return command;
  });
}

}  // namespace pingvox::app
