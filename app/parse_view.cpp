#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command_files.hpp"
#include "echo_options.hpp"
#include "input_kinds.hpp"
#include "mapping_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"

namespace pingvox::app {
namespace {

/// The option without a value that stops the browser.
Option no_open_option(OpenBrowser& browser) {
  const Take take = [&browser](const std::string&) -> Result<void> {
    browser = OpenBrowser::kNo;
    return {};
  };
  return {"--no-open", 0, "", "print the address of the page without opening a browser", "", take};
}

/// The option without a value that asks how well cells agree.
Option agreement_option(CountCells& agreement) {
  const Take take = [&agreement](const std::string&) -> Result<void> {
    agreement = CountCells::kYes;
    return {};
  };
  return {"--agreement",
          0,
          "",
          "compare the echoes with maps made without them, and colour cells by the share that agrees; takes several "
          "times as long",
          "",
          take};
}

/// Standard output and devices have no suffix.
bool is_name_of_page(const std::string& path) {
  return path == "-" || path.starts_with("/dev/") || path.ends_with(".html") || path.ends_with(".htm");
}

}  // namespace

Result<Command> view_command(const Args& args) {
  ViewCommand command;
  RecordingArgs& recording = command.recording;
  BuildArgs build;
  std::optional<int> port;
  std::optional<std::string> listen;
  OptionTable::Group map_options = map_group(build);
  for (Option& option : tree_options(build)) map_options.options.push_back(std::move(option));
  map_options.options.push_back(agreement_option(command.agreement));
  const std::string resolution = "--resolution";
  for (Option& option : map_options.options) {
    if (option.only_for.empty()) option.only_for = {std::string(kMadeMaps)};
    if (option.name == resolution) option.only_for.emplace_back(kMeshes);
  }
  for (Option& option : occupancy_options(command.occupancy)) map_options.options.push_back(std::move(option));
  const OptionTable table{
      "view",
      "Shows maps, paths and logs on a page in a browser: the map in space, the picture of the sonar, and a time "
      "line.\n"
      "A log is mapped first, as by 'pingvox map', unless a map is among the FILEs.",
      {{"FILE", Positional::Count::kMany,
        "logs, maps, meshes, clouds, trajectories (TUM lines) and navigation logs, recognised by content; - is "
        "standard "
        "input",
        store_each(command.files)}},
      {{"Page",
        {{"--export", 0, "FILE", "write the page with all its data to one file (.html) instead of serving it", "none",
          store(command.export_to)},
         {"--port", 0, "N", "port of the page", "a free one", within({1.0, 65535.0}, store_optional(port))},
         no_open_option(command.browser),
         {"--listen", 0, "ADDRESS",
          "listen at this address of the machine instead of the loopback address, 0.0.0.0: at all; the printed address "
          "then has a token, which requests need",
          command.address, store(listen)},
         blueos_option(command.readers),
         quiet_option(command.output_options)}},
       std::move(map_options),
       sensor_group(build),
       echo_group(build.echoes, WaterOfNav::kYes),
       {"Input",
        {strict_option(recording.damage), topic_option(recording.bag), fields_option(recording.bag), config_option()}}},
      {"pingvox view dive.bin --nav dive.tlog", "pingvox view map.bt slam.tum",
       "pingvox view dive.bin slam.tum --export page.html", "pingvox view map.bt --listen 192.168.2.1 --port 8080"},
      "A trajectory among the FILEs is the path of the logs, unless --poses or --nav is given.\n"
      "The first line of standard output is the address of the page. Ctrl-C ends the program.\n"
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    const bool is_served =
        port || listen || command.browser == OpenBrowser::kNo || command.readers != web::Readers::kWithToken;
    if (command.export_to && is_served) {
      return usage_error("--export: nothing is served, so --port, --no-open, --listen and --blueos have no effect");
    }
    if (command.export_to && !is_name_of_page(*command.export_to)) {
      return usage_error(fmt::format("--export: {}: the name of a page ends with .html", *command.export_to));
    }
    command.limited = parsed.limited;
    command.port = port.value_or(command.port);
    command.address = listen.value_or(command.address);
    if (const auto valid = command.occupancy.validate(); !valid) return tl::unexpected(valid.error());
    command.map = build.map;
    command.map.thresholds = command.occupancy.apply_to(command.map.thresholds);
    if (const auto valid = build.apply_to(command.recording, command.map, command.build); !valid) {
      return tl::unexpected(valid.error());
    }
    CommandFiles files;
    files.read("FILE", command.files);
    files.read("--config", parsed.config);
    files.read("--fields", command.recording.bag.file);
    build.name_files(files);
    if (command.export_to) files.write("--export", *command.export_to);
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    if (command.export_to) {
      if (const auto folder = check_folder_of(*command.export_to); !folder) return tl::unexpected(folder.error());
    }
    return command;
  });
}

}  // namespace pingvox::app
