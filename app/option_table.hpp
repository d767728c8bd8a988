#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox::app {

/// Parses the argument of an option. Its error describes the text, without the name of the option.
using Take = std::function<Result<void>(const std::string&)>;

/// Whether an option may be given several times.
enum class Repeats {
  kNot,
  kEachCounts,  ///< in the order of the command line
};

/// Met if another option or positional argument has one of these values, given or by default; without values: if it is
/// given.
struct Condition {
  std::string name;  ///< "--filter", "WORLD"
  std::vector<std::string> values = {};
};

/// One option of a command.
struct Option {
  std::string name;   ///< "--resolution"
  char letter = 0;    ///< 'o' for -o; 0: none
  std::string value;  ///< name of its value in the help; empty: a flag
  std::string help;
  std::string standard;  ///< the default, as typed; empty: none
  Take take;             ///< of a flag: gets "true"
  Repeats repeats = Repeats::kNot;
  /// The option has an effect only if one of these holds; empty: always.
  std::vector<Condition> only_with = {};
  /// Kinds of input or output on which the option has an effect, checked after opening the files; empty: all.
  std::vector<std::string> only_for = {};
  /// Whether the usage line shows it; the code that reads the value reports when it is missing.
  bool is_required = false;
  /// Value of an option that is given without one; the next argument is its value only if it is one of the choices that
  /// `value` names. Empty: it needs a value.
  std::string implied = {};
};

/// A positional argument.
struct Positional {
  enum class Count { kOne, kMany };
  std::string name;  ///< "LOG"
  Count count = Count::kOne;
  std::string help;
  Take take;
};

/// Arguments of a command: defines the parser, the keys of a configuration file, and the help.
struct OptionTable {
  struct Group {
    std::string title;
    std::vector<Option> options;
  };

  std::string command;
  std::string purpose;                  ///< for the help, one paragraph
  std::vector<Positional> positionals;  ///< all required; the last one may be kMany
  std::vector<Group> groups;
  std::vector<std::string> examples;
  std::string notes;  ///< for the help, after the options
};

/// An option of the command line that has an effect only on some inputs or outputs.
struct LimitedOption {
  std::string name;
  std::vector<std::string> only_for;
};

struct Parsed {
  bool is_help_wanted = false;
  std::vector<LimitedOption> limited;  ///< options that were given and whose `only_for` is not empty
  std::string config;                  ///< the configuration file that was read; empty: none
  /// What was given on the command line: each option with its value, in the order of the table.
  std::vector<std::pair<std::string, std::string>> typed;
};

/// Passes the arguments to the `take` functions of the table: first those of a --config file (TOML, names without
/// dashes), then those of the command line. Options of the command line without effect (`Option::only_with`, or given
/// twice) are refused; those of the configuration file are not.
/// @return kBadOption for invalid usage, with the nearest valid name; kIo when the configuration cannot be read
Result<Parsed> parse(const OptionTable& table, const std::vector<std::string>& args);

/// Refuses options without effect: kBadOption if one of them is for none of `kinds`.
Result<void> check_limited(const std::vector<LimitedOption>& options, const std::vector<std::string>& kinds);

/// The help text of a command.
std::string help_of(const OptionTable& table);

}  // namespace pingvox::app
