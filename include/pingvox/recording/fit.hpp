#pragma once

#include <functional>
#include <vector>

#include "pingvox/recording/evaluate.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/slam_calibration.hpp"

namespace pingvox {

/// The parameter that is fitted, and the unit of its values.
enum class FitParameter {
  kSoundSpeed,  ///< true sound speed / the one that the recording assumes, within 5 %
  kMountYaw,    ///< added to the yaw of the mount [rad], within 10 degrees
  kNavOffset,   ///< added to the times of the path [s], within 2 s
  kMountXy,     ///< added to x and y of the mount [m], within 0.6 m
};

/// The values with which a map predicts its held-out echoes best.
struct Fit {
  std::vector<Estimate> values;  ///< one; of kMountXy two
  /// Mean score of an echo as the recording is, and with these values: 1 is predicted exactly, 0 is not predicted.
  double score_before = 0.0, score = 0.0;
  /// Whether the values are observable in the recording: inside the searched interval, with a score that falls off to
  /// both sides, and similar in all parts of the recording.
  bool is_observable = false;
};

/// Searches the values of a parameter with which each sweep is predicted best by the sweeps before and after it. Their
/// deviations are by the jackknife over tenths of the recording.
/// @param options  as for evaluate; folds are ignored
/// @return kUnsupported when there are fewer than four sweeps; errors as of evaluate
Result<Fit> fit(const Recording& recording, const VehiclePath& path, FitParameter parameter,
                const EvaluateOptions& options = {}, const std::function<void(double)>& progress = nullptr);

}  // namespace pingvox
