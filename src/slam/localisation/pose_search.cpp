#include "slam/localisation/pose_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "pingvox/geometry/degree.hpp"
#include "slam/localisation/particles.hpp"

namespace pingvox {
namespace {

constexpr std::size_t kCoarseEchoes = 60;
constexpr double kStep_m = 0.2, kYawSteps = 90.0;
constexpr double kMaxPoses = 1.5e6;  ///< of the coarse grid: beyond, its places are farther apart
/// All of the grid is scored by one of so many echoes, and the best of it, one of so many poses, by all.
constexpr std::size_t kFirstEchoes = 4, kSecondShare = 20, kMinSecond = 10'000;
constexpr std::size_t kBest = 10'000, kCandidates = 150;
/// Those of the candidates that are refined by all of the model.
constexpr std::size_t kRefined = 40;
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
  const double yaw_step = 2.0 * std::numbers::pi / kYawSteps;
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
  std::vector<float> sums(places.size() * static_cast<std::size_t>(kYawSteps), 0.0F);
  const auto yaw_rad = [&](std::size_t pose) {
    const std::size_t turn = pose / places.size();
    return static_cast<double>(turn) * yaw_step;
  };
  for (std::size_t first = 0; first < sums.size(); first += places.size()) {
    std::ranges::fill(cosine, std::cos(yaw_rad(first)));
    std::ranges::fill(sine, std::sin(yaw_rad(first)));
    for (std::size_t e = 0; e < echoes.size(); e += kFirstEchoes) {
      add_end_likelihood(field, tables[e], echoes[e].end_m(), x, y, cosine, sine,
                         std::span(sums).subspan(first, places.size()));
    }
  }
  std::vector<std::uint32_t> poses(sums.size());
  std::iota(poses.begin(), poses.end(), 0U);
  const auto keep_best = [&](std::size_t most) {
    if (poses.size() <= most) return;
    std::ranges::nth_element(poses, poses.begin() + static_cast<std::ptrdiff_t>(most), {},
                             [&](std::uint32_t i) { return std::pair(-sums[i], i); });
    poses.resize(most);
  };
  keep_best(std::max(kMinSecond, sums.size() / kSecondShare));
  for (const std::uint32_t i : poses) {
    const Eigen::Vector2d& place = places[i % places.size()];
    const PlaneFrame frame({place, yaw_rad(i)});
    for (std::size_t e = 0; e < echoes.size(); ++e) {
      if (e % kFirstEchoes == 0) continue;
      const Eigen::Vector2d end = frame * echoes[e].end_m();
      sums[i] += tables[e][field.value_at(end.x(), end.y())];
    }
  }
  keep_best(kBest);
  std::vector<ScoredPose> best;
  for (const std::uint32_t i : poses) {
    const Eigen::Vector2d& place = places[i % places.size()];
    best.push_back({{place, yaw_rad(i)}, sums[i]});
  }
  return without_neighbours(std::move(best), 1.5 * step_m, 1.5 * yaw_step, kCandidates);
}

/// Steps of a pose, halved each time that none is better.
struct Steps {
  double m, rad;
  int halvings;
};

/// The best pose near one, by `score` of a pose and the least that counts.
template <class Score>
ScoredPose climb(const Pose2& from, Steps steps, const Score& score) {
  ScoredPose best{from, score(from)};
  const auto try_step = [&](double dx, double dy, double dyaw) {
    const Pose2 pose{best.pose.place_m + Eigen::Vector2d(dx, dy), best.pose.yaw_rad + dyaw};
    const double here = score(pose);
    if (here <= best.log_likelihood) return false;
    best = {pose, here};
    return true;
  };
  constexpr int kRounds = 4;
  for (int halving = 0; halving <= steps.halvings; ++halving) {
    for (int round = 0; round < kRounds; ++round) {
      bool moved = false;
      for (const double sign : {-1.0, 1.0}) {
        moved |= try_step(sign * steps.m, 0.0, 0.0);
        moved |= try_step(0.0, sign * steps.m, 0.0);
        moved |= try_step(0.0, 0.0, sign * steps.rad);
      }
      if (!moved) break;
    }
    steps.m *= 0.5;
    steps.rad *= 0.5;
  }
  return best;
}

}  // namespace

std::vector<ScoredPose> without_neighbours(std::vector<ScoredPose> poses, double near_m, double near_rad,
                                           std::size_t most) {
  std::ranges::sort(poses, {}, [](const ScoredPose& p) {
    return std::tuple(-p.log_likelihood, p.pose.place_m.x(), p.pose.place_m.y(), p.pose.yaw_rad);
  });
  std::vector<ScoredPose> kept;
  for (const ScoredPose& pose : poses) {
    if (kept.size() >= most) break;
    const bool has_neighbour = std::ranges::any_of(
        kept, [&](const ScoredPose& other) { return is_near(pose.pose, other.pose, near_m, near_rad); });
    if (!has_neighbour) kept.push_back(pose);
  }
  return kept;
}

bool is_distinct(std::span<const ScoredPose> found) {
  constexpr double kDistinct = 5.0;
  const auto& [best, likelihood] = found.front();
  return std::ranges::all_of(found, [&](const ScoredPose& other) {
    return is_near(other.pose, best, kHypothesis_m, kHypothesis_rad) ||
           likelihood - other.log_likelihood >= std::log(kDistinct);
  });
}

ScoredPose refine_pose(std::span<const BeamJudge> judges, const BeamLikelihood& model, const Pose2& from, double step_m,
                       double step_rad) {
  return climb(from, {step_m, step_rad, 4}, [&](const Pose2& pose) { return log_likelihood(judges, pose, model); });
}

std::vector<ScoredPose> search_poses(const DistanceField& field, std::span<const HeardBeam> beams,
                                     const BeamLikelihood& model) {
  const std::vector<HeardBeam> echoes = some_echoes(beams, kCoarseEchoes);
  if (echoes.empty()) return {};
  const double step_m = std::max({kStep_m, field.cell_m(), std::sqrt(field.free_area_m2() * kYawSteps / kMaxPoses)});
  std::vector<ScoredPose> candidates = coarse_search(field, echoes, model, step_m);
  std::vector<BeamJudge> judges;
  for (const HeardBeam& beam : beams) judges.emplace_back(beam, field, model);
  const Steps steps{0.5 * step_m, std::numbers::pi / kYawSteps, 1};
  const auto at_ends = [&](const Pose2& pose) {
    const PlaneFrame frame(pose);
    double sum = 0.0;
    for (const BeamJudge& judge : judges) sum += judge.log_at_end(frame);
    return sum;
  };
  for (ScoredPose& candidate : candidates) {
    candidate = climb(candidate.pose, steps, at_ends);
    candidate.log_likelihood = log_likelihood(judges, candidate.pose, model);
  }
  candidates = without_neighbours(std::move(candidates), 0.3, 10.0 * kDegree_rad, kRefined);
  for (ScoredPose& candidate : candidates) {
    candidate = refine_pose(judges, model, candidate.pose, 0.5 * steps.m, 0.5 * steps.rad);
  }
  std::vector<ScoredPose> found = without_neighbours(std::move(candidates), 0.3, 10.0 * kDegree_rad, kCandidates);
  if (!found.empty()) {
    const double least = found.front().log_likelihood + kMinLog;
    std::erase_if(found, [&](const ScoredPose& pose) { return pose.log_likelihood < least; });
  }
  return found;
}

}  // namespace pingvox
