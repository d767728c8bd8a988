#include "nav/internal/step_filter.hpp"

#include "nav/source_steps.hpp"

namespace pingvox {

StepFilter::Verdict StepFilter::add(const NavSample& sample, const SamplePose& pose) {
  if (!held_.empty() && held_frame_ == frame_) held_.clear();  // they were given to the caller
  const std::size_t frame = tracker_.add(pose);
  const bool goes_on = frame == frame_;
  if (!held_.empty() && (goes_on || frame != held_frame_)) {
    outliers_ += held_.size();
    held_.clear();
  }
  if (goes_on) {
    last_ = pose;
    return Verdict::kGood;
  }
  if (held_.empty()) step_ = source_step(PoseStep::between(last_, pose), tracker_.is_new_start());
  held_frame_ = frame;
  held_.push_back(sample);
  if (!is_lasting(held_.size(), sample.time_s - held_.front().time_s)) return Verdict::kHeld;
  frame_ = frame;
  last_ = pose;
  return Verdict::kNewFrame;
}

}  // namespace pingvox
