#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox::app {

/// Turns the text behind an option into a value. Its message says what is wrong with the text, not where it stood.
using Take = std::function<Result<void>(const std::string&)>;

/// What it means that an option is there several times.
enum class Repeats {
  kLastCounts,
  kEachCounts,  ///< in the order of the call
};

/// One option of a command: how it is called, what it takes, what it means.
struct Option {
  std::string name;   ///< "--resolution"
  char letter = 0;    ///< 'o' for -o; 0: none
  std::string value;  ///< what its value is called in the help; empty: a flag
  std::string help;
  std::string standard;  ///< the default, as typed; empty: none
  Take take;             ///< of a flag: gets "true"
  Repeats repeats = Repeats::kLastCounts;
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

enum class Parsed {
  kDone,
  kHelpWanted,
};

/// Gives the words to the table's `take` functions: first those of a --config file (TOML, the option's names without
/// the dashes), then those of the call.
/// @return kBadOption when the words are off, with the nearest right one; kIo when the configuration cannot be read
Result<Parsed> parse(const OptionTable& table, const std::vector<std::string>& words);

/// The help text of a command.
std::string help_of(const OptionTable& table);

}  // namespace pingvox::app
