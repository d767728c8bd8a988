#pragma once

#include <fmt/core.h>

#include <string>
#include <vector>

#include "oracle_map.hpp"

namespace pingvox::test {

inline std::string hex(WideWord word) {
  std::string digits;
  do {
    digits.insert(digits.begin(), "0123456789abcdef"[static_cast<std::size_t>(word & 15)]);
    word >>= 4;
  } while (word != 0);
  return digits;
}

template <KeyWord W>
std::string text_of(const BasicKey<W>& key) {
  return fmt::format("({} {} {})", hex(key.x), hex(key.y), hex(key.z));
}
inline std::string text_of(const Node& node) {
  return fmt::format("{} {} at depth {}, value {}", node.is_leaf ? "leaf" : "inner node", text_of(node.key), node.depth,
                     node.value());
}

/// Where two lists first differ, for a person; empty when they are equal. Long lists print badly otherwise.
template <class T>
std::string first_difference(const std::vector<T>& a, const std::vector<T>& b) {
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    if (!(a[i] == b[i])) return fmt::format("{}: {}, but {}", i, text_of(a[i]), text_of(b[i]));
  }
  if (a.size() == b.size()) return "";
  return fmt::format("{} entries, but {}; the first extra one is {}", a.size(), b.size(),
                     text_of(a.size() > b.size() ? a[b.size()] : b[a.size()]));
}

}  // namespace pingvox::test
