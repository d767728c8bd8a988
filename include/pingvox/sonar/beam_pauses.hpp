#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace pingvox {

/// Steps from beam to beam that are far longer than the others: the head stood still, or beams were lost.
struct BeamPauses {
  std::size_t count = 0;
  double median_s = 0.0, longest_s = 0.0, total_s = 0.0;
};

/// Finds the pauses of a recording from the times of its beams. Keeps 8 bytes for each step of a second and more.
class BeamPauseCounter {
 public:
  /// Beams in the order of recording; one before the newest is late and makes no pause.
  void add(double time_s);

  /// Steps of at least a second that are ten times as long as the mean of the shorter ones.
  BeamPauses pauses() const;

 private:
  static constexpr double kShortestPause_s = 1.0;

  std::size_t steps_ = 0;  ///< shorter than kShortestPause_s
  double steps_s_ = 0.0;   ///< their sum
  double newest_s_ = std::numeric_limits<double>::infinity();
  std::vector<double> long_steps_s_;  ///< of at least kShortestPause_s
};

}  // namespace pingvox
