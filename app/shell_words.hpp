#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox::app {

/// Quotes a word for a shell.
std::string quote_for_shell(const std::string& word);

/// A command as it was typed, with the version of the program: "pingvox 0.1.0 map dive.bin -o dive.bt".
std::string command_text(std::string_view command, const std::vector<std::string>& args);

/// Splits and unquotes text as a shell does; kBadOption for an unclosed quotation mark.
Result<std::vector<std::string>> split_shell_words(std::string_view text);

}  // namespace pingvox::app
