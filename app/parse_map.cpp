#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "command_files.hpp"
#include "echo_options.hpp"
#include "mapping_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "pingvox/io/byte_stream.hpp"
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

bool is_folder_of_logs(const std::string& path) {
  std::error_code error;
  return path != "-" && std::filesystem::is_directory(path, error) && !ByteStream::open(path);
}

/// Options that change what is said or where it goes, but no map.
constexpr std::array kOfOutput = {"--output",   "--format", "--nav",     "--json",     "--quiet",
                                  "--progress", "--config", "--threads", "--cut-depth"};

/// @param output  a folder, which may be missing, for a map of each dive; else the file of one map
Result<CampaignArgs> campaign_args(const std::string& output, const MapCommand& command, const Parsed& parsed) {
  if (output == "-") return usage_error("-o -: the maps of dives are kept beside the map, which has to be a file");
  if (std::ranges::find(command.recording.logs, "-") != command.recording.logs.end()) {
    return usage_error("-: standard input cannot be one of many dives (--nav is a folder)");
  }
  std::error_code error;
  CampaignArgs campaign;
  campaign.has_sum = !output.ends_with('/') && !std::filesystem::is_directory(output, error);
  campaign.kept = campaign.has_sum ? output + ".dives" : output;
  campaign.made_with = "pingvox " PINGVOX_VERSION;
  for (const auto& [name, value] : parsed.typed) {
    if (std::ranges::find(kOfOutput, name) == kOfOutput.end()) {
      campaign.made_with += fmt::format(" {}={}", name, quote_for_shell(value));
    }
  }
  for (const std::string& file :
       {parsed.config, command.recording.bag.file, command.recording.path.calibration.value_or("")}) {
    if (!file.empty()) campaign.option_files.push_back(file);
  }
  return campaign;
}

/// The format of the map; of the folder of maps of a campaign .pvx, which can be told to be made already.
Result<Format> map_output_format(const std::string& output, const std::optional<Format>& asked, bool is_campaign) {
  std::error_code error;
  const bool is_folder = output.ends_with('/') || std::filesystem::is_directory(output, error);
  if (!is_campaign || !is_folder) return output_format(output, asked, kMapFormats);
  if (asked && *asked != Format::kPvx) {
    return usage_error(fmt::format(
        "--format {}: the maps of dives in a folder are .pvx: 'pingvox convert' makes others", name_of(*asked)));
  }
  return Format::kPvx;
}

}  // namespace

Result<Command> map_command(const Args& args) {
  MapCommand command;
  RecordingArgs& recording = command.recording;
  std::string output;
  std::optional<Format> asked_format;
  BuildArgs build;

  OptionTable::Group map_options = map_group(build);
  for (Option& option : tree_options(build)) map_options.options.push_back(std::move(option));
  for (Option& option : occupancy_options(command.occupancy)) map_options.options.push_back(std::move(option));
  OptionTable::Group sensor_options = sensor_group(build);
  const auto nav = std::ranges::find(sensor_options.options, "--nav", &Option::name);
  nav->help += "; a folder: LOG are many dives, and each takes the navigation of its time (docs/many-dives.md)";
  sensor_options.options.push_back(origin_option(recording.cloud_origin_m));
  std::vector<OptionTable::Group> groups = {
      {"Output",
       {output_option(output,
                      "the map: .bt or .ot (OctoMap), .pvx (any depth), .ply .pcd .xyz (occupied cells as "
                      "points); - is standard output"),
        choice("--format", kMapFormats, "format of the map where its name has none of these suffixes", asked_format,
               "by suffix, bt on standard output"),
        json_option(command.output_options), quiet_option(command.output_options),
        choice("--progress", kProgress, "show the progress on standard error; auto: on a terminal",
               command.output_options.progress)}},
      std::move(map_options),
      std::move(sensor_options),
      echo_group(build.echoes, WaterOfNav::kYes),
      {"Input",
       {strict_option(recording.damage), topic_option(recording.bag), fields_option(recording.bag), config_option()}}};
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
        store_each(recording.logs)}},
      std::move(groups),
      {"pingvox map tank.csv -o tank.bt",
       "pingvox map dive1.csv dive2.csv -o reef.ot --poses dive.tum --mount 0.4,0,-0.2,180,0,0",
       "pingvox map dive.csv -o reef.ot --nav dive.tlog --nav-offset -1712333808.974",
       "pingvox map dive.db3 -o net.bt --nav dive.db3", "pingvox map logs -o harbour.ot --nav navigation",
       "pingvox map scans.graph -o scans.bt --resolution 0.1",
       "pingvox map multibeam.ply -o bottom.ot --origin 0,0,-0.5", "pingvox map - -o - < tank.csv > tank.bt"},
      "Point scans and clouds have no beam: only the options of the map (except --vote), --ray, --max-range and, for\n"
      "clouds, --origin apply; for scans in ROS bags also --topic, --mount, and the options of poses.\n"
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    const bool is_campaign = std::ranges::any_of(build.navs, is_folder_of_logs);
    const Result<Format> output_as = map_output_format(output, asked_format, is_campaign);
    if (!output_as) return tl::unexpected(output_as.error());
    command.format = *output_as;
    command.limited = parsed.limited;
    if (const auto valid = build.apply_to(recording, command.occupancy, command.map, command.build); !valid) {
      return tl::unexpected(valid.error());
    }
    if (command.map.depth != Lattice::kDefaultDepth && (*output_as == Format::kBt || *output_as == Format::kOt)) {
      return usage_error(fmt::format("{}: .{} holds maps of {} levels, not of {}: use .pvx", output,
                                     name_of(*output_as), Lattice::kDefaultDepth, command.map.depth));
    }
    if (output == "-" && command.output_options.report == Report::kJson) {
      return usage_error("-o - and --json: both write to standard output");
    }
    CommandFiles files;
    files.read("LOG", command.recording.logs);
    files.read("--config", parsed.config);
    files.read("--fields", command.recording.bag.file);
    build.name_files(files);
    files.write("-o", output);
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    if (is_campaign) {
      Result<CampaignArgs> campaign = campaign_args(output, command, parsed);
      if (!campaign) return tl::unexpected(campaign.error());
      command.campaign = *std::move(campaign);
    }
    if (!is_campaign || command.campaign->has_sum) {
      if (const auto folder = check_folder_of(output); !folder) return tl::unexpected(folder.error());
    }
    command.output = output;
    command.made_by = command_text("map", args);
    return command;
  });
}

}  // namespace pingvox::app
