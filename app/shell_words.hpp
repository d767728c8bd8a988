#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox::app {

/// The word as one types it in a shell.
std::string quote_for_shell(const std::string& word);

/// The words of a text, split and unquoted as a shell does it; kBadOption when a quotation mark is not closed.
Result<std::vector<std::string>> split_shell_words(std::string_view text);

}  // namespace pingvox::app
