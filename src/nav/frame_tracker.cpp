#include "nav/internal/frame_tracker.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/median.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox {
namespace {

constexpr double kShortestStep_s = 0.1;
constexpr double kTimesUsual = 5.0;
constexpr std::size_t kEnoughUsual = 5;
/// Of more frames the one with fewest samples is forgotten: a source of nothing but jumps takes no more time.
constexpr std::size_t kMaxFrames = 64;
/// A device that restarts is silent for some seconds, and then at its origin.
constexpr double kPause_s = 1.0, kAtOrigin_m = 0.1, kAway_m = 1.0;

double counted_s(double seconds) {
  return std::max(seconds, kShortestStep_s);
}

Eigen::Quaterniond rotation_by(const Eigen::Vector3d& rpy_rad) {
  return Eigen::Quaterniond(pose_from_rpy(Eigen::Vector3d::Zero(), rpy_rad.x(), rpy_rad.y(), rpy_rad.z()).linear());
}

}  // namespace

MotionLimits MotionLimits::of(NavQuantity quantity) {
  MotionLimits limits;
  // Fixes of a receiver that has few satellites are some metres apart, and a boat may carry it.
  constexpr double kFixNoise_m = 10.0;
  if (quantity == NavQuantity::kFix) limits.noise_m = kFixNoise_m;
  limits.starts_at_origin = quantity == NavQuantity::kPosition;
  return limits;
}

bool gives_pose(NavQuantity quantity) {
  switch (quantity) {
    case NavQuantity::kPosition:
    case NavQuantity::kFix:
    case NavQuantity::kDepth:
    case NavQuantity::kPressure:
    case NavQuantity::kAttitude:
    case NavQuantity::kHeading:
      return true;
    default:
      return false;
  }
}

SamplePose pose_by(NavQuantity quantity, const NavSample& sample, const Eigen::Vector3d& origin) {
  constexpr double kMetreOfWater_pa = 1e4;
  SamplePose pose;
  pose.time_s = sample.time_s;
  const Eigen::Vector3d& value = sample.value;
  switch (quantity) {
    case NavQuantity::kPosition:
      pose.place_m = value;
      break;
    case NavQuantity::kFix:
      pose.place_m = position_of_fix(value, origin);
      break;
    case NavQuantity::kDepth:
      pose.place_m.z() = -value.x();
      break;
    case NavQuantity::kPressure:
      pose.place_m.z() = -value.x() / kMetreOfWater_pa;
      break;
    case NavQuantity::kAttitude:
      pose.rotation = rotation_by(value);
      break;
    case NavQuantity::kHeading:
      pose.rotation = rotation_by({0.0, 0.0, value.x()});
      break;
    default:
      assert(false);
  }
  return pose;
}

PoseStep PoseStep::between(const SamplePose& from, const SamplePose& to) {
  PoseStep step{from.time_s, to.time_s, to.place_m - from.place_m, to.rotation * from.rotation.conjugate(), 0.0};
  step.turned_rad = from.rotation.angularDistance(to.rotation);
  return step;
}

std::size_t FrameTracker::add(const SamplePose& sample) {
  is_new_start_ = false;
  if (!last_) {
    begin_frame({});
  } else {
    const PoseStep step = PoseStep::between(*last_, sample);
    is_new_start_ = leads_to_new_start(step, sample);
    if (is_new_start_ || is_jump(step)) {
      leave_frame(step);
    } else {
      remember(step);
    }
  }
  last_ = sample;
  ++frames_[current_].samples;
  return frames_[current_].number;
}

bool FrameTracker::is_beyond(const PoseStep& step, double speed_m_s, double turn_rad_s) const {
  const double seconds = counted_s(step.seconds());
  return step.moved_m.norm() > limits_.noise_m + speed_m_s * seconds || step.turned_rad > turn_rad_s * seconds;
}

bool FrameTracker::is_jump(const PoseStep& step) const {
  if (!is_beyond(step, limits_.speed_m_s, limits_.turn_rad_s)) return false;
  const std::size_t count = std::min(remembered_, kUsual);
  if (count < kEnoughUsual) return true;
  std::vector<double> speeds_m_s, turns_rad_s;
  for (std::size_t i = 0; i < count; ++i) {
    speeds_m_s.push_back(usual_[i].speed_m_s);
    turns_rad_s.push_back(usual_[i].turn_rad_s);
  }
  return is_beyond(step, std::max(limits_.speed_m_s, kTimesUsual * median(std::move(speeds_m_s))),
                   std::max(limits_.turn_rad_s, kTimesUsual * median(std::move(turns_rad_s))));
}

bool FrameTracker::leads_to_new_start(const PoseStep& step, const SamplePose& sample) const {
  if (!limits_.starts_at_origin || sample.place_m.norm() > kAtOrigin_m || last_->place_m.norm() < kAway_m) return false;
  if (is_jump(step)) return true;
  std::vector<double> steps_s;
  for (std::size_t i = 0; i < std::min(remembered_, kUsual); ++i) steps_s.push_back(usual_[i].seconds);
  const double usual_s = steps_s.empty() ? 0.0 : median(std::move(steps_s));
  return step.seconds() >= std::max(kPause_s, kTimesUsual * usual_s);
}

void FrameTracker::leave_frame(const PoseStep& step) {
  Frame& left = frames_[current_];
  left.left_s = step.seconds();
  Frame next;
  next.offset_m = left.offset_m + step.moved_m;
  next.rotation = (step.rotation * left.rotation).normalized();
  std::optional<std::size_t> found;
  double best = 1.0;
  for (std::size_t i = 0; i < frames_.size() && !is_new_start_; ++i) {
    if (i == current_) continue;
    const double share = share_of_limit(frames_[i], next, step.seconds());
    if (share > best) continue;
    best = share;
    found = i;
  }
  if (found) {
    current_ = *found;
  } else {
    begin_frame(std::move(next));
  }
}

/// The way between the offsets of two frames, of what a vehicle can do in the two steps from one to the other.
double FrameTracker::share_of_limit(const Frame& frame, const Frame& other, double seconds) const {
  const double both_s = counted_s(frame.left_s + seconds);
  return std::max((other.offset_m - frame.offset_m).norm() / (limits_.noise_m + limits_.speed_m_s * both_s),
                  frame.rotation.angularDistance(other.rotation) / (limits_.turn_rad_s * both_s));
}

void FrameTracker::begin_frame(Frame frame) {
  if (frames_.size() == kMaxFrames) frames_.erase(std::ranges::min_element(frames_, {}, &Frame::samples));
  frame.number = begun_++;
  frames_.push_back(std::move(frame));
  current_ = frames_.size() - 1;
}

void FrameTracker::remember(const PoseStep& step) {
  const double seconds = counted_s(step.seconds());
  usual_[remembered_++ % kUsual] = {step.seconds(), step.moved_m.norm() / seconds, step.turned_rad / seconds};
}

}  // namespace pingvox
