#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "pingvox/limits.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Collects what is wrong with an options struct, so that one message names every broken field.
class OptionErrors {
 public:
  void add(std::string_view text) { texts_ += texts_.empty() ? fmt::format(" {}", text) : fmt::format("; {}", text); }

  /// What is wrong with options that are a part of these, if anything is.
  void add(const Result<void>& part) {
    if (!part) add(part.error().message);
  }

  /// "NAME must be RULE, is VALUE", unless it holds.
  template <class Value>
  void require(bool holds, std::string_view name, std::string_view rule, const Value& value) {
    if (!holds) add(fmt::format("{} must be {}, is {}", name, rule, value));
  }

  /// "NAME must be in LOW..HIGH, is VALUE", unless it is. NaN is not.
  template <class Value>
  void require_within(std::string_view name, Value value, std::type_identity_t<Value> low,
                      std::type_identity_t<Value> high) {
    if (!(value >= low && value <= high)) add(fmt::format("{} must be in {}..{}, is {}", name, low, high, value));
  }

  /// "FIELD must be LIMITS, is NUMBER", unless they contain it.
  /// @param number  a field of the options, by which limits_of() knows it
  template <class Number>
  void require(std::string_view field, const Number& number, const Limits& limits) {
    if (limits.contain(static_cast<double>(number))) return;
    require(false, field, limits.text(), number);
    limits_.emplace_back(&number, limits);
  }

  /// The limits that a field of the options is not within; nullopt: it is, or its rule is another.
  std::optional<Limits> limits_of(const void* field) const {
    for (const auto& [broken, limits] : limits_) {
      if (broken == field) return limits;
    }
    return std::nullopt;
  }

  /// kBadOption, "STAGE: TEXT; TEXT", if there is any.
  Result<void> result(std::string_view stage) const {
    if (texts_.empty()) return {};
    return fail(Error::Code::kBadOption, fmt::format("{}:{}", stage, texts_));
  }

 private:
  std::string texts_;
  std::vector<std::pair<const void*, Limits>> limits_;
};

}  // namespace pingvox
