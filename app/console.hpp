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

/// How a command talks to whoever called it.
struct OutputOptions {
  Report report = Report::kText;
  Talk talk = Talk::kOn;
  ShowProgress progress = ShowProgress::kAuto;
};

/// The two ways out of the program: standard output for results, standard error for talk.
class Console {
 public:
  explicit Console(const OutputOptions& output_options) : manner_(output_options) {}

  const OutputOptions& output_options() const { return manner_; }

  /// Writes a result to standard output. kIo: nobody reads it, or the disk is full.
  Result<void> print(std::string_view text) const;
  /// The summary of what a command did, for people: to standard output, or to standard error when the output itself
  /// went there. Nothing when asked to be quiet.
  Result<void> summarise(std::string_view text, std::string_view output) const;
  /// One line on standard error, unless asked to be quiet. Nothing can be done when it fails.
  void say(std::string_view line) const;

 private:
  OutputOptions manner_;
};

/// One line on standard error, "pingvox: message", whatever the message contains.
void print_error(std::string_view message);

/// The text with its control characters (a file name may hold line breaks) replaced by '?'.
std::string on_one_line(std::string_view text);

}  // namespace pingvox::app
