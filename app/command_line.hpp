#pragma once

#include <string>
#include <vector>

#include "commands.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// Parses the arguments (without the program's name) into a command. Reads no file but that of --config.
/// @return kBadOption for invalid usage, with the nearest valid word; kIo when a --config file cannot be read
Result<Command> parse_command_line(const std::vector<std::string>& args);

}  // namespace pingvox::app
