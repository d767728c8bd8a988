#include "option_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "base/suggest.hpp"
#include "io/internal/toml_file.hpp"
#include "pingvox/io/file.hpp"

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

/// What was given for an option or a positional argument.
struct Given {
  const Option* option = nullptr;
  const Positional* positional = nullptr;
  std::vector<std::string> typed;                        ///< on the command line
  std::optional<std::string> configured = std::nullopt;  ///< in the configuration file

  const std::string& name() const { return option != nullptr ? option->name : positional->name; }
  bool is_flag() const { return option != nullptr && option->value.empty(); }
};

Given* find_given(std::vector<Given>& given, const Option& option) {
  return &*std::ranges::find(given, &option, &Given::option);
}

/// Whether `word` is one of the choices that the value of `option` names, as in "first|all".
bool is_choice(const Option& option, std::string_view word) {
  return fmt::format("|{}|", option.value).find(fmt::format("|{}|", word)) != std::string::npos;
}

/// Sorts the arguments of the command line by the option or position that they are for. Takes --name VALUE,
/// --name=VALUE, -n VALUE and -nVALUE; what follows -- is positional.
class Arguments {
 public:
  Arguments(const OptionTable& table, const std::vector<std::string>& args, std::vector<Given>& given)
      : table_(table), args_(args), given_(given) {}

  /// @return whether the help is wanted
  Result<bool> sort() {
    bool has_options = true, is_help_wanted = false;
    while (next_ < args_.size()) {
      const std::string& word = args_[next_++];
      if (!has_options || word.size() < 2 || word.front() != '-') {
        add_positional(word);
      } else if (word == "--") {
        has_options = false;
      } else if (word.starts_with("-h") || word == "--help") {
        is_help_wanted = true;
      } else if (const Result<void> added = add_option(word); !added) {
        return tl::unexpected(added.error());
      }
    }
    if (!is_help_wanted && unexpected_) return tl::unexpected(*unexpected_);
    return is_help_wanted;
  }

 private:
  void add_positional(const std::string& word) {
    for (Given& given : given_) {
      const Positional* positional = given.positional;
      if (positional == nullptr || (positional->count == Positional::Count::kOne && !given.typed.empty())) continue;
      given.typed.push_back(word);
      return;
    }
    refuse(fmt::format("unexpected argument '{}'", word));
  }

  /// @param word  "--name", "--name=VALUE", "-n" or "-nVALUE"
  Result<void> add_option(const std::string& word) {
    const bool is_long = word.starts_with("--");
    const std::size_t end = is_long ? std::min(word.find('='), word.size()) : 2;
    const std::string name = word.substr(0, end);
    const Option* option = is_long ? find_option(table_, name) : find_letter(name.back());
    if (option == nullptr) {
      std::string advice = did_you_mean(name, option_names(table_));
      if (advice.empty()) advice = fmt::format(" (see 'pingvox {} --help')", table_.command);
      refuse(fmt::format("unknown option '{}'{}", is_long ? name : word, advice));
      return {};
    }
    std::vector<std::string>& typed = find_given(given_, *option)->typed;
    const bool has_value = end < word.size();
    if (option->value.empty()) {
      if (has_value) return parse_error(table_, option->name + ": takes no value");
      typed.emplace_back("true");
    } else if (has_value) {
      typed.push_back(word.substr(is_long ? end + 1 : end));
    } else if (!option->implied.empty() && (next_ == args_.size() || !is_choice(*option, args_[next_]))) {
      typed.push_back(option->implied);
    } else if (next_ == args_.size()) {
      return parse_error(table_, option->name + ": needs a value");
    } else {
      typed.push_back(args_[next_++]);
    }
    return {};
  }

  const Option* find_letter(char letter) const {
    for (const auto& group : table_.groups) {
      const auto found = std::ranges::find(group.options, letter, &Option::letter);
      if (found != group.options.end()) return &*found;
    }
    return nullptr;
  }

  /// Only the first error is reported, and none where the help is wanted.
  void refuse(const std::string& what) {
    if (!unexpected_) unexpected_ = parse_error(table_, what).value();
  }

  const OptionTable& table_;
  const std::vector<std::string>& args_;
  std::vector<Given>& given_;
  std::size_t next_ = 0;
  std::optional<Error> unexpected_;
};

/// Reads a configuration file and gives its values to the options that the command line does not have.
Result<void> apply_config(const OptionTable& table, const std::string& path, std::vector<Given>& given) {
  const Result<FileBytes> file = read_file(path);
  if (!file) return tl::unexpected(file.error());
  const Result<std::vector<TomlSection>> sections = read_toml(*file);
  if (!sections) return parse_error(table, sections.error().message);
  if (sections->size() > 1) {
    return parse_error(
        table, fmt::format("{}: line {}: has a section: options stand at the top, as in 'resolution = 0.1'", path,
                           (*sections)[1].line));
  }
  for (const auto& [key, value] : sections->front().values) {
    const std::string where = fmt::format("{}: line {}: {}", path, value.line, key);
    std::string name = "--" + key;
    std::ranges::replace(name, '_', '-');
    const Option* option = name == kConfig ? nullptr : find_option(table, name);
    if (option == nullptr) {
      return parse_error(table, fmt::format("{}: line {}: unknown option '{}'{}", path, value.line, key,
                                            did_you_mean(name, option_names(table))));
    }
    Given& entry = *find_given(given, *option);
    if (!entry.typed.empty()) continue;
    if (entry.is_flag() && value.text == "false") continue;
    if (entry.is_flag() && value.text != "true") return parse_error(table, where + ": must be true or false");
    const bool repeats = option->repeats == Repeats::kEachCounts;
    for (const std::string& text : repeats ? value.items : std::vector<std::string>{value.text}) {
      if (const auto taken = give(table, where, option->take, text, option->value); !taken) return taken;
    }
    if (!repeats) entry.configured = value.text;
  }
  return {};
}

/// The value of an option or a positional argument, given or by default; nullopt when there is none.
std::optional<std::string> value_of(const std::string& name, const std::vector<Given>& given) {
  for (const Given& entry : given) {
    if (entry.name() != name) continue;
    if (!entry.typed.empty()) return entry.typed.back();
    if (entry.configured) return entry.configured;
    if (entry.option && !entry.option->standard.empty()) return entry.option->standard;
  }
  return std::nullopt;
}

bool is_met(const Condition& condition, const std::vector<Given>& given) {
  if (condition.values.empty()) {
    return std::any_of(given.begin(), given.end(), [&](const Given& entry) {
      return entry.option && entry.option->name == condition.name && (!entry.typed.empty() || entry.configured);
    });
  }
  const auto value = value_of(condition.name, given);
  return value && std::find(condition.values.begin(), condition.values.end(), *value) != condition.values.end();
}

std::string text_of(const Condition& condition) {
  const std::string values = fmt::format("{}", fmt::join(condition.values, " or "));
  return condition.name + (values.empty() ? "" : " ") + values;
}

/// Refuses an option without effect.
Result<void> check_conditions(const OptionTable& table, const Option& option, const std::vector<Given>& given) {
  const auto met = [&](const Condition& condition) { return is_met(condition, given); };
  if (option.only_with.empty() || std::any_of(option.only_with.begin(), option.only_with.end(), met)) return {};
  std::vector<std::string> needed;
  for (const Condition& condition : option.only_with) needed.push_back(text_of(condition));
  const Condition& first = option.only_with.front();
  const auto value = first.values.empty() ? std::nullopt : value_of(first.name, given);
  const std::string any = fmt::format("{}", fmt::join(needed, " or "));
  return parse_error(table, fmt::format("{}: has no effect {}", option.name,
                                        value ? fmt::format("with {} {}, only with {}", first.name, *value, any)
                                              : fmt::format("without {}", any)));
}

std::string label_of(const Option& option) {
  std::string label = option.letter != 0 ? fmt::format("-{}, {}", option.letter, option.name) : "    " + option.name;
  if (!option.value.empty()) {
    // A choice may be the next argument, another value stands behind "=" (is_choice).
    const bool is_of_choices = option.value.find('|') != std::string::npos;
    label += option.implied.empty() ? " " + option.value : (is_of_choices ? " [" : "[=") + option.value + "]";
  }
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

}  // namespace

Result<Parsed> parse(const OptionTable& table, const std::vector<std::string>& args) {
  std::vector<Given> given;
  for (const auto& group : table.groups) {
    for (const Option& option : group.options) given.push_back({&option, nullptr, {}});
  }
  for (const Positional& positional : table.positionals) given.push_back({nullptr, &positional, {}});
  const Result<bool> is_help_wanted = Arguments(table, args, given).sort();
  if (!is_help_wanted) return tl::unexpected(is_help_wanted.error());
  if (*is_help_wanted) return Parsed{.is_help_wanted = true, .limited = {}, .config = {}, .typed = {}};
  for (const Given& entry : given) {
    if (entry.positional != nullptr && entry.typed.empty()) {
      return parse_error(table, fmt::format("{} is missing (see 'pingvox {} --help')", entry.name(), table.command));
    }
  }

  Parsed parsed;
  const auto config =
      std::ranges::find_if(given, [](const Given& entry) { return entry.name() == kConfig && !entry.typed.empty(); });
  if (config != given.end()) {
    parsed.config = config->typed.back();
    if (const auto applied = apply_config(table, parsed.config, given); !applied) {
      return tl::unexpected(applied.error());
    }
  }
  for (const Given& entry : given) {
    const Option* option = entry.option;
    if (option != nullptr && !entry.is_flag() && option->repeats == Repeats::kNot && entry.typed.size() > 1) {
      return parse_error(table,
                         fmt::format("{}: given twice: '{}' and '{}'", entry.name(), entry.typed[0], entry.typed[1]));
    }
    for (const std::string& value : entry.typed) {
      const auto taken = option != nullptr ? give(table, entry.name(), option->take, value, option->value)
                                           : give(table, entry.name(), entry.positional->take, value, "");
      if (!taken) return tl::unexpected(taken.error());
    }
  }
  // After the values, whose errors are more helpful.
  for (const Given& entry : given) {
    if (entry.option == nullptr || entry.typed.empty()) continue;
    for (const std::string& value : entry.typed) parsed.typed.emplace_back(entry.name(), value);
    if (const auto useful = check_conditions(table, *entry.option, given); !useful) {
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
  for (const Positional& positional : table.positionals) {
    out += help_entry(positional.name + (positional.count == Positional::Count::kMany ? "..." : ""), positional.help);
  }
  for (const auto& group : table.groups) {
    out += "\n" + group.title + ":\n";
    for (const Option& option : group.options) {
      const std::string_view repeats = option.repeats == Repeats::kEachCounts ? "; repeatable" : "";
      const std::string standard = option.standard.empty() ? "" : fmt::format(" [{}]", option.standard);
      out += help_entry(label_of(option), fmt::format("{}{}{}", option.help, repeats, standard));
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
