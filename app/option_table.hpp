#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox::app {

/// Turns the text behind an option into a value. Its message says what is wrong with the text, not where it stood.
using Take = std::function<Result<void>(const std::string&)>;

/// Whether an option may be given several times.
enum class Repeats {
  kNot,
  kEachCounts,  ///< in the order of the command line
};

/// Holds if another option or a positional argument has one of these values, given or by default; with no values, if it
/// is given at all.
struct Condition {
  std::string name;  ///< "--filter", "WORLD"
  std::vector<std::string> values = {};
};

/// One option of a command: how it is called, what it takes, what it means.
struct Option {
  std::string name;   ///< "--resolution"
  char letter = 0;    ///< 'o' for -o; 0: none
  std::string value;  ///< what its value is called in the help; empty: a flag
  std::string help;
  std::string standard;  ///< the default, as typed; empty: none
  Take take;             ///< of a flag: gets "true"
  Repeats repeats = Repeats::kNot;
  /// The option has an effect only if one of these holds; empty: always.
  std::vector<Condition> only_with = {};
  /// The kinds of input or output on which the option has an effect, known only once files are open; empty: all.
  std::vector<std::string> only_for = {};
};

/// A word without a dash in front.
struct Positional {
  enum class Count { kOne, kMany };
  std::string name;  ///< "LOG"
  Count count = Count::kOne;
  std::string help;
  Take take;
};

/// What a command is called with. The same table makes the parser, the keys of a configuration file, and the help.
struct OptionTable {
  struct Group {
    std::string title;
    std::vector<Option> options;
  };

  std::string command;
  std::string purpose;                  ///< for the help, one paragraph
  std::vector<Positional> positionals;  ///< all of them needed; the last one may be kMany
  std::vector<Group> groups;
  std::vector<std::string> examples;
  std::string notes;  ///< for the help, behind the options
};

/// An option of the command line that has an effect only on some inputs or outputs.
struct LimitedOption {
  std::string name;
  std::vector<std::string> only_for;
};

struct Parsed {
  bool is_help_wanted = false;
  std::vector<LimitedOption> limited;  ///< options that were given and whose `only_for` is not empty
};

/// Passes the arguments to the table's `take` functions: first those of a --config file (TOML, the option's names
/// without the dashes), then those of the command line. An option of the command line that cannot have an effect
/// (`Option::only_with`, or given twice) is refused; one of the configuration file is a default, and is not.
/// @return kBadOption for invalid usage, with the nearest valid name; kIo when the configuration cannot be read
Result<Parsed> parse(const OptionTable& table, const std::vector<std::string>& args);

/// Refuses options without effect: kBadOption if one of them is for none of `kinds`.
Result<void> check_limited(const std::vector<LimitedOption>& options, const std::vector<std::string>& kinds);

/// The help text of a command.
std::string help_of(const OptionTable& table);

}  // namespace pingvox::app
