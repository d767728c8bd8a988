#pragma once

#include <string_view>
#include <vector>

#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "slam/internal/picture_turns.hpp"
#include "slam/sweeps/sweep_echoes.hpp"

namespace pingvox {

/// What was added of a recording: the echoes of its sweeps, how the sonar's picture turned, and its navigation on the
/// clock of the beams.
class SlamData {
 public:
  /// REQUIRES valid options.
  explicit SlamData(SlamOptions options);

  void add(Beam beam);
  Result<void> add(std::string_view source, NavQuantity quantity, const NavSample& sample);
  Result<void> add(const NavLog& log);

  const SlamOptions& options() const { return options_; }
  const PictureTurns& turns() const { return turns_; }  ///< none where no echoes are matched
  const std::vector<double>& beam_times_s() const { return beam_times_s_; }
  const std::vector<NavSource>& sources() const { return sources_; }
  /// With what there is of the last. @return kUnsupported without beams; kCorrupt when their times do not rise
  Result<std::vector<SweepEchoes>> sweeps() const;

 private:
  SlamOptions options_;
  SweepAssembler assembler_;
  PictureTurns turns_;
  std::vector<double> beam_times_s_;
  std::vector<SweepEchoes> sweeps_;
  std::vector<NavSource> sources_;
};

}  // namespace pingvox
