#include "pingvox/nav/trajectory_score.hpp"

#include <fmt/core.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pingvox/geometry/pose2.hpp"

namespace pingvox {
namespace {

/// Horizontal positions at the same time, from the first of the reference so that large coordinates lose no digits.
struct Match {
  Eigen::Vector2d ours, reference;
};

template <class ErrorOf>
ErrorStatistics statistics_of(const std::vector<Match>& matches, ErrorOf error_of) {
  const auto count = static_cast<double>(matches.size());
  ErrorStatistics statistics;
  double squares = 0.0;
  for (const Match& match : matches) {
    const double error_m = error_of(match).norm();
    statistics.mean_m += error_m / count;
    squares += error_m * error_m / count;
    statistics.max_m = std::max(statistics.max_m, error_m);
  }
  double deviations = 0.0;
  for (const Match& match : matches) {
    const double deviation_m = error_of(match).norm() - statistics.mean_m;
    deviations += deviation_m * deviation_m / count;
  }
  statistics.sd_m = std::sqrt(deviations);
  statistics.rmse_m = std::sqrt(squares);
  return statistics;
}

void set_relative_error(TrajectoryScore& score, const std::vector<Match>& matches, const Eigen::Rotation2Dd& turn) {
  score.per_m = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> path_m = {0.0};
  for (std::size_t i = 1; i < matches.size(); ++i) {
    path_m.push_back(path_m.back() + (matches[i].reference - matches[i - 1].reference).norm());
  }
  score.segment_m = path_m.back() / 10.0;
  if (!(score.segment_m > 0.0)) return;
  double squares = 0.0;
  std::size_t segments = 0;
  for (std::size_t begin = 0, end = 0; begin < matches.size(); ++begin) {
    while (end < matches.size() && path_m[end] - path_m[begin] < score.segment_m) ++end;
    if (end == matches.size()) break;
    const Eigen::Vector2d ours = matches[end].ours - matches[begin].ours;
    const Eigen::Vector2d reference = matches[end].reference - matches[begin].reference;
    squares += (turn * ours - reference).squaredNorm() / std::pow(path_m[end] - path_m[begin], 2);
    ++segments;
  }
  score.per_m = std::sqrt(squares / static_cast<double>(segments));
}

}  // namespace

Result<TrajectoryScore> score_trajectory(const Trajectory& trajectory, const Trajectory& reference) {
  TrajectoryScore score;
  std::vector<Match> matches;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  for (const StampedPose& pose : reference.poses()) {
    const auto ours = trajectory.at(pose.time_s);
    if (!ours) {
      ++score.outside;
      continue;
    }
    const Eigen::Vector3d at = ours->translation(), true_at = pose.map_from_body.translation();
    if (matches.empty()) origin = true_at.head<2>();
    matches.push_back({at.head<2>() - origin, true_at.head<2>() - origin});
    score.max_difference_m = std::max(score.max_difference_m, (at - true_at).norm());
  }
  if (matches.empty()) {
    const auto span_of = [](const Trajectory& of) {
      return fmt::format("from {:.3f} to {:.3f} s", of.poses().front().time_s, of.poses().back().time_s);
    };
    return fail(Error::Code::kUnsupported, fmt::format("the trajectory and its reference are never known at the same "
                                                       "time: the trajectory is {}, the reference {}",
                                                       span_of(trajectory), span_of(reference)));
  }
  score.poses = matches.size();

  Match mean{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  std::vector<Eigen::Vector2d> ours_m, references_m;
  for (const Match& match : matches) {
    mean.ours += match.ours / static_cast<double>(matches.size());
    mean.reference += match.reference / static_cast<double>(matches.size());
    ours_m.push_back(match.ours);
    references_m.push_back(match.reference);
  }
  score.se2_turn_rad = fit_pose2(ours_m, references_m).yaw_rad;
  const Eigen::Rotation2Dd turn(score.se2_turn_rad);
  const auto shifted_from = [](const Match& at) {
    return [&at](const Match& match) -> Eigen::Vector2d {
      return (match.ours - at.ours) - (match.reference - at.reference);
    };
  };
  score.none =
      statistics_of(matches, [](const Match& match) -> Eigen::Vector2d { return match.ours - match.reference; });
  score.first_fix = statistics_of(matches, shifted_from(matches.front()));
  score.translation = statistics_of(matches, shifted_from(mean));
  score.se2 = statistics_of(matches, [&](const Match& match) -> Eigen::Vector2d {
    return turn * (match.ours - mean.ours) - (match.reference - mean.reference);
  });
  set_relative_error(score, matches, turn);
  for (const ErrorStatistics& error : {score.none, score.first_fix, score.translation, score.se2}) {
    if (!std::isfinite(error.rmse_m)) {
      return fail(Error::Code::kUnsupported, "positions are so far apart that their errors exceed the range of double");
    }
  }
  return score;
}

}  // namespace pingvox
