#include "nav/time_checks.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

namespace pingvox {
namespace {

/// Whether the quantity changes too quickly to be measured every minute.
bool is_measured_often(NavQuantity quantity) {
  return quantity == NavQuantity::kAttitude || quantity == NavQuantity::kHeading ||
         quantity == NavQuantity::kTurnRate || quantity == NavQuantity::kVelocity;
}

/// Of times since 1970 that are too large to be in seconds.
std::string_view unit_of_date(double time_s) {
  constexpr double kLastMilliseconds = 1e14, kLastMicroseconds = 1e17;
  return time_s < kLastMilliseconds ? "ms" : time_s < kLastMicroseconds ? "us" : "ns";
}

/// Of steps between samples that are too large to be in seconds.
std::string_view unit_of_step(double step_s) {
  constexpr double kLastMilliseconds = 9e3, kLastMicroseconds = 9e6;
  return step_s < kLastMilliseconds ? "ms" : step_s < kLastMicroseconds ? "us" : "ns";
}

}  // namespace

void check_times(NavSource& source) {
  // The latest time is in the year 5138. Ten samples a second, in ms, are a hundred seconds apart.
  constexpr double kRare_s = 10.0, kTooRare_s = 30.0, kTooLate_s = 1e11, kFastest_hz = 20'000.0;
  constexpr std::size_t kMinSamples = 10, kNoBurst = 40;
  if (!source.fault.empty() || source.samples.empty()) return;
  const NavSummary summary = summary_of(source);
  if (summary.from_s >= kTooLate_s) {
    source.fault = fmt::format("its times begin at {:.6g} s, thousands of years after 1970: are they in {}?",
                               summary.from_s, unit_of_date(summary.from_s));
    return;
  }
  if (summary.samples < kMinSamples || !(summary.rate_hz > 0.0)) return;
  const double mean_hz = static_cast<double>(summary.samples) / (summary.to_s - summary.from_s);
  if (mean_hz > kFastest_hz && summary.samples >= kNoBurst) {
    source.fault = fmt::format("it has {:.3g} samples in a second: are its times in hours or days?", mean_hz);
    return;
  }
  const double step_s = 1.0 / summary.rate_hz;
  if (!is_measured_often(source.quantity) || step_s < kRare_s) return;
  const std::string text =
      fmt::format("it has a sample every {:.3g} s: are its times in {}?", step_s, unit_of_step(step_s));
  if (step_s >= kTooRare_s) {
    source.fault = text;
  } else if (source.doubt.empty()) {
    source.doubt = text;
  }
}

}  // namespace pingvox
