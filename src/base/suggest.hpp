#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pingvox {
namespace detail {

/// Longer words are ignored, as the time is quadratic.
inline constexpr std::size_t kMaxWordLength = 64;

/// Optimal string alignment: insert, delete, replace, swap two neighbours.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(above);
    above.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace detail

/// The nearest known word by edit distance (a swap of neighbours counts once), if it is near enough to suggest.
inline std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> known) {
  if (word.empty() || word.size() > detail::kMaxWordLength) return std::nullopt;
  const auto letters = [](std::string_view text) {
    return text.size() - std::min(text.find_first_not_of('-'), text.size());
  };
  std::optional<std::string> nearest;
  std::size_t least = std::max<std::size_t>(letters(word) / 3, 1) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = detail::edit_distance(word, candidate);
    if (distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  if (nearest) return nearest;
  // An abbreviation ("--res") is accepted if it is unique.
  for (const std::string& candidate : known) {
    if (letters(word) < 3 || !candidate.starts_with(word)) continue;
    if (nearest) return std::nullopt;
    nearest = candidate;
  }
  return nearest;
}

/// ": did you mean 'WORD'?", or empty.
inline std::string did_you_mean(std::string_view word, std::span<const std::string> known) {
  const auto nearest = nearest_word(word, known);
  return nearest ? fmt::format(": did you mean '{}'?", *nearest) : "";
}

}  // namespace pingvox
