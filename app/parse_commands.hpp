#pragma once

#include <string>
#include <vector>

#include "commands.hpp"
#include "pingvox/result.hpp"

/// Each makes a command of the words behind its name, or its help; errors as those of parse_command_line.
namespace pingvox::app {

Result<Command> map_command(const std::vector<std::string>& words);
Result<Command> info_command(const std::vector<std::string>& words);
Result<Command> compare_command(const std::vector<std::string>& words);
Result<Command> convert_command(const std::vector<std::string>& words);
Result<Command> render_command(const std::vector<std::string>& words);
Result<Command> simulate_command(const std::vector<std::string>& words);

}  // namespace pingvox::app
