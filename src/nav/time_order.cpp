#include "pingvox/nav/time_order.hpp"

#include <algorithm>

#include "base/median.hpp"

namespace pingvox {
namespace {

double size_s(const ClockStep& step) {
  return step.from_s - step.to_s;
}

/// @param behind   samples behind the latest one
/// @param goes_on  whether the next one is in time again
std::optional<ClockStep> with(const std::optional<ClockStep>& step_back, const ClockStep& behind, bool goes_on) {
  if (behind.late == 0 || (goes_on && size_s(behind) <= kMaxSwapped_s)) return step_back;
  if (!step_back) return behind;
  ClockStep greatest = size_s(behind) > size_s(*step_back) ? behind : *step_back;
  greatest.late = behind.late + step_back->late;
  return greatest;
}

}  // namespace

void TimeOrder::add(double time_s) {
  if (time_s > latest_s_) {
    // The times of a clock that was set back come up to the latest one step by step.
    const bool goes_on = behind_.late > 0 && latest_s_ - recent_s_.back() > kMaxLate_s && has_left_room();
    step_back_ = with(step_back_, behind_, goes_on);
    behind_ = {};
    before_latest_s_ = latest_s_;
    latest_s_ = time_s;
  }
  if (recent_s_.size() == kRecent) recent_s_.erase(recent_s_.begin(), recent_s_.begin() + kRecent / 2);
  recent_s_.push_back(time_s);
  if (!(latest_s_ - time_s > kMaxLate_s)) return;
  ++late_;
  ++behind_.late;
  behind_.to_s = behind_.late == 1 ? time_s : std::min(behind_.to_s, time_s);
  behind_.from_s = latest_s_;
}

std::optional<ClockStep> TimeOrder::step_back() const {
  // One at the end may have been swapped with those before it; of several the clock stays back.
  return with(step_back_, behind_, behind_.late == 1);
}

/// Median step of the last times in order.
double TimeOrder::usual_step_s() const {
  std::vector<double> sorted_s = recent_s_, steps_s;
  std::ranges::sort(sorted_s);
  for (std::size_t i = 1; i < sorted_s.size(); ++i) steps_s.push_back(sorted_s[i] - sorted_s[i - 1]);
  return steps_s.empty() ? 0.0 : median(std::move(steps_s));
}

/// Whether the latest one came early for a device whose steps are long: in the place of those that are late.
bool TimeOrder::has_left_room() const {
  constexpr double kSteps = 1.5;
  const double step_s = usual_step_s();
  return step_s <= kMaxLate_s || latest_s_ - before_latest_s_ >= kSteps * step_s;
}

}  // namespace pingvox
