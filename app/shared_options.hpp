#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "commands.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "pingvox/result.hpp"

/// Options shared by commands.
namespace pingvox::app {

inline constexpr std::array kProgress = {Choice<ShowProgress>{"auto", ShowProgress::kAuto},
                                         Choice<ShowProgress>{"always", ShowProgress::kAlways},
                                         Choice<ShowProgress>{"never", ShowProgress::kNever}};
/// Of maps and of their occupied cells.
inline constexpr std::array kMapFormats = {Choice<Format>{"bt", Format::kBt},   Choice<Format>{"ot", Format::kOt},
                                           Choice<Format>{"pvx", Format::kPvx}, Choice<Format>{"ply", Format::kPly},
                                           Choice<Format>{"pcd", Format::kPcd}, Choice<Format>{"xyz", Format::kXyz}};

Option output_option(std::string& target, std::string help);
Option config_option();
Option strict_option(Damage& damage);
Option topic_option(BagArgs& bag);
Option fields_option(BagArgs& bag);
Option json_option(OutputOptions& output_options);
Option quiet_option(OutputOptions& output_options);
/// --blueos, of the commands that serve a page.
Option blueos_option(web::Readers& readers);

/// Format of an output file: as requested, else by suffix, else (standard output, devices, pipes) the first of `known`.
/// kBadOption when format and suffix contradict each other.
Result<Format> output_format(const std::string& path, const std::optional<Format>& asked,
                             std::span<const Choice<Format>> known);

/// Refuses the suffix of another format for a trajectory.
Result<void> check_trajectory_output(const std::string& path);

/// Parses the arguments of a command: returns its help if requested, else the result of `make`. Errors are prefixed
/// with the command's name.
Result<Command> parse_command(const OptionTable& table, const Args& args,
                              const std::function<Result<Command>(const Parsed&)>& make);

}  // namespace pingvox::app
