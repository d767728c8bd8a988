#pragma once

#include <string>
#include <vector>

#include "commands.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// Makes a command of the args of a call (without the program's name). Nothing is read but a file of --config, and
/// nothing of the work is begun, so that wrong args cost no time.
/// @return kBadOption when the args are off, with the nearest right one; kIo when a --config file cannot be read
Result<Command> parse_command_line(const std::vector<std::string>& args);

}  // namespace pingvox::app
