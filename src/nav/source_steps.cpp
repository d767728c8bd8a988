#include "nav/source_steps.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "base/median.hpp"

namespace pingvox {
namespace {

constexpr double kInfinity_s = std::numeric_limits<double>::infinity();

/// Times in which a device was in another frame with all that it tells.
struct OtherFrame {
  double from_s = -kInfinity_s, to_s = kInfinity_s;
};

/// A valid sample of a source.
struct TrackedSample {
  std::size_t index = 0;  ///< in the source
  std::size_t frame = 0;
  bool is_new_start = false;
};

std::vector<TrackedSample> track(const NavSource& source) {
  FrameTracker tracker(MotionLimits::of(source.quantity));
  std::vector<TrackedSample> tracked;
  const NavSample* first = nullptr;
  for (std::size_t i = 0; i < source.samples.size(); ++i) {
    const NavSample& sample = source.samples[i];
    if (!sample.valid) continue;
    if (first == nullptr) first = &sample;
    const std::size_t frame = tracker.add(pose_by(source.quantity, sample, first->value));
    tracked.push_back({i, frame, tracker.is_new_start()});
  }
  return tracked;
}

/// That of most samples, the first of equals.
std::size_t main_frame(const std::vector<TrackedSample>& tracked) {
  std::vector<std::size_t> samples;
  for (const TrackedSample& sample : tracked) {
    samples.resize(std::max(samples.size(), sample.frame + 1));
    ++samples[sample.frame];
  }
  return static_cast<std::size_t>(std::ranges::max_element(samples) - samples.begin());
}

/// Leaves out the samples [begin, end), which are in other frames than their neighbours.
/// @return the times that they reach over, if they are of another start of the device
std::optional<OtherFrame> leave_out(NavSource& source, const std::vector<TrackedSample>& tracked, std::size_t begin,
                                    std::size_t end) {
  const auto sample_of = [&](std::size_t i) -> NavSample& { return source.samples[tracked[i].index]; };
  // Into the other frame, or out of it where the source begins in it.
  const std::size_t to = begin > 0 ? begin : end;
  const Eigen::Vector3d& origin = sample_of(0).value;
  const PoseStep step = PoseStep::between(pose_by(source.quantity, sample_of(to - 1), origin),
                                          pose_by(source.quantity, sample_of(to), origin));
  SourceStep noted = source_step(step, tracked[to].is_new_start);
  noted.left_out = end - begin;
  noted.left_from_s = sample_of(begin).time_s;
  noted.left_to_s = sample_of(end - 1).time_s;
  source.steps.push_back(noted);
  for (std::size_t i = begin; i < end; ++i) {
    sample_of(i).valid = false;
    sample_of(i).is_in_other_frame = true;
  }
  if (!noted.is_new_start || !is_lasting(noted.left_out, noted.left_to_s - noted.left_from_s)) return std::nullopt;
  return OtherFrame{begin > 0 ? noted.left_from_s : -kInfinity_s, end < tracked.size() ? noted.left_to_s : kInfinity_s};
}

/// Of a source that jumps from nearly each sample to the next the unit is wrong.
std::string fault_of_jumps(const NavSource& source, const std::vector<TrackedSample>& tracked, std::size_t kept) {
  constexpr std::size_t kMinSamples = 10, kOneOf = 10;
  const auto in_frame = static_cast<std::size_t>(std::ranges::count(tracked, kept, &TrackedSample::frame));
  if (tracked.size() < kMinSamples || in_frame * kOneOf >= tracked.size()) return {};
  std::vector<double> moved_m, steps_s;
  std::size_t jumps = 0;
  for (std::size_t i = 1; i < tracked.size(); ++i) {
    if (tracked[i].frame != tracked[i - 1].frame) ++jumps;
    const NavSample &from = source.samples[tracked[i - 1].index], &to = source.samples[tracked[i].index];
    moved_m.push_back((to.value - from.value).norm());
    steps_s.push_back(to.time_s - from.time_s);
  }
  if (2 * jumps < tracked.size()) return {};
  const double move_m = median(std::move(moved_m)), step_s = median(std::move(steps_s));
  if (source.quantity == NavQuantity::kPosition) {
    return fmt::format("it moves by {:.3g} m every {:.3g} s: is it in cm or mm?", move_m, step_s);
  }
  return fmt::format("it jumps all the time, by {:.3g} every {:.3g} s: is it in another unit?", move_m, step_s);
}

/// @return when the device was in other frames with all that it tells
std::vector<OtherFrame> leave_out_other_frames(NavSource& source) {
  const std::vector<TrackedSample> tracked = track(source);
  std::vector<OtherFrame> others;
  if (std::ranges::all_of(tracked, [](const TrackedSample& sample) { return sample.frame == 0; })) return others;
  const std::size_t kept = main_frame(tracked);
  source.fault = fault_of_jumps(source, tracked, kept);
  if (!source.fault.empty()) return others;
  for (std::size_t begin = 0; begin < tracked.size();) {
    std::size_t end = begin;
    while (end < tracked.size() && tracked[end].frame != kept) ++end;
    if (end > begin) {
      if (const auto other = leave_out(source, tracked, begin, end)) others.push_back(*other);
    }
    begin = end + 1;
  }
  return others;
}

/// Leaves out the attitudes in these times.
void leave_out_attitudes(NavSource& attitude, const std::vector<OtherFrame>& others) {
  for (NavSample& sample : attitude.samples) {
    if (!sample.valid) continue;
    // Of those that begin before the sample the last one.
    const auto after = std::ranges::upper_bound(others, sample.time_s, {}, &OtherFrame::from_s);
    if (after == others.begin() || std::prev(after)->to_s < sample.time_s) continue;
    sample.valid = false;
    sample.is_in_other_frame = true;
  }
}

/// Whether the vehicle noses up or down so far that its heading alone turns as fast as it likes.
bool has_steep_pitch(const std::vector<NavSource>& sources) {
  constexpr double kSteep = 0.866;  // sine of 60 degrees
  return std::ranges::any_of(sources, [](const NavSource& source) {
    return source.quantity == NavQuantity::kAttitude && std::ranges::any_of(source.samples, [](const NavSample& s) {
             return s.valid && std::abs(std::sin(s.value.y())) > kSteep;
           });
  });
}

}  // namespace

bool is_lasting(std::size_t samples, double seconds) {
  constexpr std::size_t kMinSamples = 3;
  constexpr double kMinSeconds = 0.5;
  return samples >= kMinSamples && seconds >= kMinSeconds;
}

SourceStep source_step(const PoseStep& step, bool is_new_start) {
  SourceStep noted;
  noted.from_s = step.from_s;
  noted.to_s = step.to_s;
  noted.moved_m = step.moved_m.norm();
  noted.turned_rad = step.turned_rad;
  noted.is_new_start = is_new_start;
  return noted;
}

void leave_out_other_frames(std::vector<NavSource>& sources) {
  for (NavSource& source : sources) {
    // Where the clock was set back, the order of the samples is not theirs.
    if (!gives_pose(source.quantity) || source.step_back || !source.fault.empty()) continue;
    if (source.quantity == NavQuantity::kHeading && has_steep_pitch(sources)) continue;
    const std::vector<OtherFrame> others = leave_out_other_frames(source);
    if (others.empty()) continue;
    for (NavSource& attitude : sources) {
      if (attitude.quantity == NavQuantity::kAttitude && attitude.name == source.name) {
        leave_out_attitudes(attitude, others);
      }
    }
  }
}

void restore_other_frames(NavSource& source) {
  for (NavSample& sample : source.samples) {
    sample.valid = sample.valid || sample.is_in_other_frame;
    sample.is_in_other_frame = false;
  }
  source.steps.clear();
}

}  // namespace pingvox
