#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

/// Words of messages.
namespace pingvox {

/// Text from a file, for messages: without line breaks and control characters.
inline std::string on_one_line(std::string_view text) {
  std::string line(text);
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
  std::ranges::replace_if(line, is_control, '?');
  return line;
}

/// "1 beam", "2 beams", "3 echoes"
inline std::string counted(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : noun.ends_with('o') ? "es" : "s");
}

}  // namespace pingvox
