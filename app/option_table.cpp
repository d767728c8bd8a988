#include "option_table.hpp"

#include <fmt/format.h>

// The only place that includes it: it takes five seconds to compile.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <sstream>
#include <utility>

#include "pingvox/io/file.hpp"
#include "suggest.hpp"

namespace pingvox::app {
namespace {

constexpr std::string_view kConfig = "--config";

tl::unexpected<Error> wrong_words(const OptionTable& table, const std::string& what) {
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

Result<void> give(const OptionTable& table, const std::string& where, const Take& take, const std::string& text) {
  const Result<void> taken = take(text);
  if (!taken) return fail(taken.error().code, fmt::format("{}: {}: {}", table.command, where, taken.error().message));
  return {};
}

/// The words that CLI11 found for one option or position.
struct Found {
  const Option* option = nullptr;
  const Positional* positional = nullptr;
  CLI::Option* parsed = nullptr;
};

/// Reads a configuration file and gives its values to the options that `is_given` does not know.
Result<void> apply_config(const OptionTable& table, const std::string& path,
                          const std::function<bool(const Option&)>& is_given) {
  const Result<FileBytes> file = read_file(path);
  if (!file) return tl::unexpected(file.error());
  std::istringstream text(std::string(file->bytes.begin(), file->bytes.end()));
  std::vector<CLI::ConfigItem> items;
  try {
    items = CLI::ConfigTOML().from_config(text);
  } catch (const CLI::Error& error) {
    return wrong_words(table, fmt::format("{}: {}", path, error.what()));
  }
  for (const CLI::ConfigItem& item : items) {
    if (!item.parents.empty() || item.name == "++" || item.name == "--") {
      return wrong_words(table,
                         fmt::format("{}: has a section: options stand at the top, as in 'resolution = 0.1'", path));
    }
    std::string name = "--" + item.name;
    std::replace(name.begin(), name.end(), '_', '-');
    const Option* option = name == kConfig ? nullptr : find_option(table, name);
    if (!option) {
      return wrong_words(
          table, fmt::format("{}: unknown option '{}'{}", path, item.name, did_you_mean(name, option_names(table))));
    }
    if (is_given(*option)) continue;
    if (option->repeats == Repeats::kEachCounts) {
      for (const std::string& input : item.inputs) {
        const Result<void> given = give(table, fmt::format("{}: {}", path, item.name), option->take, input);
        if (!given) return given;
      }
      continue;
    }
    const std::string value = fmt::format("{}", fmt::join(item.inputs, ","));
    if (option->value.empty()) {
      if (value == "false") continue;
      if (value != "true") return wrong_words(table, fmt::format("{}: {}: must be true or false", path, item.name));
    }
    const std::string where = fmt::format("{}: {}", path, item.name);
    if (const Result<void> given = give(table, where, option->take, value); !given) return given;
  }
  return {};
}

std::string label_of(const Option& option) {
  std::string label = option.letter != 0 ? fmt::format("-{}, {}", option.letter, option.name) : "    " + option.name;
  if (!option.value.empty()) label += " " + option.value;
  return label;
}

constexpr std::size_t kHelpColumn = 32;
constexpr std::size_t kHelpWidth = 100;

/// `label`, and `text` broken into lines beside it.
std::string help_entry(const std::string& label, const std::string& text) {
  std::string out = "  " + label;
  std::size_t column = out.size();
  if (column + 2 > kHelpColumn) {
    out += "\n";
    column = 0;
  }
  out.append(kHelpColumn - column, ' ');
  column = kHelpColumn;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
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

Result<Parsed> parse(const OptionTable& table, const std::vector<std::string>& words) {
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  // What is found stays with the parser's options, to be turned into values below.
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
                     ->multi_option_policy(option.repeats == Repeats::kEachCounts ? CLI::MultiOptionPolicy::TakeAll
                                                                                  : CLI::MultiOptionPolicy::TakeLast);
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
    // CLI11 takes its words from the back.
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ArgumentMismatch& error) {
    // "--resolution: 1 required ..." in its own words; the name is all that we need.
    const std::string message = error.what();
    return wrong_words(table, message.substr(0, message.find(':')) + ": needs a value");
  } catch (const CLI::Error& error) {
    return wrong_words(table, error.what());
  }
  if (help->count() > 0) return Parsed::kHelpWanted;

  for (const std::string& word : app.remaining()) {
    if (word.size() > 1 && word.front() == '-') {
      const std::string name = word.substr(0, word.find('='));
      return wrong_words(table, fmt::format("unknown option '{}'{}", name, did_you_mean(name, option_names(table))));
    }
    return wrong_words(table, fmt::format("unexpected argument '{}'", word));
  }
  for (const Found& entry : found) {
    if (entry.positional && entry.parsed->count() == 0) {
      return wrong_words(table,
                         fmt::format("{} is missing (see 'pingvox {} --help')", entry.positional->name, table.command));
    }
  }

  const auto is_given = [&](const Option& option) {
    const auto same = [&](const Found& entry) { return entry.option == &option; };
    return std::find_if(found.begin(), found.end(), same)->parsed->count() > 0;
  };
  for (const Found& entry : found) {
    if (!entry.option || entry.option->name != kConfig || entry.parsed->count() == 0) continue;
    const Result<void> applied = apply_config(table, entry.parsed->results().back(), is_given);
    if (!applied) return tl::unexpected(applied.error());
  }
  for (const Found& entry : found) {
    if (entry.parsed->count() == 0) continue;
    const bool all = entry.positional != nullptr || entry.option->repeats == Repeats::kEachCounts;
    const std::vector<std::string>& values = entry.parsed->results();
    for (std::size_t i = all ? 0 : values.size() - 1; i < values.size(); ++i) {
      const std::string& where = entry.positional ? entry.positional->name : entry.option->name;
      const Take& take = entry.positional ? entry.positional->take : entry.option->take;
      if (entry.option && entry.option->value.empty() && values[i] != "true") {
        return wrong_words(table, where + ": takes no value");
      }
      if (const Result<void> given = give(table, where, take, values[i]); !given) {
        return tl::unexpected(given.error());
      }
    }
  }
  return Parsed::kDone;
}

std::string help_of(const OptionTable& table) {
  std::string out = fmt::format("Usage: pingvox {}", table.command);
  for (const Positional& positional : table.positionals) {
    out += " " + positional.name + (positional.count == Positional::Count::kMany ? "..." : "");
  }
  const Option* output = find_option(table, "--output");
  if (output) out += " -o " + output->value;
  out += " [OPTION]...\n";
  out += table.purpose + "\n\n";
  for (const Positional& positional : table.positionals) out += help_entry(positional.name, positional.help);
  for (const auto& group : table.groups) {
    out += "\n" + group.title + ":\n";
    for (const Option& option : group.options) {
      out += help_entry(label_of(option), option.help + (option.standard.empty() ? "" : " [" + option.standard + "]"));
    }
  }
  out += help_entry("-h, --help", "this text");
  if (!table.notes.empty()) out += "\n" + table.notes + "\n";
  if (!table.examples.empty()) out += "\nExamples:\n";
  for (const std::string& example : table.examples) out += "  " + example + "\n";
  return out;
}

}  // namespace pingvox::app
