#include "io/bytes/json_events.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "io/bytes/text.hpp"

namespace pingvox {
namespace {

using JsonKind = JsonEvent::Kind;

/// Whether it is a number as JSON writes it, or NaN or Infinity.
bool is_number(std::string_view word) {
  std::string_view rest = word;
  if (rest.starts_with('-')) rest.remove_prefix(1);
  if (rest == "NaN" || rest == "Infinity") return true;
  if (rest.empty() || rest.front() < '0' || rest.front() > '9') return false;
  if (rest.find_first_not_of("0123456789") == std::string_view::npos) return true;
  double number = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  // Numbers beyond the largest are no error of the text.
  return end == word.data() + word.size() && (error == std::errc{} || error == std::errc::result_out_of_range);
}

void add_utf8(std::string& to, unsigned code) {
  constexpr unsigned kLow = 0x3fU, kMore = 0x80U;
  if (code < 0x80U) {
    to.push_back(static_cast<char>(code));
  } else if (code < 0x800U) {
    to.push_back(static_cast<char>(0xc0U | code >> 6U));
    to.push_back(static_cast<char>(kMore | (code & kLow)));
  } else {
    to.push_back(static_cast<char>(0xe0U | code >> 12U));
    to.push_back(static_cast<char>(kMore | (code >> 6U & kLow)));
    to.push_back(static_cast<char>(kMore | (code & kLow)));
  }
}

}  // namespace

void JsonEvents::skip_blanks() {
  rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size()));
}

bool JsonEvents::eat(char c) {
  skip_blanks();
  if (!rest_.starts_with(c)) return false;
  rest_.remove_prefix(1);
  return true;
}

/// The text between quotation marks.
std::optional<std::string_view> JsonEvents::string() {
  if (!eat('"')) return std::nullopt;
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    if (rest_[i] == '\\') {
      ++i;
    } else if (rest_[i] == '"') {
      const std::string_view text = rest_.substr(0, i);
      rest_.remove_prefix(i + 1);
      return text;
    }
  }
  return std::nullopt;
}

std::optional<JsonEvent> JsonEvents::next() {
  if (at_end_) return std::nullopt;
  const auto event = open_.empty() ? value({}) : part();
  if (!event || !open_.empty()) return event;
  skip_blanks();
  at_end_ = rest_.empty();
  return at_end_ ? event : std::nullopt;
}

/// The next one within an object or array.
std::optional<JsonEvent> JsonEvents::part() {
  const char end = open_.back();
  if (eat(end)) {
    open_.pop_back();
    needs_comma_ = true;
    return JsonEvent{JsonKind::kEnd, {}, {}};
  }
  if (needs_comma_ && !eat(',')) return std::nullopt;
  if (end == ']') return value({});
  const auto key = string();
  if (!key || !eat(':')) return std::nullopt;
  return value(*key);
}

std::optional<JsonEvent> JsonEvents::value(std::string_view key) {
  constexpr std::size_t kMaxDepth = 32;
  skip_blanks();
  if (rest_.starts_with('{') || rest_.starts_with('[')) {
    if (open_.size() == kMaxDepth) return std::nullopt;
    const bool is_object = rest_.front() == '{';
    rest_.remove_prefix(1);
    open_.push_back(is_object ? '}' : ']');
    needs_comma_ = false;
    return JsonEvent{is_object ? JsonKind::kObject : JsonKind::kArray, key, {}};
  }
  needs_comma_ = true;
  if (!rest_.starts_with('"')) return word(key);
  const auto text = string();
  return text ? std::optional(JsonEvent{JsonKind::kText, key, *text}) : std::nullopt;
}

std::optional<JsonEvent> JsonEvents::word(std::string_view key) {
  const std::string_view word = rest_.substr(0, rest_.find_first_of(",]} \t\r\n"));
  rest_.remove_prefix(word.size());
  if (word == "true") return JsonEvent{JsonKind::kTrue, key, {}};
  if (word == "false") return JsonEvent{JsonKind::kFalse, key, {}};
  if (word == "null") return JsonEvent{JsonKind::kNull, key, {}};
  if (is_number(word)) return JsonEvent{JsonKind::kNumber, key, word};
  return std::nullopt;
}

bool JsonEvents::skip() {
  const std::size_t outside = open_.size() - 1;
  while (open_.size() > outside) {
    if (!next()) return false;
  }
  return true;
}

std::string unescaped(std::string_view text) {
  constexpr std::array<std::pair<char, char>, 5> kEscapes = {
      {{'b', '\b'}, {'f', '\f'}, {'n', '\n'}, {'r', '\r'}, {'t', '\t'}}};
  constexpr unsigned kFirstHalf = 0xd800U, kLastHalf = 0xdfffU, kReplacement = 0xfffdU;
  std::string plain;
  plain.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      plain.push_back(text[i]);
      continue;
    }
    const char c = text[++i];
    if (c == 'u') {
      const auto high = hex_byte_in(text.substr(std::min(i + 1, text.size()), 2));
      const auto low = hex_byte_in(text.substr(std::min(i + 3, text.size()), 2));
      const unsigned code = high && low ? *high << 8U | *low : kReplacement;
      add_utf8(plain, code >= kFirstHalf && code <= kLastHalf ? kReplacement : code);
      i += high && low ? 4 : 0;
      continue;
    }
    const auto* const escape = std::ranges::find(kEscapes, c, [](const auto& known) { return known.first; });
    plain.push_back(escape == kEscapes.end() ? c : escape->second);
  }
  return plain;
}

}  // namespace pingvox
