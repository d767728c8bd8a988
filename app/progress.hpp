#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "console.hpp"

namespace pingvox::app {

/// A line on standard error that says how far the work is, drawn over itself ten times a second. It is there only on a
/// terminal (or when asked for), and gone when the work is done.
class ProgressLine {
 public:
  explicit ProgressLine(const Manner& manner);
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() { clear(); }

  bool is_shown() const { return shown_; }
  /// Whether it is time to draw again: ask before making up a text.
  bool is_due();
  /// Draws the text, cut to a terminal's usual width.
  void draw(std::string_view text);
  /// Takes the line away.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool shown_;
  bool drawn_ = false;
  Clock::time_point next_;
};

}  // namespace pingvox::app
