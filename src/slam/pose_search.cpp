#include "slam/pose_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <tuple>
#include <utility>

namespace pingvox {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kCoarseEchoes = 60;
constexpr double kStep_m = 0.2, kYawSteps = 90.0;
constexpr double kMaxPoses = 1.5e6;  ///< of the coarse grid: beyond, its places are farther apart
constexpr std::size_t kCandidates = 150;
/// A vehicle may be this far within unknown space: the blanking range of a sonar that stood still.
constexpr double kReach_m = 1.0;
constexpr double kMinLog = -13.8;  ///< one in a million

std::vector<HeardBeam> some_echoes(std::span<const HeardBeam> beams, std::size_t most) {
  std::vector<HeardBeam> echoes, some;
  std::ranges::copy_if(beams, std::back_inserter(echoes), &HeardBeam::has_echo);
  const std::size_t count = std::min(most, echoes.size());
  for (std::size_t i = 0; i < count; ++i) some.push_back(echoes[i * echoes.size() / count]);
  return some;
}

/// The best poses of the coarse grid.
std::vector<ScoredPose> coarse_search(const DistanceField& field, const std::vector<HeardBeam>& echoes,
                                      const BeamLikelihood& model, double step_m) {
  const std::vector<Eigen::Vector2d> places = field.places(step_m, kReach_m);
  const double yaw_step = 2.0 * kPi / kYawSteps;
  std::vector<EndTable> tables;
  for (const HeardBeam& echo : echoes) {
    // Half a step away at the most on each axis; that is 0.29 steps of standard deviation.
    const double off_m = std::hypot(0.29 * step_m * std::numbers::sqrt2, 0.29 * yaw_step * echo.range_m);
    tables.emplace_back(echo, field, model, off_m);
  }
  std::vector<double> x(places.size()), y(places.size()), cosine(places.size()), sine(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    x[i] = places[i].x();
    y[i] = places[i].y();
  }
  std::vector<float> sums(places.size());
  std::vector<ScoredPose> best;
  const auto is_better = [](const ScoredPose& a, const ScoredPose& b) {
    return std::tuple(-a.log_likelihood, a.pose.x, a.pose.y, a.pose.yaw) <
           std::tuple(-b.log_likelihood, b.pose.x, b.pose.y, b.pose.yaw);
  };
  for (double turn = 0.0; turn < kYawSteps; turn += 1.0) {
    const double yaw = turn * yaw_step;
    std::ranges::fill(cosine, std::cos(yaw));
    std::ranges::fill(sine, std::sin(yaw));
    std::ranges::fill(sums, 0.0F);
    for (std::size_t e = 0; e < echoes.size(); ++e) {
      add_end_likelihood(field, tables[e], echoes[e].end_m(), x, y, cosine, sine, sums);
    }
    std::vector<ScoredPose> here;
    for (std::size_t i = 0; i < places.size(); ++i) here.push_back({{x[i], y[i], yaw}, sums[i]});
    const auto most = static_cast<std::ptrdiff_t>(std::min<std::size_t>(here.size(), 4 * kCandidates));
    std::ranges::nth_element(here, here.begin() + most, is_better);
    here.resize(static_cast<std::size_t>(most));
    best.insert(best.end(), here.begin(), here.end());
  }
  return without_neighbours(std::move(best), 1.5 * step_m, 1.5 * yaw_step, kCandidates);
}

}  // namespace

std::vector<ScoredPose> without_neighbours(std::vector<ScoredPose> poses, double near_m, double near_rad,
                                           std::size_t most) {
  std::ranges::sort(poses, {},
                    [](const ScoredPose& p) { return std::tuple(-p.log_likelihood, p.pose.x, p.pose.y, p.pose.yaw); });
  std::vector<ScoredPose> kept;
  for (const ScoredPose& pose : poses) {
    if (kept.size() >= most) break;
    const bool is_near = std::ranges::any_of(kept, [&](const ScoredPose& other) {
      return std::hypot(pose.pose.x - other.pose.x, pose.pose.y - other.pose.y) <= near_m &&
             std::abs(std::remainder(pose.pose.yaw - other.pose.yaw, 2.0 * kPi)) <= near_rad;
    });
    if (!is_near) kept.push_back(pose);
  }
  return kept;
}

ScoredPose refine_pose(std::span<const BeamJudge> judges, const BeamLikelihood& model, const PlanePose& from,
                       double step_m, double step_rad) {
  ScoredPose best{from, log_likelihood(judges, from, model)};
  const auto try_step = [&](double dx, double dy, double dyaw) {
    const PlanePose pose{best.pose.x + dx, best.pose.y + dy, best.pose.yaw + dyaw};
    const double score = log_likelihood(judges, pose, model);
    if (score <= best.log_likelihood) return false;
    best = {pose, score};
    return true;
  };
  constexpr int kHalvings = 4, kRounds = 4;
  for (int halving = 0; halving <= kHalvings; ++halving) {
    for (int round = 0; round < kRounds; ++round) {
      bool moved = false;
      for (const double sign : {-1.0, 1.0}) {
        moved |= try_step(sign * step_m, 0.0, 0.0);
        moved |= try_step(0.0, sign * step_m, 0.0);
        moved |= try_step(0.0, 0.0, sign * step_rad);
      }
      if (!moved) break;
    }
    step_m *= 0.5;
    step_rad *= 0.5;
  }
  return best;
}

std::vector<ScoredPose> search_poses(const DistanceField& field, std::span<const HeardBeam> beams,
                                     const BeamLikelihood& model) {
  const std::vector<HeardBeam> echoes = some_echoes(beams, kCoarseEchoes);
  if (echoes.empty()) return {};
  const double step_m = std::max({kStep_m, field.cell_m(), std::sqrt(field.free_area_m2() * kYawSteps / kMaxPoses)});
  std::vector<ScoredPose> candidates = coarse_search(field, echoes, model, step_m);
  std::vector<BeamJudge> judges;
  for (const HeardBeam& beam : beams) judges.emplace_back(beam, field, model);
  for (ScoredPose& candidate : candidates) {
    candidate = refine_pose(judges, model, candidate.pose, 0.5 * step_m, kPi / kYawSteps);
  }
  std::vector<ScoredPose> found = without_neighbours(std::move(candidates), 0.3, 10.0 * kPi / 180.0, kCandidates);
  if (!found.empty()) {
    const double least = found.front().log_likelihood + kMinLog;
    std::erase_if(found, [&](const ScoredPose& pose) { return pose.log_likelihood < least; });
  }
  return found;
}

}  // namespace pingvox
