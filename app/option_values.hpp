#pragma once

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/option_errors.hpp"
#include "base/option_text.hpp"
#include "option_table.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/limits.hpp"
#include "pingvox/map/log_odds.hpp"
#include "pingvox/result.hpp"

/// Parses values of options (independent of the locale, all of the text) into their targets.
namespace pingvox::app {

using Args = std::vector<std::string>;

/// Invalid usage: kBadOption.
inline tl::unexpected<Error> usage_error(std::string what) {
  return fail(Error::Code::kBadOption, std::move(what));
}

/// A number of bytes, optionally with suffix K, M, G or T.
Result<std::size_t> bytes_from(std::string_view text);

/// Any non-empty text.
Take store(std::string& target);
Take store(std::optional<std::string>& target);
/// Any non-empty text, appended to what was given before.
Take store_each(Args& targets);

/// A number of any kind; typed in units of `unit`.
template <class Number>
Take store_number(Number& target, Number unit = Number{1}) {
  return [&target, unit](const std::string& text) -> Result<void> {
    const Result<Number> value = number_from<Number>(text);
    if (!value) return tl::unexpected(value.error());
    target = static_cast<Number>(*value * unit);
    return {};
  };
}

template <class Number>
Take store_optional(std::optional<Number>& target) {
  return [&target](const std::string& text) -> Result<void> {
    const Result<Number> value = number_from<Number>(text);
    if (!value) return tl::unexpected(value.error());
    target = *value;
    return {};
  };
}

/// Of cells [m].
inline constexpr Limits kResolutions{0.0, 1000.0, Limits::Ends::kLowOut};

inline constexpr Limits kProbabilities{0.0, 1.0, Limits::Ends::kBothOut};
inline constexpr Limits kPositive{0.0, std::numeric_limits<double>::infinity(), Limits::Ends::kBothOut};
inline constexpr Limits kFinite{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                                Limits::Ends::kBothOut};

/// Limits of the library in units of the command line.
inline Limits in_units_of(double unit, const Limits& limits) {
  return {limits.low / unit, limits.high / unit, limits.ends};
}

/// Refuses numbers outside of the limits, then calls `take`, which also refuses other text.
Take within(const Limits& limits, Take take);

/// A default as text.
std::string number_text(double value);

/// How much of the library's unit one of the command line is: DEG and DEG/S are typed, radians are stored.
double size_of_unit(std::string_view unit);

/// An option that is a number in `unit`. `target` holds the default.
template <class Number>
Option number(std::string name, std::string unit, std::string help, Number& target) {
  const double size = size_of_unit(unit);
  std::string standard = number_text(static_cast<double>(target) / size);
  return {std::move(name),     0,
          std::move(unit),     std::move(help),
          std::move(standard), store_number(target, static_cast<Number>(size))};
}

/// The same for a field of `options`, whose errors() know its limits.
template <class Options, class Number>
Option number(std::string name, std::string unit, std::string help, Options& options, Number& field) {
  Option option = number(std::move(name), std::move(unit), std::move(help), field);
  option.take = [&options, &field, take = option.take,
                 size = size_of_unit(option.value)](const std::string& text) -> Result<void> {
    if (auto taken = take(text); !taken) return taken;
    const auto limits = options.errors().limits_of(&field);
    if (limits) return usage_error(fmt::format("must be {}, is {}", limits->text(size), text));
    return {};
  };
  return option;
}

Take store_probability(LogOdds& target);
/// At least one byte.
Take store_bytes(std::size_t& target);

/// The words separated by |, for the help.
template <class Enum, std::size_t N>
std::string choices_text(const std::array<Choice<Enum>, N>& words) {
  std::string out;
  for (const auto& word : words) out += fmt::format("{}{}", out.empty() ? "" : "|", word.word);
  return out;
}

template <class Enum, std::size_t N>
std::string choice_name(const std::array<Choice<Enum>, N>& words, Enum value) {
  for (const auto& word : words) {
    if (word.value == value) return std::string(word.word);
  }
  return {};
}

/// An option that accepts one of `words`, which must outlive it. `target` holds the default.
template <class Enum, std::size_t N>
Option choice(std::string name, const std::array<Choice<Enum>, N>& words, std::string help, Enum& target) {
  const Take take = [&target, &words](const std::string& text) -> Result<void> {
    const Result<Enum> value = choice_value(words, text);
    if (!value) return tl::unexpected(value.error());
    target = *value;
    return {};
  };
  return {std::move(name), 0, choices_text(words), std::move(help), choice_name(words, target), take};
}

/// The same for a target without a value, which `standard` describes.
template <class Enum, std::size_t N>
Option choice(std::string name, const std::array<Choice<Enum>, N>& words, std::string help, std::optional<Enum>& target,
              std::string standard) {
  const Take take = [&target, &words](const std::string& text) -> Result<void> {
    const Result<Enum> value = choice_value(words, text);
    if (!value) return tl::unexpected(value.error());
    target = *value;
    return {};
  };
  return {std::move(name), 0, choices_text(words), std::move(help), std::move(standard), take};
}

/// An option without a value: sets `target` to `value`.
template <class Enum>
Option flag(std::string name, std::string help, Enum& target, Enum value) {
  const Take take = [&target, value](const std::string&) -> Result<void> {
    target = value;
    return {};
  };
  return {std::move(name), 0, "", std::move(help), "", take};
}

/// An option with an effect only if one of `conditions` holds.
Option only_with(std::vector<Condition> conditions, Option option);

}  // namespace pingvox::app
