#include "command_line.hpp"

#include <fmt/core.h>

#include <array>
#include <string_view>

#include "base/suggest.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"

namespace pingvox::app {
namespace {

Result<Command> bench_command(const Args& args) {
  return BenchCommand{{}, args};
}

struct CommandName {
  std::string_view name, purpose;
  Result<Command> (*parse)(const Args&);
};

constexpr std::array kCommands = {
    CommandName{"map", "build a map from logs", &map_command},
    CommandName{"info", "describe a file: a log, navigation, a cloud, a map or a mesh", &info_command},
    CommandName{"compare", "compare two maps cell by cell, or two trajectories", &compare_command},
    CommandName{"convert", "convert a log to CSV, a map to another format, a cloud or a grid, a mesh to a map",
                &convert_command},
    CommandName{"render", "draw a log with its echoes, or a map", &render_command},
    CommandName{"mosaic", "draw the sonar image on the ground, north up", &mosaic_command},
    CommandName{"view", "show maps, paths and logs in a browser", &view_command},
    CommandName{"simulate", "simulate the log of a sonar in a known world", &simulate_command},
    CommandName{"slam", "estimate the trajectory of the vehicle from beams and navigation, and map", &slam_command},
    CommandName{"locate", "find the vehicle in a known map", &locate_command},
    CommandName{"evaluate", "measure how well a map predicts echoes that were held out of it", &evaluate_command},
    CommandName{"merge", "add maps, also moved and of other cells", &merge_command},
    CommandName{"query", "look up points, rays, the nearest obstacle or a region in a map", &query_command},
    CommandName{"live", "record and map with a sonar while it runs", &live_command},
    CommandName{"emulate", "simulate a sonar or navigation device for 'live'", &emulate_command},
    CommandName{"bench", "measure speed and accuracy, where pingvox-bench is installed", &bench_command},
};

std::string overview() {
  std::string out = "Usage: pingvox COMMAND [ARGUMENT]...\nTurns sonar logs into 3D occupancy maps.\n\nCommands:\n";
  for (const CommandName& command : kCommands) {
    out += fmt::format("  {:<10}{}\n", command.name, command.purpose);
  }
  return out +
         "\n  -h, --help     show this help; after a command, the help of that command\n"
         "      --version  show the version\n"
         "\nExamples:\n"
         "  pingvox simulate tank -o tank.csv\n"
         "  pingvox map tank.csv -o tank.bt\n"
         "  pingvox render tank.bt -o tank.png\n"
         "\nExit status: 0 done, 1 failed, 2 invalid usage.\n"
         "compare: 0 equal, 1 different, 2 failed.\n";
}

}  // namespace

Result<Command> parse_command_line(const Args& args) {
  if (args.empty()) return usage_error("a command is missing (see 'pingvox --help')");
  const std::string& first = args.front();
  if (first == "--help" || first == "-h") return ShowText{{}, overview()};
  if (first == "--version") return ShowText{{}, "pingvox " PINGVOX_VERSION "\n"};

  Args rest(args.begin() + 1, args.end());
  if (first == "help") {
    if (rest.empty()) return ShowText{{}, overview()};
    return parse_command_line({rest.front(), "--help"});
  }
  Args known = {"--help", "--version"};
  for (const CommandName& command : kCommands) {
    if (command.name == first) return command.parse(rest);
    known.emplace_back(command.name);
  }
  const std::string kind = first.starts_with("-") ? "option" : "command";
  const std::string hint = did_you_mean(first, known);
  return usage_error(fmt::format("unknown {} '{}'{}", kind, first, hint.empty() ? " (see 'pingvox --help')" : hint));
}

}  // namespace pingvox::app
