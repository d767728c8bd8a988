#include "nav/internal/live_poses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nav/plausible_values.hpp"
#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox {
namespace {

constexpr double kKept_s = 60.0, kToDecide_s = 1.0;
/// Around a time, enough to tell a gap from the usual step.
constexpr double kAround_s = 5.0;
/// As in summary_of: a shorter step is no gap, whatever is usual.
constexpr double kNoGap_s = 0.5;

/// How long a step between samples around a time is at the most that is no gap.
double longest_step_around(const std::vector<NavSample>& samples, double time_s) {
  const auto from = std::ranges::lower_bound(samples, time_s - kAround_s, {}, &NavSample::time_s);
  const auto to = std::ranges::upper_bound(samples, time_s + kAround_s, {}, &NavSample::time_s);
  NavSource source;
  source.samples.assign(from, to);
  return summary_of(source).longest_step_s;
}

Pose pose_of(NavQuantity quantity, const NavSample& sample) {
  if (quantity == NavQuantity::kPosition) return Pose(Eigen::Translation3d(sample.value));
  return pose_from_rpy(Eigen::Vector3d::Zero(), sample.value.x(), sample.value.y(), sample.value.z());
}

Pose pose_between(NavQuantity quantity, const NavSample& before, const NavSample& after, double time_s) {
  if (time_s == before.time_s) return pose_of(quantity, before);
  if (time_s == after.time_s) return pose_of(quantity, after);
  return interpolate(pose_of(quantity, before), pose_of(quantity, after),
                     (time_s - before.time_s) / (after.time_s - before.time_s));
}

}  // namespace

void LivePoses::add(const std::string& source, NavQuantity quantity, const NavSample& sample) {
  if (!sample.valid || !sample.value.allFinite() || !std::isfinite(sample.time_s)) return;
  if (!is_possible(quantity, sample.value)) return;
  NavSample kept = sample;
  switch (quantity) {
    case NavQuantity::kDepth:
      add_depth(source, sample);
      return;
    case NavQuantity::kFix:
      if (!first_fix_) first_fix_ = sample.value;
      kept.value = position_of_fix(sample.value, *first_fix_);
      if (depth_m_) kept.value.z() = -*depth_m_;
      break;
    case NavQuantity::kAttitude:
    case NavQuantity::kPosition:
      break;
    default:
      return;
  }
  const Name name{source, quantity == NavQuantity::kAttitude ? quantity : NavQuantity::kPosition};
  const bool is_decided = !position_.empty();
  if (is_decided && source != (quantity == NavQuantity::kAttitude ? attitude_ : position_)) return;
  const auto [stream, is_new] = streams_.try_emplace(name, quantity);
  if (!is_new && !(kept.time_s > stream->second.last_s)) return;
  add_to(name, stream->second, kept, pose_by(quantity, sample, first_fix_.value_or(sample.value)));
  if (!is_decided) decide();
}

void LivePoses::add_to(const Name& name, Stream& stream, const NavSample& sample, const SamplePose& pose) {
  stream.last_s = sample.time_s;
  std::vector<NavSample>& samples = stream.samples;
  switch (stream.filter.add(sample, pose)) {
    case StepFilter::Verdict::kHeld:
      return;
    case StepFilter::Verdict::kNewFrame: {
      stream.cuts_s.push_back(samples.back().time_s);
      const std::vector<NavSample>& held = stream.filter.held();
      samples.insert(samples.end(), held.begin(), held.end());
      note_new_frame(name, stream.filter.step());
      break;
    }
    case StepFilter::Verdict::kGood:
      samples.push_back(sample);
      break;
  }
  // Now and then, so that each sample is moved a few times at most.
  if (sample.time_s - samples.front().time_s > 2.0 * kKept_s) {
    const double from_s = sample.time_s - kKept_s;
    std::erase_if(samples, [&](const NavSample& old) { return old.time_s < from_s; });
    std::erase_if(stream.cuts_s, [&](double cut_s) { return cut_s < from_s; });
  }
  if (!stream.is_long && samples.back().time_s - samples.front().time_s >= kToDecide_s) {
    stream.is_long = true;
    ++(name.second == NavQuantity::kAttitude ? long_attitudes_ : long_positions_);
  }
}

void LivePoses::add_depth(const std::string& source, const NavSample& sample) {
  const auto [found, is_new] = depths_.try_emplace(source, NavQuantity::kDepth);
  Stream& depth = found->second;
  if (!is_new && sample.time_s < depth.last_s) return;
  depth.last_s = sample.time_s;
  const StepFilter::Verdict verdict = depth.filter.add(sample, pose_by(NavQuantity::kDepth, sample, sample.value));
  if (verdict == StepFilter::Verdict::kHeld) return;
  depth_m_ = sample.value.x();
  if (verdict == StepFilter::Verdict::kGood || !first_fix_) return;
  for (auto& [name, stream] : streams_) {
    if (name.second == NavQuantity::kPosition) stream.cuts_s.push_back(stream.samples.back().time_s);
  }
  note_new_frame({source, NavQuantity::kDepth}, depth.filter.step());
}

void LivePoses::note_new_frame(const Name& name, const SourceStep& step) {
  if (!position_.empty()) new_frames_.push_back({name.first, name.second, step});
}

std::size_t LivePoses::outliers() const {
  std::size_t outliers = 0;
  for (const auto& [name, stream] : streams_) outliers += stream.filter.outliers();
  return outliers;
}

bool LivePoses::has(NavQuantity quantity) const {
  return std::ranges::any_of(streams_, [&](const auto& of) { return of.first.second == quantity; });
}

void LivePoses::decide() {
  // Looking at all sources for each sample takes too long where somebody sends as many as there are numbers for them.
  if (long_attitudes_ == 0 || long_positions_ == 0) return;
  if (until_decision_ > 0) {
    --until_decision_;
    return;
  }
  until_decision_ = streams_.size() / 4;
  std::vector<NavSource> sources;
  for (const auto& [of, stream] : streams_) {
    const auto& [name, quantity] = of;
    // The attitude of a position's own source counts however short it is: of one report the position may come first.
    const auto own = streams_.find({name, NavQuantity::kPosition});
    const bool has_position = own != streams_.end() && own->second.is_long;
    if (stream.is_long || has_position) sources.push_back({name, quantity, stream.samples});
  }
  const Result<NavLog> log = NavLog::make(std::move(sources), NavClock::kUnknown);
  if (!log) return;
  const Result<NavTrajectory> trajectory = nav_trajectory(*log);
  if (!trajectory) return;
  attitude_ = trajectory->attitude;
  position_ = trajectory->position;
  std::erase_if(streams_, [&](const auto& of) {
    return of.first.first != (of.first.second == NavQuantity::kAttitude ? attitude_ : position_);
  });
}

std::optional<LivePoses::Around> LivePoses::around(const Stream& stream, double time_s) {
  const std::vector<NavSample>& samples = stream.samples;
  const auto after = std::ranges::lower_bound(samples, time_s, {}, &NavSample::time_s);
  if (after == samples.end() || std::isnan(time_s)) return std::nullopt;
  if (after->time_s == time_s) return Around{&*after, &*after};
  if (after == samples.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const auto is_between = [&](double cut_s) { return cut_s >= before->time_s && cut_s < after->time_s; };
  if (std::ranges::any_of(stream.cuts_s, is_between)) return std::nullopt;
  if (before->time_s < time_s - kAround_s || after->time_s > time_s + kAround_s) return std::nullopt;
  const double step_s = after->time_s - before->time_s;
  if (step_s > kNoGap_s && step_s > longest_step_around(samples, time_s)) return std::nullopt;
  return Around{&*before, &*after};
}

std::optional<Pose> LivePoses::at(double time_s) const {
  if (position_.empty()) return std::nullopt;
  const auto attitude = around(streams_.at({attitude_, NavQuantity::kAttitude}), time_s);
  const auto position = around(streams_.at({position_, NavQuantity::kPosition}), time_s);
  if (!attitude || !position) return std::nullopt;
  const auto pose_at = [&](double at_s) -> Pose {
    return pose_between(NavQuantity::kPosition, *position->before, *position->after, at_s) *
           pose_between(NavQuantity::kAttitude, *attitude->before, *attitude->after, at_s);
  };
  // As in the trajectory of a log, which has a pose at each time of either source.
  const double from_s = std::max(attitude->before->time_s, position->before->time_s);
  const double to_s = std::min(attitude->after->time_s, position->after->time_s);
  if (!(from_s < to_s)) return pose_at(time_s);
  return interpolate(pose_at(from_s), pose_at(to_s), (time_s - from_s) / (to_s - from_s));
}

std::optional<double> LivePoses::known_until_s() const {
  if (position_.empty()) return std::nullopt;
  double until_s = std::numeric_limits<double>::infinity();
  for (const auto& [name, stream] : streams_) until_s = std::min(until_s, stream.samples.back().time_s);
  return until_s;
}

}  // namespace pingvox
