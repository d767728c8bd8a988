#include "slam/localisation/particles.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose2.hpp"

namespace pingvox {
namespace {

/// How many boxes of 0.1 m and 3 degrees the chosen particles lie in.
std::size_t bins_of(const std::vector<Pose2>& poses, const std::vector<std::size_t>& chosen) {
  std::unordered_set<std::uint64_t> bins;
  for (const std::size_t i : chosen) {
    const Pose2& p = poses[i];
    const auto part = [](double value, double step) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::clamp(std::floor(value / step), -1e6, 1e6))) &
             0x1FFFFFU;
    };
    bins.insert(part(p.place_m.x(), 0.1) | part(p.place_m.y(), 0.1) << 21U |
                part(std::remainder(p.yaw_rad, 2.0 * std::numbers::pi), 3.0 * kDegree_rad) << 42U);
  }
  return bins.size();
}

/// Mean and spread of the particles that `is_member` says belong together.
template <class IsMember>
PoseHypothesis mean_of(const Particles& particles, const std::vector<double>& weights, const IsMember& is_member) {
  double weight = 0.0, x = 0.0, y = 0.0, cosine = 0.0, sine = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!is_member(i)) continue;
    const Pose2& p = particles.poses[i];
    weight += weights[i];
    x += weights[i] * p.place_m.x();
    y += weights[i] * p.place_m.y();
    cosine += weights[i] * std::cos(p.yaw_rad);
    sine += weights[i] * std::sin(p.yaw_rad);
  }
  PoseHypothesis mean;
  mean.weight = weight;
  if (!(weight > 0.0)) return mean;
  mean.x_m = x / weight;
  mean.y_m = y / weight;
  mean.yaw_rad = std::atan2(sine, cosine);
  double squares = 0.0, turns = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!is_member(i)) continue;
    const Pose2& p = particles.poses[i];
    squares += weights[i] * (std::pow(p.place_m.x() - mean.x_m, 2) + std::pow(p.place_m.y() - mean.y_m, 2));
    turns += weights[i] * std::pow(wrap_angle(p.yaw_rad - mean.yaw_rad), 2);
  }
  mean.deviation_m = std::sqrt(squares / weight);
  mean.deviation_rad = std::sqrt(turns / weight);
  return mean;
}

}  // namespace

Pose2 pose_of(const PoseHypothesis& hypothesis) {
  return {{hypothesis.x_m, hypothesis.y_m}, hypothesis.yaw_rad};
}

bool is_near(const Pose2& pose, const Pose2& other, double near_m, double near_rad) {
  return std::hypot(pose.place_m.x() - other.place_m.x(), pose.place_m.y() - other.place_m.y()) <= near_m &&
         std::abs(wrap_angle(other.yaw_rad - pose.yaw_rad)) <= near_rad;
}

std::vector<double> Particles::weights() const {
  std::vector<double> w(log_weights.size());
  const double most = log_weights.empty() ? 0.0 : *std::ranges::max_element(log_weights);
  double sum = 0.0;
  for (std::size_t i = 0; i < w.size(); ++i) sum += w[i] = std::exp(log_weights[i] - most);
  for (double& weight : w) weight /= sum;
  return w;
}

std::vector<std::size_t> draw_particles(const std::vector<double>& weights, std::size_t count, double offset) {
  std::vector<std::size_t> chosen;
  chosen.reserve(count);
  double sum = weights.front();
  std::size_t i = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const double at = (static_cast<double>(n) + offset) / static_cast<double>(count);
    while (sum < at && i + 1 < weights.size()) sum += weights[++i];
    chosen.push_back(i);
  }
  return chosen;
}

double kld_particles(const std::vector<Pose2>& poses, const std::vector<std::size_t>& chosen) {
  const std::size_t bins = bins_of(poses, chosen);
  if (bins < 2) return 1.0;
  constexpr double kDistance = 0.05, kQuantile = 2.3263;
  const double free = static_cast<double>(bins - 1), part = 2.0 / (9.0 * free);
  const double cube = 1.0 - part + std::sqrt(part) * kQuantile;
  return free / (2.0 * kDistance) * cube * cube * cube;
}

PoseHypothesis mean_near(const Particles& particles, const Pose2& pose, double near_m, double near_rad) {
  return mean_of(particles, particles.weights(),
                 [&](std::size_t i) { return is_near(particles.poses[i], pose, near_m, near_rad); });
}

std::vector<PoseHypothesis> groups_of(const Particles& particles) {
  const std::vector<double> weights = particles.weights();
  std::vector<std::size_t> order(weights.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return std::pair(-weights[i], i); });
  // Each belongs to the first leader that is near it.
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> group(weights.size(), kNone), leaders;
  for (const std::size_t i : order) {
    const Pose2& pose = particles.poses[i];
    for (std::size_t g = 0; g < leaders.size() && group[i] == kNone; ++g) {
      if (is_near(pose, particles.poses[leaders[g]], kHypothesis_m, kHypothesis_rad)) group[i] = g;
    }
    if (group[i] == kNone && leaders.size() < kMaxHypotheses) {
      group[i] = leaders.size();
      leaders.push_back(i);
    }
  }
  // Groups whose means are near each other are one.
  std::vector<PoseHypothesis> means;
  for (std::size_t g = 0; g < leaders.size(); ++g) {
    means.push_back(mean_of(particles, weights, [&](std::size_t i) { return group[i] == g; }));
  }
  for (std::size_t g = 1; g < means.size(); ++g) {
    for (std::size_t other = 0; other < g; ++other) {
      if (means[other].weight == 0.0 ||
          !is_near(pose_of(means[g]), pose_of(means[other]), kHypothesis_m, kHypothesis_rad)) {
        continue;
      }
      for (std::size_t& of : group) of = of == g ? other : of;
      means[other] = mean_of(particles, weights, [&](std::size_t i) { return group[i] == other; });
      means[g].weight = 0.0;
      break;
    }
  }
  std::erase_if(means, [](const PoseHypothesis& mean) { return mean.weight < 1e-3; });
  std::ranges::sort(means, {}, [](const PoseHypothesis& m) { return std::tuple(-m.weight, m.x_m, m.y_m, m.yaw_rad); });
  return means;
}

}  // namespace pingvox
