#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "commands.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "pingvox/result.hpp"

/// Options that several commands have, and checks of a call that cost no work.
namespace pingvox::app {

Option output_option(std::string& target, std::string help);
Option config_option();
Option strict_option(Damage& damage);
Option json_option(OutputOptions& output_options);
Option quiet_option(OutputOptions& output_options);

/// The format of an output file: as asked for, else by its suffix. Standard output, devices and pipes have no suffix:
/// the first one of `known`. kBadOption when the two contradict each other.
Result<Format> output_format(const std::string& path, const std::optional<Format>& asked,
                             std::span<const Choice<Format>> known);

/// What would fail for sure after the work is better said before it.
Result<void> check_folder_of(const std::string& path);

Result<void> check_standard_input(const Args& files);

/// Parses the arguments of a command: its help if asked for, else what `make` returns. Its errors get the command's
/// name in front.
Result<Command> parse_command(const OptionTable& table, const Args& args,
                              const std::function<Result<Command>(const Parsed&)>& make);

}  // namespace pingvox::app
