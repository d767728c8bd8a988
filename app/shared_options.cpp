#include "shared_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/suggest.hpp"
#include "input_kinds.hpp"
#include "option_values.hpp"
#include "pingvox/io/bag_fields.hpp"
#include "pingvox/io/file.hpp"

namespace pingvox::app {
namespace {

tl::unexpected<Error> in_command(const OptionTable& table, const Error& error) {
  // Messages of the library may already begin with this word.
  const bool is_named = error.message.starts_with(table.command + ":");
  if (error.code != Error::Code::kBadOption || is_named) return tl::unexpected(error);
  return tl::unexpected(Error{error.code, fmt::format("{}: {}", table.command, error.message)});
}

/// The fields of beams as "angle=heading,range=...", or the name of a TOML file with those of beams and navigation.
Take store_fields(BagArgs& bag) {
  return [&bag](const std::string& text) -> Result<void> {
    if (text.find('=') != std::string::npos) {
      Result<BeamFields> fields = beam_fields_from(text);
      if (!fields) return tl::unexpected(fields.error());
      bag.beams.fields = *std::move(fields);
      return {};
    }
    bag.file = text;
    const Result<FileBytes> file = read_file(text);
    if (!file) return tl::unexpected(file.error());
    Result<BagFields> fields = read_bag_fields(*file);
    if (!fields) return tl::unexpected(fields.error());
    bag.nav = std::move(fields->nav);
    if (!fields->beams) return {};
    if (!bag.beams.name.empty() && bag.beams.name != fields->beams->name) {
      return usage_error(fmt::format("{}: its [[beams]] are of {}, not of --topic {}", file->name,
                                     on_one_line(fields->beams->name), bag.beams.name));
    }
    bag.beams = *std::move(fields->beams);
    return {};
  };
}

}  // namespace

Option output_option(std::string& target, std::string help) {
  Option output{"--output", 'o', "FILE", std::move(help), "", store(target)};
  output.is_required = true;
  return output;
}

Option config_option() {
  // The file is read by parse().
  return {"--config", 0,
          "FILE",     "read options from a TOML file, named as here without the dashes; the command line wins",
          "",         [](const std::string&) -> Result<void> { return {}; }};
}

Option strict_option(Damage& damage) {
  Option option = flag("--strict", "stop at the first damaged record instead of skipping it", damage, Damage::kFail);
  option.only_for = {std::string(kBeamLogs), std::string(kPointLogs), std::string(kClouds), std::string(kNavLogs)};
  return option;
}

Option topic_option(BagArgs& bag) {
  Option option{"--topic",
                0,
                "NAME",
                "topic of a ROS bag to read beams (or scans) from",
                "the only one with beams",
                store(bag.beams.name)};
  option.only_for = {std::string(kBeamLogs), std::string(kBagScans)};
  return option;
}

Option fields_option(BagArgs& bag) {
  Option option{
      "--fields",
      0,
      "FILE|KEY=VALUE,...",
      "fields of messages of unknown drivers in ROS bags: a TOML file for beams and navigation (docs/formats.md), or "
      "those that make a message of --topic a beam: angle, range (of the beam, in m) or bin (length of a bin, in m), "
      "intensities; of the angle also unit=rad|deg|grad, turn=ccw|cw and ahead=N",
      "by the type of the message; unit=rad,turn=ccw,ahead=0",
      store_fields(bag)};
  option.only_for = {std::string(kBeamLogs), std::string(kBagScans)};
  return option;
}

Option json_option(OutputOptions& output_options) {
  return flag("--json", "print the report as one JSON object", output_options.report, Report::kJson);
}

Option blueos_option(web::Readers& readers) {
  const Take take = [&readers](const std::string&) -> Result<void> {
    readers = web::Readers::kLocalNetwork;
    return {};
  };
  return {"--blueos",
          0,
          "",
          "serve as an extension of BlueOS: without a token, to private addresses and names of local networks; other "
          "pages may frame it, and BlueOS and Cockpit get its metadata",
          "",
          take};
}

Option quiet_option(OutputOptions& output_options) {
  return flag("--quiet", "print nothing but errors", output_options.talk, Talk::kQuiet);
}

Result<Format> output_format(const std::string& path, const std::optional<Format>& asked,
                             std::span<const Choice<Format>> known) {
  if (path.empty()) return usage_error("-o FILE is missing");
  const std::optional<Format> by_suffix = format_for_writing(path);
  if (asked && by_suffix && *asked != *by_suffix) {
    return usage_error(fmt::format("--format {}: contradicts the suffix of {}", name_of(*asked), path));
  }
  if (asked) return *asked;
  for (const auto& word : known) {
    if (word.value == by_suffix) return word.value;
  }
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  const bool is_nameless = path == "-" || (std::filesystem::exists(status) && std::filesystem::is_other(status));
  if (is_nameless && !by_suffix) return known.front().value;

  Args suffixes;
  for (const auto& word : known) suffixes.push_back(fmt::format(".{}", word.word));
  if (path.ends_with('/') || std::filesystem::is_directory(status)) {
    return usage_error(
        fmt::format("{}: is a folder, not a file: name one in it that ends in {}", path, fmt::join(suffixes, " or ")));
  }
  const std::string ending = std::filesystem::path(path).extension().string();
  return usage_error(
      fmt::format("{}: its suffix must be {}{}", path, fmt::join(suffixes, " or "), did_you_mean(ending, suffixes)));
}

Result<void> check_trajectory_output(const std::string& path) {
  const std::optional<Format> by_suffix = format_for_writing(path);
  if (!by_suffix || *by_suffix == Format::kTum) return {};
  return usage_error(fmt::format("{}: a trajectory is written as .tum", path));
}

Result<Command> parse_command(const OptionTable& table, const Args& args,
                              const std::function<Result<Command>(const Parsed&)>& make) {
  const Result<Parsed> result = parse(table, args);
  if (!result) return tl::unexpected(result.error());
  if (result->is_help_wanted) return ShowText{{}, help_of(table)};
  Result<Command> command = make(*result);
  if (!command) return in_command(table, command.error());
  return command;
}

}  // namespace pingvox::app
