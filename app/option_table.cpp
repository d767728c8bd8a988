#include "option_table.hpp"

#include <fmt/format.h>

// Included only here, as it takes five seconds to compile.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <sstream>
#include <utility>

#include "pingvox/io/file.hpp"
#include "suggest.hpp"

namespace pingvox::app {
namespace {

constexpr std::string_view kConfig = "--config";

tl::unexpected<Error> parse_error(const OptionTable& table, const std::string& what) {
  return fail(Error::Code::kBadOption, fmt::format("{}: {}", table.command, what));
}

std::vector<std::string> option_names(const OptionTable& table) {
  std::vector<std::string> names = {"--help"};
  for (const auto& group : table.groups) {
    for (const Option& option : group.options) names.push_back(option.name);
  }
  return names;
}

const Option* find_option(const OptionTable& table, std::string_view name) {
  for (const auto& group : table.groups) {
    for (const Option& option : group.options) {
      if (option.name == name) return &option;
    }
  }
  return nullptr;
}

/// " of metres", for an option whose value is shown as M in the help.
std::string_view unit_of(std::string_view value_name) {
  const std::string_view unit = value_name.substr(0, value_name.find('|'));
  if (unit == "M") return " of metres";
  if (unit == "DEG") return " of degrees";
  if (unit == "M/S") return " of metres per second";
  return "";
}

/// @param value_name  of the option in the help
Result<void> give(const OptionTable& table, const std::string& where, const Take& take, const std::string& text,
                  std::string_view value_name) {
  const Result<void> taken = take(text);
  if (taken) return {};
  std::string message = taken.error().message;
  if (message.ends_with("number")) message += unit_of(value_name);
  if (message.find(" is not a ") != std::string::npos && value_name.ends_with("|auto")) message += " or 'auto'";
  return fail(taken.error().code, fmt::format("{}: {}: {}", table.command, where, message));
}

/// Arguments of one option or position.
struct Found {
  const Option* option = nullptr;
  const Positional* positional = nullptr;
  CLI::Option* parsed = nullptr;
  std::optional<std::string> configured = std::nullopt;  ///< its value in the configuration file
};

/// Reads a configuration file and gives its values to the options that the command line does not have.
Result<void> apply_config(const OptionTable& table, const std::string& path, std::vector<Found>& found) {
  const Result<FileBytes> file = read_file(path);
  if (!file) return tl::unexpected(file.error());
  std::istringstream text(std::string(file->bytes.begin(), file->bytes.end()));
  std::vector<CLI::ConfigItem> items;
  try {
    items = CLI::ConfigTOML().from_config(text);
  } catch (const CLI::Error& error) {
    return parse_error(table, fmt::format("{}: {}", path, error.what()));
  }
  for (const CLI::ConfigItem& item : items) {
    if (!item.parents.empty() || item.name == "++" || item.name == "--") {
      return parse_error(table,
                         fmt::format("{}: has a section: options stand at the top, as in 'resolution = 0.1'", path));
    }
    std::string name = "--" + item.name;
    std::replace(name.begin(), name.end(), '_', '-');
    const Option* option = name == kConfig ? nullptr : find_option(table, name);
    if (!option) {
      return parse_error(
          table, fmt::format("{}: unknown option '{}'{}", path, item.name, did_you_mean(name, option_names(table))));
    }
    Found& entry =
        *std::find_if(found.begin(), found.end(), [&](const Found& other) { return other.option == option; });
    if (entry.parsed->count() > 0) continue;
    if (option->repeats == Repeats::kEachCounts) {
      for (const std::string& input : item.inputs) {
        const Result<void> given =
            give(table, fmt::format("{}: {}", path, item.name), option->take, input, option->value);
        if (!given) return given;
      }
      continue;
    }
    const std::string value = fmt::format("{}", fmt::join(item.inputs, ","));
    if (option->value.empty()) {
      if (value == "false") continue;
      if (value != "true") return parse_error(table, fmt::format("{}: {}: must be true or false", path, item.name));
    }
    entry.configured = value;
    const std::string where = fmt::format("{}: {}", path, item.name);
    if (const Result<void> given = give(table, where, option->take, value, option->value); !given) return given;
  }
  return {};
}

/// The value of an option or a positional argument, given or by default; nullopt when there is none.
std::optional<std::string> value_of(const std::string& name, const std::vector<Found>& found) {
  for (const Found& entry : found) {
    if ((entry.option ? entry.option->name : entry.positional->name) != name) continue;
    if (entry.parsed->count() > 0) return entry.parsed->results().back();
    if (entry.configured) return entry.configured;
    if (entry.option && !entry.option->standard.empty()) return entry.option->standard;
  }
  return std::nullopt;
}

bool is_met(const Condition& condition, const std::vector<Found>& found) {
  if (condition.values.empty()) {
    return std::any_of(found.begin(), found.end(), [&](const Found& entry) {
      return entry.option && entry.option->name == condition.name && (entry.parsed->count() > 0 || entry.configured);
    });
  }
  const auto value = value_of(condition.name, found);
  return value && std::find(condition.values.begin(), condition.values.end(), *value) != condition.values.end();
}

std::string text_of(const Condition& condition) {
  const std::string values = fmt::format("{}", fmt::join(condition.values, " or "));
  return condition.name + (values.empty() ? "" : " ") + values;
}

/// Refuses an option without effect.
Result<void> check_conditions(const OptionTable& table, const Option& option, const std::vector<Found>& found) {
  const auto met = [&](const Condition& condition) { return is_met(condition, found); };
  if (option.only_with.empty() || std::any_of(option.only_with.begin(), option.only_with.end(), met)) return {};
  std::vector<std::string> needed;
  for (const Condition& condition : option.only_with) needed.push_back(text_of(condition));
  const Condition& first = option.only_with.front();
  const auto value = first.values.empty() ? std::nullopt : value_of(first.name, found);
  const std::string any = fmt::format("{}", fmt::join(needed, " or "));
  return parse_error(table, fmt::format("{}: has no effect {}", option.name,
                                        value ? fmt::format("with {} {}, only with {}", first.name, *value, any)
                                              : fmt::format("without {}", any)));
}

std::string label_of(const Option& option) {
  std::string label = option.letter != 0 ? fmt::format("-{}, {}", option.letter, option.name) : "    " + option.name;
  if (!option.value.empty()) label += option.implied.empty() ? " " + option.value : " [" + option.value + "]";
  return label;
}

constexpr std::size_t kHelpColumn = 32;
constexpr std::size_t kHelpWidth = 100;

/// `label` with `text` wrapped beside it.
std::string help_entry(const std::string& label, const std::string& text) {
  std::string out = "  " + label;
  std::size_t column = out.size();
  if (column + 2 > kHelpColumn) {
    out += "\n";
    column = 0;
  }
  out.append(kHelpColumn - column, ' ');
  column = kHelpColumn;
  std::istringstream args(text);
  for (std::string word; args >> word;) {
    if (column > kHelpColumn && column + 1 + word.size() > kHelpWidth) {
      out += "\n" + std::string(kHelpColumn, ' ');
      column = kHelpColumn;
    }
    if (column > kHelpColumn) {
      out += " ";
      ++column;
    }
    out += word;
    column += word.size();
  }
  return out + "\n";
}

/// Gives options that may stand without a value the implied one (Option::implied).
std::vector<std::string> with_implied_values(const OptionTable& table, const std::vector<std::string>& args) {
  std::vector<std::string> complete;
  for (std::size_t i = 0; i < args.size(); ++i) {
    complete.push_back(args[i]);
    for (const auto& group : table.groups) {
      for (const Option& option : group.options) {
        if (option.implied.empty() || option.name != args[i]) continue;
        const bool has_value =
            i + 1 < args.size() &&
            fmt::format("|{}|", option.value).find(fmt::format("|{}|", args[i + 1])) != std::string::npos;
        if (!has_value) complete.push_back(option.implied);
      }
    }
  }
  return complete;
}

}  // namespace

Result<Parsed> parse(const OptionTable& table, const std::vector<std::string>& given_args) {
  const std::vector<std::string> args = with_implied_values(table, given_args);
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  // Arguments are kept in the parser and converted below.
  const CLI::callback_t keep = [](const CLI::results_t&) { return true; };
  std::vector<Found> found;
  for (const auto& group : table.groups) {
    for (const Option& option : group.options) {
      const std::string names = option.letter != 0 ? fmt::format("-{},{}", option.letter, option.name) : option.name;
      CLI::Option* parsed = nullptr;
      if (option.value.empty()) {
        parsed = app.add_flag(names);
      } else {
        parsed = app.add_option(names, keep)
                     ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
                     ->expected(1)
                     ->allow_extra_args(false);
      }
      found.push_back({&option, nullptr, parsed});
    }
  }
  for (const Positional& positional : table.positionals) {
    CLI::Option* parsed = app.add_option(positional.name, keep);
    if (positional.count == Positional::Count::kMany)
      parsed->expected(-1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    found.push_back({nullptr, &positional, parsed});
  }
  const CLI::Option* help = app.add_flag("-h,--help");

  try {
    // CLI11 expects the arguments in reverse order.
    app.parse(std::vector<std::string>(args.rbegin(), args.rend()));
  } catch (const CLI::ArgumentMismatch& error) {
    // As in "--resolution: 1 required ...": only the name is used.
    const std::string message = error.what();
    return parse_error(table, message.substr(0, message.find(':')) + ": needs a value");
  } catch (const CLI::Error& error) {
    return parse_error(table, error.what());
  }
  if (help->count() > 0) return Parsed{.is_help_wanted = true, .limited = {}, .config = {}};

  for (const std::string& word : app.remaining()) {
    if (word == "--") continue;  // what follows are no options
    if (word.size() > 1 && word.front() == '-') {
      const std::string name = word.substr(0, word.find('='));
      std::string advice = did_you_mean(name, option_names(table));
      if (advice.empty()) advice = fmt::format(" (see 'pingvox {} --help')", table.command);
      return parse_error(table, fmt::format("unknown option '{}'{}", name, advice));
    }
    return parse_error(table, fmt::format("unexpected argument '{}'", word));
  }
  for (const Found& entry : found) {
    if (entry.positional && entry.parsed->count() == 0) {
      return parse_error(table,
                         fmt::format("{} is missing (see 'pingvox {} --help')", entry.positional->name, table.command));
    }
  }

  Parsed parsed;
  for (const Found& entry : std::vector<Found>(found)) {
    if (!entry.option || entry.option->name != kConfig || entry.parsed->count() == 0) continue;
    parsed.config = entry.parsed->results().back();
    const Result<void> applied = apply_config(table, parsed.config, found);
    if (!applied) return tl::unexpected(applied.error());
  }
  for (const Found& entry : found) {
    if (entry.parsed->count() == 0) continue;
    const std::vector<std::string>& values = entry.parsed->results();
    const std::string& where = entry.positional ? entry.positional->name : entry.option->name;
    const bool is_value = entry.option && !entry.option->value.empty();
    if (is_value && entry.option->repeats == Repeats::kNot && values.size() > 1) {
      return parse_error(table, fmt::format("{}: given twice: '{}' and '{}'", where, values[0], values[1]));
    }
    for (const std::string& value : values) {
      if (entry.option && !is_value && value != "true") return parse_error(table, where + ": takes no value");
      const Take& take = entry.positional ? entry.positional->take : entry.option->take;
      const auto given = give(table, where, take, value, entry.option ? entry.option->value : "");
      if (!given) return tl::unexpected(given.error());
    }
  }
  // After the values, whose errors are more helpful.
  for (const Found& entry : found) {
    if (!entry.option || entry.parsed->count() == 0) continue;
    if (const auto useful = check_conditions(table, *entry.option, found); !useful) {
      return tl::unexpected(useful.error());
    }
    if (!entry.option->only_for.empty()) parsed.limited.push_back({entry.option->name, entry.option->only_for});
  }
  return parsed;
}

Result<void> check_limited(const std::vector<LimitedOption>& options, const std::vector<std::string>& kinds) {
  for (const LimitedOption& option : options) {
    const auto is_met = [&](const std::string& kind) {
      return std::find(option.only_for.begin(), option.only_for.end(), kind) != option.only_for.end();
    };
    if (std::any_of(kinds.begin(), kinds.end(), is_met)) continue;
    // A list of all that a picture is would not help.
    const std::string here = kinds.size() > 2 ? "here" : fmt::format("on {}", fmt::join(kinds, " or "));
    return fail(Error::Code::kBadOption,
                fmt::format("{}: has no effect {}, only on {}", option.name, here, fmt::join(option.only_for, " or ")));
  }
  return {};
}

std::string help_of(const OptionTable& table) {
  std::string out = fmt::format("Usage: pingvox {}", table.command);
  for (const Positional& positional : table.positionals) {
    out += " " + positional.name + (positional.count == Positional::Count::kMany ? "..." : "");
  }
  for (const auto& group : table.groups) {
    for (const Option& option : group.options) {
      if (!option.is_required) continue;
      out += fmt::format(" {} {}", option.letter != 0 ? std::string{'-', option.letter} : option.name, option.value);
    }
  }
  out += " [OPTION]...\n";
  out += table.purpose + "\n\n";
  for (const Positional& positional : table.positionals) out += help_entry(positional.name, positional.help);
  for (const auto& group : table.groups) {
    out += "\n" + group.title + ":\n";
    for (const Option& option : group.options) {
      out += help_entry(label_of(option), option.help + (option.standard.empty() ? "" : " [" + option.standard + "]"));
    }
  }
  out += help_entry("-h, --help", "show this help");
  const auto is_length = [](const Option& option) { return option.value == "M"; };
  if (std::ranges::any_of(table.groups,
                          [&](const auto& group) { return std::ranges::any_of(group.options, is_length); })) {
    out += "\nUnits: M metres, DEG degrees, S seconds; F is a fraction, P a probability, N a whole number.\n";
  }
  if (!table.notes.empty()) out += "\n" + table.notes + "\n";
  if (!table.examples.empty()) out += "\nExamples:\n";
  for (const std::string& example : table.examples) out += "  " + example + "\n";
  return out;
}

}  // namespace pingvox::app
