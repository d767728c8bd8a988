#pragma once

#include <chrono>
#include <optional>
#include <string_view>

#include "console.hpp"

namespace pingvox::app {

/// A bar on standard error that says how far the work is, drawn over itself ten times a second. It is there only on a
/// terminal, after a tenth of a second, or from the start when it was asked for; it is gone when the work is done.
class ProgressBar {
 public:
  explicit ProgressBar(const OutputOptions& output_options);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() { clear(); }

  /// Whether it is time to draw again: ask before making up a text.
  bool is_due();
  /// Draws a bar (without one, when nobody knows the share) and the text, cut to a terminal's usual width.
  void draw(std::optional<double> share, std::string_view text);
  /// Takes the bar away.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool shown_;
  bool drawn_ = false;
  Clock::time_point next_;
};

}  // namespace pingvox::app
