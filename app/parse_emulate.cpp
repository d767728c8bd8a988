#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>

#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kEmulatedMotions = {Choice<Motion>{"still", Motion::kStill},
                                         Choice<Motion>{"loop", Motion::kLoop}};

}  // namespace

Result<Command> emulate_command(const Args& args) {
  using Device = EmulateCommand::Device;
  EmulateCommand command;
  HeadEmulatorOptions& head = command.head;
  constexpr std::array kDevices = {Choice<Device>{"ping360", Device::kPing360},
                                   Choice<Device>{"micron", Device::kMicron},
                                   Choice<Device>{"mavlink", Device::kMavlink}, Choice<Device>{"a50", Device::kA50}};
  std::string listen, send_to;
  double rate = 0.0;  // 0: as usual
  const Take device = [&](const std::string& text) -> Result<void> {
    const Result<Device> value = choice_value(kDevices, text);
    if (!value) return usage_error(fmt::format("no such device '{}': must be ping360, micron, mavlink or a50", text));
    command.device = *value;
    return {};
  };
  const Take world = [&](const std::string& text) -> Result<void> {
    constexpr std::array<std::string_view, 4> kWorlds = {"tank", "harbour", "seabed", "cave"};
    if (std::ranges::find(kWorlds, text) == kWorlds.end()) {
      return usage_error(fmt::format("must be {}, not '{}'", fmt::join(kWorlds, " or "), text));
    }
    command.world = text;
    return {};
  };
  OptionTable table{
      "emulate",
      "Answers like a device in a simulated world, to try 'pingvox live' without one: a sonar head (ping360 or\n"
      "micron), an autopilot that sends MAVLink (mavlink), or a DVL (a50). Prints the address to connect to.",
      {{"DEVICE", Positional::Count::kOne, "ping360, micron, mavlink or a50", device}},
      {{"Line",
        {{"--listen", 0, "ADDRESS",
          "of a head: udp://HOST:PORT (port 0: any free one), tcp://HOST:PORT, or pty for a new pseudo terminal; "
          "of a50: tcp://HOST:PORT",
          "udp://127.0.0.1:9092, micron: pty, a50: tcp://127.0.0.1:16171", store(listen)},
         {"--to", 0, "ADDRESS", "of mavlink: udp://HOST:PORT to send to", "udp://127.0.0.1:14550", store(send_to)},
         number("--lost", "F", "fraction of bytes (of a head) or messages that are lost", head, head.lost),
         number("--doubled", "F", "fraction of bytes or messages that are doubled", head, head.doubled),
         number("--damaged", "F", "fraction of bytes or messages with a wrong bit", head, head.damaged)}},
       {"Vehicle",
        {{"--world", 0, "tank|harbour|seabed|cave", "world around the head", command.world, world},
         choice("--trajectory", kEmulatedMotions, "path of the vehicle; emulators with the same options agree on it",
                command.motion),
         {"--speed", 0, "M/S", "speed of the vehicle", number_text(command.speed_m_s),
          within({0.01, 100.0}, store_number(command.speed_m_s))},
         {"--rate", 0, "HZ", "pings (of a head) or reports (of navigation) per second", "20 or 10",
          within({0.1, 100'000.0}, store_number(rate))},
         {"--pings", 0, "N", "end after N pings", "never", store_number(command.max_pings)},
         {"--stall-every", 0, "N", "be silent after each N pings, as a head that restarts", "never",
          store_number(head.stall_every)},
         number("--stall", "S", "length of this silence in seconds", head, head.stall_s),
         {"--no-bottom", 0, "S", "of a50: seconds at the end of each minute without a velocity, as over deep water",
          "0", within({0.0, 59.0}, store_number(command.no_bottom_s))},
         number("--lines", "1|2", "of micron: scan lines per request; 2 as full-duplex heads send them", head,
                head.lines_per_request),
         number("--seed", "N", "seed of the random numbers", head.seed)}}},
      {"pingvox emulate ping360 --listen udp://127.0.0.1:9092", "pingvox emulate ping360 --listen pty --lost 0.0001",
       "pingvox emulate micron", "pingvox emulate mavlink --trajectory loop", "pingvox emulate a50 --trajectory loop"},
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  const std::map<std::string_view, Condition> conditions = {
      {"--listen", {"DEVICE", {"ping360", "micron", "a50"}}},
      {"--to", {"DEVICE", {"mavlink"}}},
      {"--pings", {"DEVICE", {"ping360", "micron"}}},
      {"--stall-every", {"DEVICE", {"ping360", "micron"}}},
      {"--stall", {"--stall-every", {}}},
      {"--lines", {"DEVICE", {"micron"}}},
      {"--no-bottom", {"DEVICE", {"a50"}}},
      {"--speed", {"--trajectory", {"loop"}}},
  };
  for (OptionTable::Group& group : table.groups) {
    for (Option& option : group.options) {
      const auto condition = conditions.find(option.name);
      if (condition != conditions.end()) option.only_with = {condition->second};
    }
  }
  return parse_command(table, args, [&](const Parsed&) -> Result<Command> {
    const bool is_micron = command.device == Device::kMicron;
    const bool is_head = command.device == Device::kPing360 || is_micron, sends = command.device == Device::kMavlink;
    command.line = sends ? send_to : listen;
    if (command.line.empty()) {
      command.line = is_micron ? "pty"
                     : is_head ? "udp://127.0.0.1:9092"
                     : sends   ? "udp://127.0.0.1:14550"
                               : "tcp://127.0.0.1:16171";
    }
    const std::string_view scheme = sends ? "udp://" : "tcp://";
    if (!is_head && !command.line.starts_with(scheme)) {
      return usage_error(
          fmt::format("{}: '{}': must be {}HOST:PORT", sends ? "--to" : "--listen", command.line, scheme));
    }
    if (rate > 0.0) head.pings_per_s = command.nav.reports_per_s = rate;
    command.nav.lost = head.lost;
    command.nav.doubled = head.doubled;
    command.nav.damaged = head.damaged;
    command.nav.seed = head.seed;
    if (const auto valid = is_head ? head.validate() : command.nav.validate(); !valid) {
      return tl::unexpected(valid.error());
    }
    return command;
  });
}

}  // namespace pingvox::app
