#include "progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace pingvox::app {
namespace {

constexpr std::chrono::milliseconds kInterval{100};
constexpr std::size_t kWidth = 79;
constexpr std::size_t kBarWidth = 30;

bool is_wanted(const OutputOptions& output_options) {
  if (output_options.talk == Talk::kQuiet || output_options.progress == ShowProgress::kNever) return false;
  return output_options.progress == ShowProgress::kAlways || ::isatty(STDERR_FILENO) == 1;
}

}  // namespace

// Delayed, so that it does not flicker during short work.
ProgressBar::ProgressBar(const OutputOptions& output_options)
    : shown_(is_wanted(output_options)),
      next_(output_options.progress == ShowProgress::kAlways ? Clock::now() : Clock::now() + kInterval) {}

bool ProgressBar::is_due() {
  if (!shown_) return false;
  const auto now = Clock::now();
  if (now < next_) return false;
  next_ = now + kInterval;
  return true;
}

void ProgressBar::draw(std::optional<double> share, std::string_view text) {
  if (!shown_) return;
  drawn_ = true;
  std::string line;
  if (share) {
    const double clamped = std::clamp(*share, 0.0, 1.0);
    const auto full = static_cast<std::size_t>(clamped * kBarWidth);
    line = fmt::format("[{}{}] {:3.0f} %  ", std::string(full, '#'), std::string(kBarWidth - full, '.'),
                       std::floor(clamped * 100.0));
  }
  line = on_one_line((line + std::string(text)).substr(0, kWidth));
  // Left out where it cannot be written: no work depends on it.
  write_what_fits(STDERR_FILENO, "\r\x1b[K" + line);
}

void ProgressBar::clear() {
  if (!drawn_) return;
  drawn_ = false;
  write_what_fits(STDERR_FILENO, "\r\x1b[K");
}

}  // namespace pingvox::app
