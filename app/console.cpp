#include "console.hpp"

#include <poll.h>

#include <algorithm>
#include <cstdio>
#include <ostream>

#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/file.hpp"

namespace pingvox::app {

Result<void> Console::print(std::string_view text) const {
  return write_file("-", [&](std::ostream& out) -> Result<void> {
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    return {};
  });
}

Result<void> Console::summarise(std::string_view text, std::string_view output) const {
  if (manner_.talk == Talk::kQuiet) return {};
  if (output != "-") return print(text);
  std::fwrite(text.data(), 1, text.size(), stderr);
  return {};
}

void Console::say(std::string_view line) const {
  if (manner_.talk == Talk::kOn) print_error(line);
}

void print_error(std::string_view message) {
  // One write, so that lines of several processes do not mix.
  const std::string line = "pingvox: " + on_one_line(message) + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}

bool can_take_more(int descriptor) {
  pollfd file = {descriptor, POLLOUT, 0};
  return ::poll(&file, 1, 0) == 1;
}

std::string name_of_input(const std::string& path) {
  return path == "-" ? std::string(ByteStream::kStandardInput) : path;
}

std::string on_one_line(std::string_view text) {
  std::string line(text);
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
  std::replace_if(line.begin(), line.end(), is_control, '?');
  return line;
}

}  // namespace pingvox::app
