#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace pingvox::test {

/// The cells of a range of keys in the plane z = 0, from key (0, 0) on, x to the right and y downwards.
template <class Keys>
std::string as_text(const Keys& keys) {
  std::vector<std::string> rows;
  std::size_t columns = 0;
  for (const auto key : keys) {
    const std::size_t x = key.x, y = key.y;
    if (rows.size() <= y) rows.resize(y + 1);
    if (rows[y].size() <= x) rows[y].resize(x + 1, '.');
    rows[y][x] = '#';
    columns = std::max(columns, x + 1);
  }
  std::string picture;
  for (std::string& row : rows) {
    row.resize(columns, '.');
    picture += row + "\n";
  }
  return picture;
}

}  // namespace pingvox::test
