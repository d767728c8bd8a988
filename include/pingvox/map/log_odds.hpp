#pragma once

#include <cassert>
#include <cmath>
#include <compare>
#include <cstdint>

namespace pingvox {

/// Belief about one cell, or the evidence of one measurement, as natural log-odds of being occupied (paper, section
/// 5.2, equation 2): negative free, positive occupied, 0 is no evidence. 32 bits, as OctoMap keeps it. Never NaN.
class LogOdds {
 public:
  constexpr LogOdds() = default;
  /// REQUIRES value is not NaN.
  constexpr explicit LogOdds(float value) : value_(value) {}
  /// REQUIRES 0 < p < 1. Rounded as liboctomap's logodds() does.
  static LogOdds from_probability(double p) {
    assert(p > 0.0 && p < 1.0);
    return LogOdds(static_cast<float>(std::log(p / (1.0 - p))));
  }

  constexpr float value() const { return value_; }
  double probability() const { return 1.0 - 1.0 / (1.0 + std::exp(double{value_})); }

  friend constexpr auto operator<=>(LogOdds, LogOdds) = default;

 private:
  float value_ = 0.0F;
};

/// The values between which beliefs are kept, so that a map can change its mind (Hornung et al. 2013, section 3.4).
struct Clamp {
  LogOdds lowest = LogOdds::from_probability(0.1192);
  LogOdds highest = LogOdds::from_probability(0.971);
};

/// Whether `evidence` cannot change `belief`: it is at its clamp in that direction, or the evidence is 0.
constexpr bool is_unchanged_by(LogOdds belief, LogOdds evidence, const Clamp& clamp) {
  return (evidence >= LogOdds(0.0F) && belief >= clamp.highest) ||
         (evidence <= LogOdds(0.0F) && belief <= clamp.lowest) || evidence == LogOdds(0.0F);
}

/// Belief after one more piece of independent evidence: add, then clamp (paper, equation 1 in log-odds).
constexpr LogOdds add_evidence(LogOdds belief, LogOdds evidence, const Clamp& clamp) {
  if (is_unchanged_by(belief, evidence, clamp)) return belief;
  const LogOdds sum(belief.value() + evidence.value());
  return sum < clamp.lowest ? clamp.lowest : (sum > clamp.highest ? clamp.highest : sum);
}

enum class Occupancy : std::uint8_t { kUnknown, kFree, kOccupied };

/// The paper's classification (section 5.2): occupied from `upper` on, free below `lower`, in between
/// undecided. With both at 0 (the default) it is liboctomap's single threshold of probability 0.5.
struct Thresholds {
  LogOdds lower{0.0F};
  LogOdds upper{0.0F};
};

constexpr Occupancy classify(LogOdds belief, const Thresholds& thresholds = {}) {
  if (belief >= thresholds.upper) return Occupancy::kOccupied;
  return belief < thresholds.lower ? Occupancy::kFree : Occupancy::kUnknown;
}

}  // namespace pingvox
