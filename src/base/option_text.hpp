#pragma once

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

#include "base/suggest.hpp"
#include "pingvox/result.hpp"

/// Numbers and words of options, as they are typed and as they stand in files.
namespace pingvox {

/// All of the text as a number, independent of the locale. kBadOption: it is none, or NaN.
template <class Number>
Result<Number> number_from(std::string_view text) {
  std::string_view digits = text;
  if (digits.size() > 1 && digits.front() == '+' && digits[1] != '-') digits.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  constexpr bool kReal = std::is_floating_point_v<Number>;
  if (error == std::errc::result_out_of_range)
    return fail(Error::Code::kBadOption, fmt::format("'{}' is out of range", text));
  if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty()) {
    return fail(Error::Code::kBadOption, fmt::format("'{}' is not a {}", text, kReal ? "number" : "whole number"));
  }
  if constexpr (kReal) {
    if (std::isnan(value)) return fail(Error::Code::kBadOption, fmt::format("'{}' is not a number", text));
  }
  return value;
}

/// Numbers with commas between them.
template <std::size_t N>
Result<std::array<double, N>> numbers_from(std::string_view text) {
  std::array<double, N> values{};
  std::size_t count = 0;
  for (std::string_view rest = text;; ++count) {
    const std::size_t comma = rest.find(',');
    if (count < N) {
      const Result<double> value = number_from<double>(rest.substr(0, comma));
      if (!value) return tl::unexpected(value.error());
      values[count] = *value;
    }
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (count + 1 != N)
    return fail(Error::Code::kBadOption, fmt::format("'{}': must be {} numbers with commas between them", text, N));
  return values;
}

/// A word that an option accepts, and its value.
template <class Enum>
struct Choice {
  std::string_view word;
  Enum value;
};

/// The value of a word; kBadOption names the words.
template <class Enum, std::size_t N>
Result<Enum> choice_value(const std::array<Choice<Enum>, N>& words, const std::string& text) {
  std::vector<std::string> known;
  for (const auto& word : words) {
    if (word.word == text) return word.value;
    known.emplace_back(word.word);
  }
  return fail(Error::Code::kBadOption,
              fmt::format("must be {}, not '{}'{}", fmt::join(known, " or "), text, did_you_mean(text, known)));
}

}  // namespace pingvox
