#include "pingvox/nav/live_poses.hpp"

#include <algorithm>
#include <cmath>

#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox {
namespace {

constexpr double kKept_s = 60.0, kToDecide_s = 1.0;
/// Around a time, enough to tell a gap from the usual step.
constexpr double kAround_s = 5.0;

NavSource source_around(const std::string& name, NavQuantity quantity, const std::vector<NavSample>& samples,
                        double time_s) {
  const auto from = std::ranges::lower_bound(samples, time_s - kAround_s, {}, &NavSample::time_s);
  const auto to = std::ranges::upper_bound(samples, time_s + kAround_s, {}, &NavSample::time_s);
  return {name, quantity, std::vector<NavSample>(from, to)};
}

}  // namespace

void LivePoses::add(const std::string& source, NavQuantity quantity, const NavSample& sample) {
  if (!sample.valid || !sample.value.allFinite() || !std::isfinite(sample.time_s)) return;
  NavSample kept = sample;
  switch (quantity) {
    case NavQuantity::kDepth:
      depth_m_ = sample.value.x();
      return;
    case NavQuantity::kFix:
      if (!first_fix_) first_fix_ = sample.value;
      kept.value = position_of_fix(sample.value, *first_fix_);
      if (depth_m_) kept.value.z() = -*depth_m_;
      quantity = NavQuantity::kPosition;
      break;
    case NavQuantity::kAttitude:
    case NavQuantity::kPosition:
      break;
    default:
      return;
  }
  const bool is_decided = !position_.empty();
  if (is_decided && source != (quantity == NavQuantity::kAttitude ? attitude_ : position_)) return;
  std::vector<NavSample>& samples = samples_[{source, quantity}];
  if (!samples.empty() && !(kept.time_s > samples.back().time_s)) return;
  samples.push_back(kept);
  // Now and then, so that each sample is moved a few times at most.
  if (kept.time_s - samples.front().time_s > 2.0 * kKept_s) {
    std::erase_if(samples, [&](const NavSample& old) { return old.time_s < kept.time_s - kKept_s; });
  }
  if (!is_decided) decide();
}

bool LivePoses::has(NavQuantity quantity) const {
  return std::ranges::any_of(samples_, [&](const auto& of) { return of.first.second == quantity; });
}

void LivePoses::decide() {
  const auto is_long = [](const auto& of) { return of.second.back().time_s - of.second.front().time_s >= kToDecide_s; };
  const auto has_long = [&](NavQuantity quantity) {
    return std::ranges::any_of(samples_, [&](const auto& of) { return of.first.second == quantity && is_long(of); });
  };
  if (!has_long(NavQuantity::kAttitude) || !has_long(NavQuantity::kPosition)) return;
  std::vector<NavSource> sources;
  for (const auto& of : samples_) {
    const auto& [name, quantity] = of.first;
    // The attitude of a position's own source counts however short it is: of one report the position may come first.
    const auto own = samples_.find({name, NavQuantity::kPosition});
    const bool has_position = own != samples_.end() && is_long(*own);
    if (is_long(of) || has_position) sources.push_back({name, quantity, of.second});
  }
  const Result<NavLog> log = NavLog::make(std::move(sources), NavClock::kUnknown);
  if (!log) return;
  const Result<NavTrajectory> trajectory = nav_trajectory(*log);
  if (!trajectory) return;
  attitude_ = trajectory->attitude;
  position_ = trajectory->position;
  std::erase_if(samples_, [&](const auto& of) {
    return of.first.first != (of.first.second == NavQuantity::kAttitude ? attitude_ : position_);
  });
}

std::optional<Pose> LivePoses::at(double time_s) const {
  if (position_.empty()) return std::nullopt;
  std::vector<NavSource> sources;
  for (const auto& [name, samples] : samples_) {
    sources.push_back(source_around(name.first, name.second, samples, time_s));
  }
  const Result<NavLog> log = NavLog::make(std::move(sources), NavClock::kUnknown);
  if (!log) return std::nullopt;
  const Result<NavTrajectory> trajectory = nav_trajectory(*log);
  return trajectory ? trajectory->trajectory.at(time_s) : std::nullopt;
}

std::optional<double> LivePoses::known_until_s() const {
  if (position_.empty()) return std::nullopt;
  double until_s = samples_.begin()->second.back().time_s;
  for (const auto& [name, samples] : samples_) until_s = std::min(until_s, samples.back().time_s);
  return until_s;
}

}  // namespace pingvox
