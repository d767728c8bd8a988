#pragma once

#include <string>
#include <string_view>

#include "pingvox/result.hpp"

namespace pingvox::app {

enum class Report { kText, kJson };
enum class Talk { kOn, kQuiet };
enum class ShowProgress {
  kAuto,  ///< when standard error is a terminal
  kAlways,
  kNever,
};

/// Options of the output of a command.
struct OutputOptions {
  Report report = Report::kText;
  Talk talk = Talk::kOn;
  ShowProgress progress = ShowProgress::kAuto;
};

/// Standard output for results, standard error for messages.
class Console {
 public:
  explicit Console(const OutputOptions& output_options) : manner_(output_options) {}

  const OutputOptions& output_options() const { return manner_; }

  /// Writes a result to standard output. kIo: closed pipe or full disk.
  Result<void> print(std::string_view text) const;
  /// Prints a summary to standard output, or to standard error if the output file is standard output; nothing if quiet.
  Result<void> summarise(std::string_view text, std::string_view output) const;
  /// Prints a line on standard error, unless quiet. Errors are ignored.
  void say(std::string_view line) const;

 private:
  OutputOptions manner_;
};

/// Prints "pingvox: message" as one line on standard error.
void print_error(std::string_view message);

/// Whether a line can be written to a file, pipe or terminal without waiting for its reader.
bool can_take_more(int descriptor);

/// A file of the command line as messages name it: "-" is standard input.
std::string name_of_input(const std::string& path);

/// Replaces control characters (a file name may contain line breaks) by '?'.
std::string on_one_line(std::string_view text);

}  // namespace pingvox::app
