#pragma once

#include <cstddef>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "pingvox/slam/localizer.hpp"
#include "slam/localisation/beam_likelihood.hpp"

/// The particles of Localizer, and what is read off them.
namespace pingvox {

/// Poses of one hypothesis are within this.
inline constexpr double kHypothesis_m = 0.5, kHypothesis_rad = 20.0 * kDegree_rad;
inline constexpr std::size_t kMaxHypotheses = 100;

Pose2 pose_of(const PoseHypothesis& hypothesis);

/// Whether a pose is within some distance and angle of another.
bool is_near(const Pose2& pose, const Pose2& other, double near_m, double near_rad);

struct Particles {
  std::vector<Pose2> poses;
  std::vector<double> log_weights;

  std::vector<double> weights() const;  ///< normalised
};

/// Systematic resampling: indices of `count` particles. REQUIRES a weight
std::vector<std::size_t> draw_particles(const std::vector<double>& weights, std::size_t count, double offset);

/// Number of particles that keep the Kullback-Leibler distance below 0.05 with probability 0.99, by how many boxes of
/// 0.1 m and 3 degrees the chosen ones lie in (Fox 2003, equation 7).
double kld_particles(const std::vector<Pose2>& poses, const std::vector<std::size_t>& chosen);

/// Mean and spread of the particles within some distance and angle of a pose; its weight is 0 when there are none.
PoseHypothesis mean_near(const Particles& particles, const Pose2& pose, double near_m, double near_rad);

/// Particles that lie together, the heaviest group first.
std::vector<PoseHypothesis> groups_of(const Particles& particles);

}  // namespace pingvox
