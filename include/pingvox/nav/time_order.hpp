#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace pingvox {

/// How late a sample may come [s]: devices that share a line, and programs with queues, mix the order up by less.
inline constexpr double kMaxLate_s = 1.0;
/// How late it may come where the next ones are in time again, as when messages were swapped: a clock that was set back
/// stays back.
inline constexpr double kMaxSwapped_s = 3.0;

/// A clock that was set back while samples came.
struct ClockStep {
  double from_s = 0.0, to_s = 0.0;  ///< the latest time until then, and that of the sample farthest behind it
  std::size_t late = 0;             ///< samples that are more than kMaxLate_s behind one that came before
};

/// Distinguishes swapped messages from a clock that was set back, by times in the order in which they came.
class TimeOrder {
 public:
  void add(double time_s);

  /// How many were more than kMaxLate_s behind one that came before.
  std::size_t late() const { return late_; }
  /// Where the clock was set back by most. nullopt: it was not; those that were late were swapped with others.
  std::optional<ClockStep> step_back() const;

 private:
  double usual_step_s() const;
  bool has_left_room() const;

  static constexpr std::size_t kRecent = 512;

  std::vector<double> recent_s_;  ///< at most kRecent
  double latest_s_ = -std::numeric_limits<double>::infinity(), before_latest_s_ = latest_s_;
  ClockStep behind_;  ///< of those since the latest one
  std::size_t late_ = 0;
  std::optional<ClockStep> step_back_;  ///< until the latest one
};

}  // namespace pingvox
