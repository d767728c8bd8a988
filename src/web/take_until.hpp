#pragma once

#include <cstddef>
#include <string_view>

namespace pingvox::web {

/// What is before the next separator; the rest stays in `text`.
inline std::string_view take_until(char separator, std::string_view& text) {
  const std::size_t at = text.find(separator);
  const std::string_view taken = text.substr(0, at);
  text = at == std::string_view::npos ? std::string_view() : text.substr(at + 1);
  return taken;
}

}  // namespace pingvox::web
