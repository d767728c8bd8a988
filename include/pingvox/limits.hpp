#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace pingvox {

/// The numbers that an option may be. NaN is none.
struct Limits {
  enum class Ends { kIn, kLowOut, kHighOut, kBothOut };
  double low = 0.0, high = 1.0;
  Ends ends = Ends::kIn;

  bool has_low() const { return ends == Ends::kIn || ends == Ends::kHighOut; }
  bool has_high() const { return ends == Ends::kIn || ends == Ends::kLowOut; }
  bool contain(double value) const {
    return (has_low() ? value >= low : value > low) && (has_high() ? value <= high : value < high);
  }

  /// "0..1", "above 0 and at most 100"; of numbers in units of `unit`.
  std::string text(double unit = 1.0) const {
    const double from = low / unit, to = high / unit;
    if (std::isfinite(to) && ends == Ends::kIn) return fmt::format("{:.6g}..{:.6g}", from, to);
    if (!std::isfinite(from) && !std::isfinite(to)) return "finite";
    const std::string above = fmt::format("{} {:.6g}", has_low() ? "at least" : "above", from);
    if (!std::isfinite(to)) return above + (has_high() ? "" : " and finite");
    return fmt::format("{} and {} {:.6g}", above, has_high() ? "at most" : "below", to);
  }
};

}  // namespace pingvox
