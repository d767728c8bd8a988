#pragma once

#include <string>
#include <vector>

#include "commands.hpp"
#include "pingvox/result.hpp"

/// Each parses the arguments after its name into a command, or its help; errors as parse_command_line.
namespace pingvox::app {

Result<Command> map_command(const std::vector<std::string>& args);
Result<Command> info_command(const std::vector<std::string>& args);
Result<Command> compare_command(const std::vector<std::string>& args);
Result<Command> convert_command(const std::vector<std::string>& args);
Result<Command> render_command(const std::vector<std::string>& args);
Result<Command> mosaic_command(const std::vector<std::string>& args);
Result<Command> view_command(const std::vector<std::string>& args);
Result<Command> locate_command(const std::vector<std::string>& args);
Result<Command> evaluate_command(const std::vector<std::string>& args);
Result<Command> slam_command(const std::vector<std::string>& args);
Result<Command> merge_command(const std::vector<std::string>& args);
Result<Command> query_command(const std::vector<std::string>& args);
Result<Command> live_command(const std::vector<std::string>& args);
Result<Command> emulate_command(const std::vector<std::string>& args);
Result<Command> simulate_command(const std::vector<std::string>& args);

}  // namespace pingvox::app
