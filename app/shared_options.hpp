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
Option json_option(Manner& manner);
Option quiet_option(Manner& manner);

/// The format of an output file: as asked for, else by its suffix, which is one of the words. Standard output, devices
/// and pipes have no suffix: the first one of `known`.
Result<Format> output_format(const std::string& path, const std::optional<Format>& asked,
                             std::span<const Word<Format>> known);

/// What would fail for sure after the work is better said before it.
Result<void> check_folder_of(const std::string& path);

Result<void> check_standard_input(const Words& files);

/// What every command does with its table: the help where it is asked for, else what `done` makes when the words are
/// right. Its errors get the command's name in front.
Result<Command> parsed(const OptionTable& table, const Words& words, const std::function<Result<Command>()>& done);

}  // namespace pingvox::app
