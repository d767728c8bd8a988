#include "console.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cstdint>
#include <ostream>

#include "io/internal/descriptor.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/file.hpp"

namespace pingvox::app {
namespace {

/// Writes all of a text, waiting for its reader.
void write_patiently(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// Waits up to `patience_ms` for a reader of what does not fit. @return 0 or errno
int write_within(int descriptor, std::string_view text, std::int64_t patience_ms) {
  // So much can be written without waiting once poll() says that something can: the least buffer of a terminal, or a
  // page of a pipe.
  constexpr std::size_t kTerminalPiece = 256;
  using Clock = std::chrono::steady_clock;
  const Clock::time_point until = Clock::now() + std::chrono::milliseconds(patience_ms);
  const std::size_t piece = ::isatty(descriptor) == 1 ? kTerminalPiece : PIPE_BUF;
  while (!text.empty()) {
    const std::int64_t left_ms = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
    pollfd file = {descriptor, POLLOUT, 0};
    const int ready = ::poll(&file, 1, static_cast<int>(std::max(left_ms, std::int64_t{0})));
    if (ready == 0) return EAGAIN;
    const ssize_t written = ready < 0 ? ready : ::write(descriptor, text.data(), std::min(piece, text.size()));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return written < 0 ? errno : EIO;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

std::string error_line(std::string_view message) {
  return "pingvox: " + on_one_line(message) + "\n";
}

}  // namespace

Result<void> Console::print(std::string_view text) const {
  constexpr std::int64_t kPatience_ms = 5000;
  if (!waits_) {
    const int error = write_within(STDOUT_FILENO, text, kPatience_ms);
    if (error == EAGAIN) return fail(Error::Code::kIo, "standard output: nobody reads it");
    if (error != 0) return os_error("standard output", error);
    return {};
  }
  return write_file("-", [&](std::ostream& out) -> Result<void> {
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    return {};
  });
}

Result<void> Console::summarise(std::string_view text, std::string_view output) const {
  if (manner_.talk == Talk::kQuiet) return {};
  if (output != "-") return print(text);
  write_patiently(STDERR_FILENO, text);
  return {};
}

void Console::say(std::string_view line) const {
  if (manner_.talk == Talk::kOn) say_error(line);
}

void Console::say_error(std::string_view line) const {
  waits_ ? print_error(line) : write_what_fits(STDERR_FILENO, error_line(line));
}

void Console::offer(std::string_view text) const {
  write_what_fits(STDOUT_FILENO, text);
}

void print_error(std::string_view message) {
  // One write, so that lines of several processes do not mix.
  write_patiently(STDERR_FILENO, error_line(message));
}

void write_what_fits(int descriptor, std::string_view text) {
  static_cast<void>(write_within(descriptor, text, 0));
}

std::string name_of_input(const std::string& path) {
  return path == "-" ? std::string(ByteStream::kStandardInput) : path;
}

}  // namespace pingvox::app
