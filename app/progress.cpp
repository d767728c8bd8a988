#include "progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace pingvox::app {
namespace {

constexpr std::chrono::milliseconds kInterval{100};
constexpr std::size_t kWidth = 79;

bool is_wanted(const Manner& manner) {
  if (manner.talk == Talk::kQuiet || manner.progress == ShowProgress::kNever) return false;
  return manner.progress == ShowProgress::kAlways || ::isatty(STDERR_FILENO) == 1;
}

}  // namespace

ProgressLine::ProgressLine(const Manner& manner) : shown_(is_wanted(manner)), next_(Clock::now() + kInterval) {}

bool ProgressLine::is_due() {
  if (!shown_) return false;
  const auto now = Clock::now();
  if (now < next_) return false;
  next_ = now + kInterval;
  return true;
}

void ProgressLine::draw(std::string_view text) {
  if (!shown_) return;
  drawn_ = true;
  const std::string line = "\r\x1b[K" + on_one_line(text.substr(0, kWidth));
  std::fwrite(line.data(), 1, line.size(), stderr);
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (!drawn_) return;
  drawn_ = false;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
}

}  // namespace pingvox::app
