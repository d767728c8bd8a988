#include "shell_words.hpp"

#include <fmt/core.h>

#include <utility>

namespace pingvox::app {

std::string quote_for_shell(const std::string& word) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./,=+:@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string command_text(std::string_view command, const std::vector<std::string>& args) {
  std::string text = "pingvox " PINGVOX_VERSION " ";
  text += command;
  for (const std::string& word : args) text += ' ' + quote_for_shell(word);
  return text;
}

Result<std::vector<std::string>> split_shell_words(std::string_view text) {
  std::vector<std::string> words;
  std::string word;
  char quote = 0;
  bool has_begun = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\\' && quote != '\'' && i + 1 < text.size()) {
      word += text[++i];
      has_begun = true;
    } else if (quote != 0 ? c == quote : c == '\'' || c == '"') {
      quote = quote != 0 ? 0 : c;
      has_begun = true;  // so that '' is a word
    } else if (quote == 0 && (c == ' ' || c == '\t' || c == '\n')) {
      if (has_begun) words.push_back(std::move(word));
      word.clear();
      has_begun = false;
    } else {
      word += c;
      has_begun = true;
    }
  }
  if (quote != 0) return fail(Error::Code::kBadOption, fmt::format("{}: a quotation mark is not closed", text));
  if (has_begun) words.push_back(std::move(word));
  return words;
}

}  // namespace pingvox::app
