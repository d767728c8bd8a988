#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>

#include "mapping_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"
#include "shell_words.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kParents = {Word<Parents>{"max", Parents::kMax}, Word<Parents>{"mean", Parents::kMean}};
constexpr std::array kProgress = {Word<ShowProgress>{"auto", ShowProgress::kAuto},
                                  Word<ShowProgress>{"always", ShowProgress::kAlways},
                                  Word<ShowProgress>{"never", ShowProgress::kNever}};
constexpr std::array kMapFormats = {Word<Format>{"bt", Format::kBt}, Word<Format>{"ot", Format::kOt},
                                    Word<Format>{"pvx", Format::kPvx}, Word<Format>{"ply", Format::kPly},
                                    Word<Format>{"pcd", Format::kPcd}};

}  // namespace

Result<Command> map_command(const Words& words) {
  MapCommand command;
  std::string output;
  std::optional<Format> asked_format;
  BuildWords build;
  MapOptions& map = build.map;
  const Take thread_count = [&](const std::string& text) -> Result<void> {
    int threads = 0;
    if (auto taken = into_number(threads)(text); !taken) return taken;
    if (threads < 1 || threads > 256) return off(fmt::format("{} is not in 1..256", text));
    build.build.threads = static_cast<std::size_t>(threads);
    return {};
  };
  const Take origin = [&](const std::string& text) -> Result<void> {
    const auto n = numbers_from<3>(text);
    if (!n) return tl::unexpected(n.error());
    const Eigen::Vector3d place(n->data());
    if (!place.allFinite()) return off(fmt::format("'{}': must be finite", text));
    command.cloud_origin_m = place;
    return {};
  };
  const Take log = [&](const std::string& text) -> Result<void> {
    command.logs.push_back(text);
    return {};
  };
  const Take format = [&](const std::string& text) -> Result<void> {
    const Result<Format> value = value_of(kMapFormats, text);
    if (!value) return tl::unexpected(value.error());
    asked_format = *value;
    return {};
  };

  OptionTable::Group map_options = map_group(build);
  map_options.options.push_back(
      choice("--parents", kParents, "value of a parent: maximum or mean of its children", map.parents));
  map_options.options.push_back({"--threads", 0, "N",
                                 "threads that trace a sweep or scan together, 1..256; the map is the same", "1",
                                 thread_count});
  OptionTable::Group sensor_options = sensor_group(build);
  sensor_options.options.push_back({"--origin", 0, "X,Y,Z", "from where the points of a cloud were seen, in the map",
                                    "0,0,0; a PCD's VIEWPOINT", origin});
  const OptionTable table{
      "map",
      "Turns sonar logs into a 3D occupancy map: reads the LOGs one after another, finds the echoes of each beam, and\n"
      "frees and hits the cells that its sound went through and came back from.",
      {{"LOG", Positional::Count::kMany,
        "beams (Ping Viewer's .bin, SeaNet, MATLAB 5, CSV), point scans (OctoMap's .graph and its text form) or clouds "
        "of points, each a scan "
        "(PLY, "
        "PCD, XYZ), told by content; - is standard input",
        log}},
      {{"Output",
        {output_option(output,
                       "the map: .bt or .ot (OctoMap), .pvx (any depth), .ply or .pcd (points); - is standard output"),
         {"--format", 0, words_of(kMapFormats), "format of the map, whatever its name", "by suffix, else bt", format},
         json_option(command.manner),
         quiet_option(command.manner),
         choice("--progress", kProgress, "show on standard error how far the work is; auto: on a terminal",
                command.manner.progress)}},
       map_options,
       sensor_options,
       echo_group(build.echoes, build.build.sound_speed_ratio),
       {"Input", {strict_option(command.damage), config_option()}}},
      {"pingvox map tank.mat -o tank.bt --beam cone",
       "pingvox map dive1.csv dive2.csv -o reef.ot --poses nav.txt --mount 0.4,0,-0.2,180,0,0",
       "pingvox map scans.graph -o scans.bt --resolution 0.1 --vote sweep",
       "pingvox map multibeam.ply -o bottom.ot --origin 0,0,-0.5", "pingvox map - -o - < tank.csv > tank.bt"},
      "Point scans and clouds use the options of the map, --ray and --max-range.\n"
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  return parsed(table, words, [&]() -> Result<Command> {
    const Result<Format> output_as = output_format(output, asked_format, kMapFormats);
    if (!output_as) return tl::unexpected(output_as.error());
    command.format = *output_as;
    command.map = map;
    command.build = build.build_options();
    command.head = build.head;
    if (const auto valid = command.map.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = check_options(command.build); !valid) return tl::unexpected(valid.error());
    if (map.depth != Lattice::kDefaultDepth && (*output_as == Format::kBt || *output_as == Format::kOt)) {
      return off(fmt::format("{}: .{} holds maps of {} levels, not of {}: use .pvx", output, name_of(*output_as),
                             Lattice::kDefaultDepth, map.depth));
    }
    if (output == "-" && command.manner.report == Report::kJson) {
      return off("-o - and --json: both want standard output");
    }
    if (!build.poses.empty()) command.poses = build.poses;
    Words inputs = command.logs;
    inputs.push_back(build.poses);
    if (const auto once = check_standard_input(inputs); !once) return tl::unexpected(once.error());
    if (const auto folder = check_folder_of(output); !folder) return tl::unexpected(folder.error());
    command.output = output;
    command.made_by = "pingvox " PINGVOX_VERSION " map";
    for (const std::string& word : words) {
      command.made_by += ' ';
      command.made_by += shell_quoted(word);
    }
    return command;
  });
}

}  // namespace pingvox::app
