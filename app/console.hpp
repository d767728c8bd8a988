#pragma once

#include <string>
#include <string_view>

#include "base/words.hpp"
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

  /// From now on output does not wait for its reader: messages that it does not take are dropped, and a result that it
  /// does not take within five seconds is an error.
  void never_wait() { waits_ = false; }

  /// Writes a result to standard output. kIo: closed pipe or full disk.
  Result<void> print(std::string_view text) const;
  /// Prints a summary to standard output, or to standard error if the output file is standard output; nothing if quiet.
  Result<void> summarise(std::string_view text, std::string_view output) const;
  /// Prints a line on standard error, unless quiet. Errors are ignored.
  void say(std::string_view line) const;
  /// The same of an error, also if quiet.
  void say_error(std::string_view line) const;
  /// Writes a part of a running report to standard output if that is possible without waiting. Errors are ignored.
  void offer(std::string_view text) const;

 private:
  OutputOptions manner_;
  bool waits_ = true;
};

/// Prints "pingvox: message" as one line on standard error. Errors are ignored.
void print_error(std::string_view message);

/// Writes to a standard stream as far as that is possible without waiting for its reader. Errors are ignored.
void write_what_fits(int descriptor, std::string_view text);

/// A file of the command line as messages name it: "-" is standard input.
std::string name_of_input(const std::string& path);

}  // namespace pingvox::app
