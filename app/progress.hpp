#pragma once

#include <chrono>
#include <optional>
#include <string_view>

#include "console.hpp"

namespace pingvox::app {

/// A progress bar on standard error, redrawn ten times a second. Shown only on a terminal after a tenth of a second, or
/// always if requested; removed at the end.
class ProgressBar {
 public:
  explicit ProgressBar(const OutputOptions& output_options);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() { clear(); }

  /// Whether it is time to draw again.
  bool is_due();
  /// Draws a bar (none if the share is unknown) and the text, cut to the usual width of a terminal.
  void draw(std::optional<double> share, std::string_view text);
  /// Removes the bar.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool shown_;
  bool drawn_ = false;
  Clock::time_point next_;
};

}  // namespace pingvox::app
