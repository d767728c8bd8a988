#include "option_values.hpp"

#include <limits>

namespace pingvox::app {

Result<std::size_t> bytes_from(std::string_view text) {
  constexpr std::string_view kUnits = "KMGT";
  std::string_view digits = text;
  unsigned shift = 0;
  if (!digits.empty()) {
    const char unit =
        digits.back() >= 'a' && digits.back() <= 'z' ? static_cast<char>(digits.back() - 'a' + 'A') : digits.back();
    if (const std::size_t power = kUnits.find(unit); power != std::string_view::npos) {
      shift = 10 * (static_cast<unsigned>(power) + 1);
      digits.remove_suffix(1);
    }
  }
  const Result<std::size_t> count = number_from<std::size_t>(digits);
  if (!count) return usage_error(fmt::format("'{}' is not a number of bytes, as in 512M or 2G", text));
  if (*count > std::numeric_limits<std::size_t>::max() >> shift)
    return usage_error(fmt::format("'{}' is out of range", text));
  return *count << shift;
}

Take within(const Limits& limits, Take take) {
  return [limits, take = std::move(take)](const std::string& text) -> Result<void> {
    if (auto taken = take(text); !taken) return taken;
    const Result<double> value = number_from<double>(text);
    if (value && !limits.contain(*value)) return usage_error(fmt::format("must be {}, is {}", limits.text(), text));
    return {};
  };
}

Take store(std::string& target) {
  return [&target](const std::string& text) -> Result<void> {
    if (text.empty()) return usage_error("is empty");
    target = text;
    return {};
  };
}

Take store(std::optional<std::string>& target) {
  return [&target](const std::string& text) -> Result<void> {
    if (text.empty()) return usage_error("is empty");
    target = text;
    return {};
  };
}

Take store_each(Args& targets) {
  return [&targets](const std::string& text) -> Result<void> {
    if (text.empty()) return usage_error("is empty");
    targets.push_back(text);
    return {};
  };
}

Take store_probability(LogOdds& target) {
  return [&target](const std::string& text) -> Result<void> {
    const Result<double> value = number_from<double>(text);
    if (!value) return tl::unexpected(value.error());
    if (!(*value > 0.0 && *value < 1.0))
      return usage_error(fmt::format("{} is not a probability between 0 and 1", text));
    target = LogOdds::from_probability(*value);
    return {};
  };
}

Take store_bytes(std::size_t& target) {
  return [&target](const std::string& text) -> Result<void> {
    const Result<std::size_t> bytes = bytes_from(text);
    if (!bytes) return tl::unexpected(bytes.error());
    if (*bytes == 0) return usage_error("must be more than 0");
    target = *bytes;
    return {};
  };
}

std::string number_text(double value) {
  return fmt::format("{:.6g}", value);
}

double size_of_unit(std::string_view unit) {
  return unit == "DEG" || unit == "DEG/S" ? kDegree_rad : 1.0;
}

Option only_with(std::vector<Condition> conditions, Option option) {
  option.only_with = std::move(conditions);
  return option;
}

}  // namespace pingvox::app
