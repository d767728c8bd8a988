#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace pingvox::app {

/// The word that somebody who typed `word` most likely meant: the nearest one by edit distance (a swap of neighbours
/// counts once), if it is near enough to be worth a question.
std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> known);

/// ": did you mean 'WORD'?", or nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string> known);

}  // namespace pingvox::app
