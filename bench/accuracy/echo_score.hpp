#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "accuracy/true_returns.hpp"
#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox::bench {

/// Limits for scoring echoes. An echo farther than `false_m` from the ground truth is false.
struct EchoJudge {
  double bin_length_m = 0.0;
  double min_range_m = 0.0;  ///< blanking range; nearer surfaces are ignored
  double range_m = 0.0;      ///< to the end of the bins

  static constexpr double kFalse_m = 0.10;
};

/// Counts of the beams that have one kind of ground truth. within_10cm + missed + wrong == beams.
struct EchoCounts {
  std::size_t beams = 0;
  std::size_t within_1_bin = 0, within_2_bins = 0, within_5cm = 0, within_10cm = 0;
  std::size_t missed = 0;  ///< no echo
  std::size_t wrong = 0;   ///< an echo more than 10 cm off
};

struct EchoScore {
  std::size_t beams = 0, echoes = 0;
  EchoCounts axis;     ///< compared with the first surface on the beam's axis, as a plane map needs
  EchoCounts returns;  ///< compared with the nearest surface in line of sight within the cone
  std::size_t silent_beams = 0,
              silent_echoes = 0;  ///< no surface in the cone within range; of these, beams with an echo
  /// False echoes within 10 cm of a surface that is only in the main lobe beyond the cone.
  std::size_t beyond_cone = 0;
  std::size_t late = 0;     ///< echoes more than 10 cm behind the first return
  double chance_5cm = 0.0;  ///< mean fraction of the range that lies within 5 cm of a return

  std::size_t false_echoes() const { return returns.wrong + silent_echoes; }
};

/// REQUIRES one optional echo for each beam.
EchoScore score_echoes(std::span<const std::optional<Echo>> echoes, std::span<const TrueReturns> truths,
                       const EchoJudge& judge);

}  // namespace pingvox::bench
