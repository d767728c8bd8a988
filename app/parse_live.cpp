#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "command_files.hpp"
#include "live_arguments.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "recording_report.hpp"
#include "shared_options.hpp"
#include "shell_words.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kTreeFormats = {Choice<Format>{"bt", Format::kBt}, Choice<Format>{"ot", Format::kOt},
                                     Choice<Format>{"pvx", Format::kPvx}};

/// "192.168.2.1:8080", "192.168.2.1" or "[::1]:8080".
Take store_page_address(std::optional<PageAddress>& target) {
  return [&target](const std::string& text) -> Result<void> {
    PageAddress address{text, 0};
    const std::size_t colon = text.rfind(':');
    const bool is_bare = colon == std::string::npos || text.find(']', colon) != std::string::npos;
    if (!is_bare) {
      const Result<int> port = number_from<int>(text.substr(colon + 1));
      constexpr int kHighestPort = 65535;
      if (!port || *port < 1 || *port > kHighestPort) {
        return usage_error(fmt::format("'{}': the port must be 1 to {}", text, kHighestPort));
      }
      address = {text.substr(0, colon), *port};
    }
    if (address.address.starts_with('[') && address.address.ends_with(']')) {
      address.address = address.address.substr(1, address.address.size() - 2);
    }
    if (address.address.empty()) return usage_error(fmt::format("'{}': names no address", text));
    target = std::move(address);
    return {};
  };
}

/// A pipe or a terminal without a reader would hold the run up, and no map can be renamed into its place. /dev/null is
/// for those who want none.
Result<void> check_is_file(const std::string& path) {
  std::error_code error;
  if (path == "/dev/null" || !std::filesystem::is_other(std::filesystem::status(path, error))) return {};
  return usage_error(
      fmt::format("-o {}: is a pipe or a device: the map is rewritten during the run: name a file", path));
}

/// What is typed, where it is not in the command as such.
struct LiveFiles {
  std::optional<Format> asked_format;
  std::string output, poses;
  std::optional<PageAddress> view;
};

Result<void> check_map_output(const LiveCommand& command) {
  if (command.output == "-") return usage_error("-o -: the map is rewritten during the run: name a file");
  const int depth = command.live.map.depth;
  if (depth != Lattice::kDefaultDepth && command.format != Format::kPvx) {
    return usage_error(fmt::format("{}: .{} holds maps of {} levels, not of {}: use .pvx", command.output,
                                   name_of(command.format), Lattice::kDefaultDepth, depth));
  }
  for (const std::string_view suffix : {".tlog", ".jsonl"}) {
    if (command.live.record && !command.live.nav.empty() && command.output.ends_with(suffix)) {
      return usage_error(fmt::format("-o: {} is for the recording of --nav: give the map another suffix", suffix));
    }
  }
  return {};
}

Result<Command> finish_live(LiveCommand command, const LiveArgs& typed, const LiveFiles& named, const Parsed& parsed,
                            const Args& args) {
  if (const auto used = check_limited(parsed.limited, typed.live.head.kind); !used) return tl::unexpected(used.error());
  const Result<Format> output_as = output_format(named.output, named.asked_format, kTreeFormats);
  if (!output_as) return tl::unexpected(output_as.error());
  command.format = *output_as;
  command.output = named.output;
  Result<LiveOptions> options = typed.options();
  if (!options) return tl::unexpected(options.error());
  command.live = *std::move(options);
  if (const auto ranges = check_ranges(command.live.build); !ranges) return tl::unexpected(ranges.error());
  if (const auto valid = check_map_output(command); !valid) return tl::unexpected(valid.error());
  if (!named.poses.empty()) {
    if (const auto valid = check_trajectory_output(named.poses); !valid) return tl::unexpected(valid.error());
    command.poses = named.poses;
  }
  command.view = named.view;
  if (named.view) command.live.changes = KeepChanges::kYes;
  CommandFiles files;
  if (command.live.head.kind == LiveHead::Kind::kReplay) files.read("DEVICE", command.live.head.address);
  files.read("--map", typed.known_map);
  files.read("--config", parsed.config);
  files.write("-o", named.output);
  files.write("--record", typed.record);
  files.write("--poses-out", named.poses);
  if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
  if (const auto folder = check_folder_of(named.output); !folder) return tl::unexpected(folder.error());
  if (!named.poses.empty()) {
    if (const auto folder = check_folder_of(named.poses); !folder) return tl::unexpected(folder.error());
  }
  if (const auto file = check_is_file(named.output); !file) return tl::unexpected(file.error());
  command.made_by = command_text("live", args);
  return command;
}

}  // namespace

Result<Command> live_command(const Args& args) {
  LiveCommand command;
  LiveArgs typed;
  LiveFiles named;
  Option view{"--view",
              0,
              "ADDRESS:PORT",
              "show map, path, sonar and status on a page in a browser during the run; its address is printed, with a "
              "token for the controls of head, recording and map. --view=ADDRESS:PORT listens at an address of this "
              "machine (0.0.0.0: all) instead of the loopback address; without :PORT at a free port",
              "none",
              store_page_address(named.view)};
  view.implied = "127.0.0.1";
  Option blueos = blueos_option(command.readers);
  blueos.only_with = {{"--view"}};
  OptionTable table{
      "live",
      "Maps with a scanning sonar while it runs: drives the head, records its bytes, and writes the map periodically.\n"
      "SIGINT (Ctrl-C), SIGTERM or a closed terminal (SIGHUP) finish the recording and the map; another SIGINT or\n"
      "SIGTERM, at least a second later, ends at once.",
      {{"DEVICE", Positional::Count::kOne,
        "ping360:udp://HOST:PORT, ping360:/dev/ttyUSB0[@BAUD], micron:/dev/ttyUSB0[@BAUD], micron:tcp://HOST:PORT or "
        "micron:udp://HOST:PORT (a SeaNet head: Micron, MiniKing); of a Ping360 that another program drives "
        "pingviewer2:HOST[:PORT][/DEVICE], the server of Ping Viewer 2, or ping360-listen:udp://HOST:PORT, the bridge "
        "of BlueOS; ros2:/TOPIC, beams that a node of ROS 2 publishes; or replay:FILE[@SPEED], a log at the pace of "
        "its times (SPEED max: as fast as possible)",
        store_head(typed.live.head)}},
      {{"Output",
        {output_option(named.output, "the map: .bt or .ot (OctoMap), .pvx (any depth)"),
         choice("--format", kTreeFormats, "format of the map where its name has none of these suffixes",
                named.asked_format, "by suffix, bt on standard output"),
         record_option(typed.record),
         {"--write-every", 0, "S", "seconds from one written map to the next", number_text(command.write_every_s),
          within({0.1, 86'400.0}, store_number(command.write_every_s))},
         {"--beams", 0, "N", "stop after N beams", "never", store_number(command.max_beams)},
         flag("--json", "print one JSON object a second and one at the end, each on a line",
              command.output_options.report, Report::kJson),
         quiet_option(command.output_options),
         choice("--progress", kProgress, "show the status on standard error; auto: on a terminal",
                command.output_options.progress),
         std::move(view),
         std::move(blueos)}}},
      {"pingvox live ping360:udp://192.168.2.2:9092 -o dive.ot --record dive.bin --range 20",
       "pingvox live pingviewer2:192.168.2.2 -o dive.ot --record recordings",
       "pingvox live ping360:/dev/ttyUSB0 -o dive.bt --sector -60,60 --record recordings",
       "pingvox live ping360:udp://192.168.2.2:9092 --nav mavlink:udp://:14550 -o dive.ot --record recordings",
       "pingvox live ping360:udp://192.168.2.2:9092 --nav a50:tcp://192.168.2.95 -o dive.ot --record recordings",
       "pingvox live ping360:udp://192.168.2.2:9092 --nav a50:tcp://192.168.2.95 --slam -o dive.ot --record recordings",
       "pingvox live ping360:udp://192.168.2.2:9092 --nav a50:tcp://192.168.2.95 --slam --map harbour.ot -o new.ot",
       "pingvox live ping360:udp://192.168.2.2:9092 -o dive.ot --record recordings --view",
       "pingvox live ping360:udp://192.168.2.2:9092 -o dive.ot --record recordings --publish ros2",
       "pingvox live micron:/dev/ttyUSB0 -o dive.ot --record recordings --range 20 --step 1.8",
       "pingvox live ros2:/scan_echo --nav ros2:/odom -o dive.ot --publish ros2",
       "pingvox live replay:dive.bin@10 -o dive.bt"},
      "Without --nav and --slam the vehicle is assumed not to move; then the map of a recording, by 'pingvox map'\n"
      "with the same options, is the same.\n"
      "Exit status: 0 done, 1 failed, also of the recording alone, 2 invalid usage."};
  std::vector<OptionTable::Group> groups = live_groups(typed);
  const auto slam = std::ranges::find(groups, "SLAM", &OptionTable::Group::title);
  slam->options.push_back(only_with(
      {{"--slam"}},
      {"--poses-out", 0, "FILE",
       "write the path of the map at the end, as TUM lines 't x y z qx qy qz qw' at the times of the recording", "none",
       store(named.poses)}));
  std::ranges::move(groups, std::back_inserter(table.groups));
  table.groups.push_back({"Input", {config_option()}});
  return parse_command(table, args,
                       [&](const Parsed& parsed) { return finish_live(command, typed, named, parsed, args); });
}

}  // namespace pingvox::app
