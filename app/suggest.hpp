#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace pingvox::app {

/// The nearest known word by edit distance (a swap of neighbours counts once), if it is near enough to suggest.
std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> known);

/// ": did you mean 'WORD'?", or empty.
std::string did_you_mean(std::string_view word, std::span<const std::string> known);

}  // namespace pingvox::app
