#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox::app {

/// Quotes a word for a shell.
std::string quote_for_shell(const std::string& word);

/// Splits and unquotes text as a shell does; kBadOption for an unclosed quotation mark.
Result<std::vector<std::string>> split_shell_words(std::string_view text);

}  // namespace pingvox::app
