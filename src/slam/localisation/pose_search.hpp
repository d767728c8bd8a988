#pragma once

#include <span>
#include <vector>

#include "slam/localisation/beam_likelihood.hpp"

namespace pingvox {

/// A pose, and the log-likelihood of the beams there.
struct ScoredPose {
  Pose2 pose;
  double log_likelihood = 0.0;
};

/// The poses of a map where a turn of beams fits best: a grid over all places where a vehicle may be, coarse, by the
/// ends of some echoes; the best of it refined by the whole model. Poses within 0.3 m and 10 degrees of a better one,
/// and those a million times less likely than the best, are left out. The best first; empty: no echoes, or no place.
std::vector<ScoredPose> search_poses(const DistanceField& field, std::span<const HeardBeam> beams,
                                     const BeamLikelihood& model);

/// The best pose near one, by steps that are halved four times.
ScoredPose refine_pose(std::span<const BeamJudge> judges, const BeamLikelihood& model, const Pose2& from, double step_m,
                       double step_rad);

/// Whether the beams are at least five times as likely at the best pose as at any that is another hypothesis.
/// REQUIRES one pose at least, the best first.
bool is_distinct(std::span<const ScoredPose> found);

/// The poses without those that a better one is near; the best first.
std::vector<ScoredPose> without_neighbours(std::vector<ScoredPose> poses, double near_m, double near_rad,
                                           std::size_t most);

}  // namespace pingvox
