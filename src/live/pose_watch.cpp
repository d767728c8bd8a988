#include "live/pose_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "live/live_navigation.hpp"

namespace pingvox {

std::optional<LiveEvent> PoseWatch::update(const Seen& seen) {
  constexpr double kWindow_s = 5.0;
  constexpr std::size_t kMinBeams = 10;
  note_pose(seen);
  const Seen before = std::exchange(last_, seen);
  if (seen.beams == before.beams) return std::nullopt;
  const bool goes_on = asked_s_ && seen.now_s - *asked_s_ <= kWindow_s;
  asked_s_ = seen.now_s;
  if (!goes_on) {  // it is the first one, or the sonar was silent
    begin_window(before, seen.now_s);
    before_.reset();
  }
  const Count window{seen.beams - from_.beams, seen.without_pose - from_.without_pose, seen.now_s - from_s_};
  if (window.seconds < kWindow_s || window.beams < kMinBeams) return std::nullopt;
  std::optional<LiveEvent> event = judge(window);
  before_ = window;
  begin_window(seen, seen.now_s);
  return event;
}

void PoseWatch::restart(const Seen& seen) {
  last_ = seen;
  asked_s_.reset();
  pose_came_s_.reset();
}

void PoseWatch::begin_window(const Seen& from, double from_s) {
  from_ = from;
  from_s_ = from_s;
  apart_before_s_ = std::exchange(apart_s_, 0.0);
}

void PoseWatch::note_pose(const Seen& seen) {
  const double came_s = seen.pose.came_s;
  const std::optional<double> before_s = std::exchange(pose_came_s_, came_s);
  if (before_s == came_s) return;
  if (before_s) apart_s_ = std::max(apart_s_, came_s - *before_s);
  // The beams' clock goes on from one beam to the next.
  behind_s_ = seen.beam.stamp_s + (came_s - seen.beam.came_s) - seen.pose.stamp_s;
}

/// Where clocks are wrong no beam gets a pose. Where poses are too sparse some still do, and it is reported when most
/// do not; a pause of less than five seconds is less than half of two windows.
std::optional<LiveEvent> PoseWatch::judge(const Count& window) {
  const auto is_most = [](const Count& count, std::size_t tenths) {
    return 10 * count.without_pose > tenths * count.beams;
  };
  if (is_reported_) {
    if (is_most(window, 1)) return std::nullopt;
    is_reported_ = false;
    return live_event::BeamsWithPose{};
  }
  std::optional<Count> lost;
  if (is_most(window, 9)) {
    lost = window;
  } else if (before_) {
    const Count both{window.beams + before_->beams, window.without_pose + before_->without_pose,
                     window.seconds + before_->seconds};
    if (is_most(both, 5)) lost = both;
  }
  if (!lost) return std::nullopt;
  is_reported_ = true;
  return loss(*lost);
}

live_event::BeamsWithoutPose PoseWatch::loss(const Count& count) const {
  constexpr double kPatience_s = LiveNavigation::kPatience_s;
  live_event::BeamsWithoutPose event{count.beams, count.without_pose, count.seconds, std::nullopt, std::nullopt};
  const double behind_s = std::fabs(behind_s_), apart_s = std::max(apart_s_, apart_before_s_);
  if (behind_s < kPatience_s && apart_s > kPatience_s) {
    event.apart_s = apart_s;
  } else if (behind_s > kPatience_s / 2.0) {
    event.behind_s = behind_s_;
  }
  return event;
}

}  // namespace pingvox
