#include "io/bytes/text.hpp"

#include <charconv>
#include <cmath>

namespace pingvox {
namespace {

template <class T>
std::optional<T> parse(std::string_view text) {
  // from_chars takes a minus but no plus.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  T value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (stop != end || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // Too large is damage; too small is as good as zero.
    if constexpr (sizeof(T) < sizeof(double)) {
      const std::optional<double> wide = parse<double>(text);
      if (wide && std::fabs(*wide) < 1.0) return static_cast<T>(*wide);
    }
    return std::nullopt;
  }
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Lines::Lines(std::string_view text) : rest_(text) {
  if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
}

std::optional<std::string_view> Lines::next() {
  if (rest_.empty()) return std::nullopt;
  ++number_;
  const std::size_t end = rest_.find('\n');
  has_end_ = end != std::string_view::npos;
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(has_end_ ? end + 1 : rest_.size());
  if (line.ends_with('\r')) {
    line.remove_suffix(1);
    has_end_ = true;
  }
  return line;
}

std::optional<std::string_view> Lines::next_with_content() {
  while (const std::optional<std::string_view> line = next()) {
    const std::string_view text = trim(*line);
    if (!text.empty() && !text.starts_with('#')) return line;
  }
  return std::nullopt;
}

std::string_view trim(std::string_view text, std::string_view blanks) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::optional<std::string_view> cut_field(std::string_view& rest, char separator) {
  if (rest.data() == nullptr) return std::nullopt;
  const std::size_t end = rest.find(separator);
  const std::string_view field = rest.substr(0, end);
  rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  return trim(field);
}

std::optional<std::string_view> cut_word(std::string_view& rest) {
  constexpr std::string_view kBetween = " \t,";
  const std::size_t first = rest.find_first_not_of(kBetween);
  if (first == std::string_view::npos) return std::nullopt;
  rest.remove_prefix(first);
  const std::string_view word = rest.substr(0, rest.find_first_of(kBetween));
  rest.remove_prefix(word.size());
  return word;
}

std::string in_ascii(std::string_view text) {
  std::string shown(text);
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  return shown;
}

std::string printable(std::string_view text) {
  constexpr std::size_t kMaxLength = 40;
  return in_ascii(text.substr(0, kMaxLength)) + (text.size() > kMaxLength ? "..." : "");
}

std::optional<double> number_in(std::string_view text) {
  return parse<double>(text);
}
std::optional<float> float_in(std::string_view text) {
  return parse<float>(text);
}
std::optional<std::uint64_t> count_in(std::string_view text) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (text.empty() || stop != end || error != std::errc{}) return std::nullopt;
  return value;
}

std::optional<unsigned> hex_byte_in(std::string_view text) {
  unsigned value = 0;
  const char* const end = text.data() + text.size();
  if (text.size() != 2 || std::from_chars(text.data(), end, value, 16).ptr != end) return std::nullopt;
  return value;
}

}  // namespace pingvox
