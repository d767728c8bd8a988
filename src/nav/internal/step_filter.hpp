#pragma once

#include <cstddef>
#include <vector>

#include "nav/internal/frame_tracker.hpp"
#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// Tells outliers from a new frame while the samples of a source arrive: those behind a step that no vehicle makes are
/// held back until it is known whether the next ones stay there.
class StepFilter {
 public:
  explicit StepFilter(const MotionLimits& limits) : tracker_(limits) {}

  enum class Verdict {
    kGood,     ///< in the frame of the good ones before it; those that were held back are outliers
    kHeld,     ///< not known yet
    kNewFrame  ///< in another frame, as those held back; it is the frame of the source from now on
  };
  /// @param pose  by the sample, in the source's own numbers. REQUIRES samples in order of time
  Verdict add(const NavSample& sample, const SamplePose& pose);

  /// The samples that are held back; after kNewFrame those of the new frame, the last one included.
  const std::vector<NavSample>& held() const { return held_; }
  /// After kNewFrame: the step that led there.
  const SourceStep& step() const { return step_; }
  /// Samples that were left out so far.
  std::size_t outliers() const { return outliers_; }

 private:
  FrameTracker tracker_;
  std::size_t frame_ = 0, held_frame_ = 0;
  SamplePose last_;  ///< the last good one
  std::vector<NavSample> held_;
  SourceStep step_;  ///< to the first one that is held back
  std::size_t outliers_ = 0;
};

}  // namespace pingvox
