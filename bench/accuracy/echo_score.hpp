#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "accuracy/true_returns.hpp"
#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox::bench {

/// How echoes are held against the truth. An echo that is farther from it than `false_m` is false.
struct EchoJudge {
  double bin_length_m = 0.0;
  double min_range_m = 0.0;  ///< what lies nearer is in the blanking: it cannot be heard
  double range_m = 0.0;      ///< to the end of the bins

  static constexpr double kFalse_m = 0.10;
};

/// Beams counted against one kind of truth: those that have it. within_10cm + missed + wrong == beams.
struct EchoCounts {
  std::size_t beams = 0;
  std::size_t within_1_bin = 0, within_2_bins = 0, within_5cm = 0, within_10cm = 0;
  std::size_t missed = 0;  ///< no echo
  std::size_t wrong = 0;   ///< an echo more than 10 cm off
};

struct EchoScore {
  std::size_t beams = 0, echoes = 0;
  EchoCounts axis;     ///< against the first surface on the beam's axis: what a map in the plane needs
  EchoCounts returns;  ///< against the nearest surface in line of sight within the cone: what can come back
  std::size_t silent_beams = 0, silent_echoes = 0;  ///< nothing in the cone within range, and yet an echo
  /// Of the false echoes, those within 10 cm of a surface that only the main lobe beyond the cone hears.
  std::size_t beyond_cone = 0;
  std::size_t late = 0;     ///< echoes more than 10 cm behind the first return
  double chance_5cm = 0.0;  ///< mean share of the ranges listened to that lie within 5 cm of a return

  std::size_t false_echoes() const { return returns.wrong + silent_echoes; }
};

/// One optional echo for each beam of a truth. REQUIRES as many of each.
EchoScore score_echoes(std::span<const std::optional<Echo>> echoes, std::span<const TrueReturns> truths,
                       const EchoJudge& judge);

}  // namespace pingvox::bench
