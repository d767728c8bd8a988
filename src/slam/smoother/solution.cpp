#include "slam/smoother/solution.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "base/median.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "slam/odometry/trajectory_gaps.hpp"
#include "slam/smoother/slam_input.hpp"

namespace pingvox {
namespace {

SlamCalibration calibration_of(const SlamSolver& solver) {
  const auto estimate = [&](std::size_t unknown) {
    const auto i = static_cast<Eigen::Index>(unknown);
    return Estimate{solver.unknowns().globals[i], std::sqrt(solver.global_covariance()(i, i))};
  };
  SlamCalibration calibration{solver.problem().velocity().name,
                              estimate(global::kVelocityYaw),
                              estimate(global::kVelocityScale),
                              estimate(global::kWall),
                              estimate(global::kSonarX),
                              estimate(global::kSonarY),
                              {}};
  for (std::size_t s = 0; s < solver.problem().headings().size(); ++s) {
    const std::size_t first = global::heading(s);
    calibration.headings.push_back({solver.problem().headings()[s].name, estimate(first), estimate(first + 1),
                                    estimate(first + 2), estimate(first + 3), estimate(first + 4)});
  }
  return calibration;
}

/// In the order of the globals.
std::vector<std::string> global_names(const SlamProblem& problem) {
  std::vector<std::string> names = {"angle of the velocity", "scale of the velocity", "place of the wall in an echo",
                                    "place of the sonar ahead", "place of the sonar to port"};
  for (const HeadingSource& heading : problem.headings()) {
    for (const char* part : {"constant", "sin1", "cos1", "sin2", "cos2"}) {
      names.push_back(fmt::format("{} of heading {}", part, heading.name));
    }
  }
  return names;
}

/// Names of the calibration for which is_one(estimate, prior) is true; what is fixed is left out.
template <class IsOne>
std::vector<std::string> names_of_globals(const SlamSolver& solver, IsOne&& is_one) {
  std::vector<std::string> found;
  const std::vector<std::string> names = global_names(solver.problem());
  const std::vector<Estimate> priors = solver.problem().global_priors();
  for (std::size_t g = 0; g < priors.size(); ++g) {
    const auto i = static_cast<Eigen::Index>(g);
    if (priors[g].deviation <= kHeld) continue;
    const Estimate now{solver.unknowns().globals[i], std::sqrt(solver.global_covariance()(i, i))};
    if (is_one(now, priors[g])) found.push_back(names[g]);
  }
  return found;
}

std::vector<std::string> not_observable(const SlamSolver& solver) {
  constexpr double kLargeShare = 0.5;
  return names_of_globals(solver, [](const Estimate& now, const Estimate& before) {
    return now.deviation * now.deviation > kLargeShare * before.deviation * before.deviation;
  });
}

std::vector<std::string> implausible(const SlamSolver& solver) {
  constexpr double kDeviations = 4.0;
  return names_of_globals(solver, [](const Estimate& now, const Estimate& before) {
    return std::abs(now.value - before.value) > kDeviations * before.deviation;
  });
}

SlamReport report_of(const SlamSolver& solver) {
  const VelocitySource& velocity = solver.problem().velocity();
  SlamReport report;
  report.echoes = solver.echoes();
  report.knots = solver.problem().knots();
  report.pairs.count = solver.pairs().pairs.size();
  std::vector<double> distances_m;
  for (const EchoPair& pair : solver.pairs().pairs) distances_m.push_back(std::abs(pair.distance_m));
  if (!distances_m.empty()) report.pairs.median_m = median(std::move(distances_m));
  report.pairs.loops = {solver.pairs().loops_found, solver.pairs().loops_kept};
  const std::vector<double>& knots_s = solver.problem().knot_times_s();
  report_velocity(velocity, {knots_s.front(), knots_s.back()}, report.velocity);
  report.heading = solver.problem().headings().front().name;
  if (velocity.by_sonar) {
    double variance_m2 = 0.0;
    for (const SlamProblem::Way& way : solver.problem().ways(solver.unknowns())) {
      variance_m2 += way.with_steady_m * way.with_steady_m;
    }
    // The first and the last sample go on to the ends of the recording.
    report.velocity.by_sonar = {velocity.ahead.size() - 2, velocity.density.values().front(), std::sqrt(variance_m2)};
  }
  return report;
}

}  // namespace

void report_velocity(const VelocitySource& velocity, const TimeSpan& span, VelocityReport& report) {
  report.samples = velocity.ahead.size();
  report.clipped = velocity.clipped;
  report.longest_gap_s = std::max(
      {velocity.ahead.longest_step_s(), velocity.ahead.from_s() - span.from_s, span.to_s - velocity.ahead.to_s()});
  report.source = velocity.name;
}

std::vector<StampedPose> poses_at(std::span<const double> times_s, const SlamProblem& problem, const Unknowns& unknowns,
                                  const std::optional<TimeSeries>& depth, const SlamOptions& options) {
  const Eigen::Vector3d velocity_m = place_of_velocity(problem.velocity(), options);
  const HeadingSource& main = problem.headings().front();
  const std::vector<SlamProblem::Way> ways = problem.ways(unknowns);
  std::vector<StampedPose> poses;
  for (const double time_s : times_s) {
    const auto between = problem.between_knots(time_s);
    if (!between || (!poses.empty() && time_s <= poses.back().time_s)) continue;
    const auto [knot, share] = *between;
    const Eigen::Vector3d state = unknowns.at(knot, share);
    const Eigen::Vector2d place = state.head<2>() + problem.bulge(unknowns, ways[knot], knot, time_s);
    Pose pose = pose_from_rpy({place.x(), place.y(), depth ? -depth->at(time_s) : 0.0},
                              main.roll_rad ? main.roll_rad->at(time_s) : 0.0,
                              main.pitch_rad ? main.pitch_rad->at(time_s) : 0.0, main.yaw_rad.at(time_s) + state.z());
    // The knots are where the velocity is measured.
    const Eigen::Vector3d offset = pose.rotation() * Eigen::Vector3d(velocity_m.x(), velocity_m.y(), 0.0);
    pose.translation().head<2>() -= offset.head<2>();
    poses.push_back({time_s, pose});
  }
  return poses;
}

std::vector<PoseCovariance> covariances_of(const SlamSolver& solver, const std::vector<Eigen::Matrix3d>& of_knots,
                                           const SlamOptions& options) {
  const Eigen::Vector2d velocity_m = place_of_velocity(solver.problem().velocity(), options).head<2>();
  std::vector<PoseCovariance> covariances;
  for (std::size_t k = 0; k < of_knots.size(); ++k) {
    const double time_s = solver.problem().knot_times_s()[k];
    const double yaw_rad = solver.problem().main_yaw_rad(time_s) + solver.unknowns().knots[k].z();
    Eigen::Matrix3d body_by_knot = Eigen::Matrix3d::Identity();
    body_by_knot.block<2, 1>(0, 2) = -quarter_turn(rotation2(yaw_rad) * velocity_m);
    covariances.push_back({time_s, body_by_knot * of_knots[k] * body_by_knot.transpose()});
  }
  return covariances;
}

void begin_at_origin(std::vector<StampedPose>& poses) {
  if (poses.empty()) return;
  const Eigen::Vector2d origin = poses.front().map_from_body.translation().head<2>();
  for (StampedPose& pose : poses) pose.map_from_body.translation().head<2>() -= origin;
}

std::vector<double> times_in_pauses(const SlamInput& recording) {
  const TimeSeries& velocity = recording.navigation.velocity.ahead;
  const TimeSeries& heading = recording.navigation.headings.front().yaw_rad;
  std::vector<double> found;
  if (recording.navigation.velocity.by_sonar) return found;
  std::vector<double> beams_s(recording.beam_times_s.begin(), recording.beam_times_s.end());
  beams_s.erase(std::ranges::unique(beams_s).begin(), beams_s.end());
  const TimeSeries beams(beams_s, std::vector<double>(beams_s.size()));
  for (const auto& [from_s, to_s] : beams.gaps(beams.from_s(), beams.to_s())) {
    if (velocity.gap_s(from_s, to_s) > 0.0 || heading.gap_s(from_s, to_s) > 0.0) continue;
    const std::vector<double>& times_s = velocity.times_s();
    std::copy(std::ranges::upper_bound(times_s, from_s), std::ranges::lower_bound(times_s, to_s),
              std::back_inserter(found));
  }
  return found;
}

Result<SlamSolution> solution_of(const SlamSolver& solver, const SlamOptions& options, std::vector<StampedPose> poses,
                                 double least_gap_s) {
  if (poses.empty()) return fail(Error::Code::kUnsupported, "no beam is within the time of the navigation");
  Result<Trajectory> trajectory = trajectory_with_gaps(std::move(poses), least_gap_s);
  if (!trajectory) return tl::unexpected(trajectory.error());
  SlamSolution solution{*std::move(trajectory), {}, {}, report_of(solver)};
  if (options.matching == Matching::kPairs) {
    solution.calibration = calibration_of(solver);
    solution.report.not_observable = not_observable(solver);
    solution.report.implausible = implausible(solver);
  }
  return solution;
}

}  // namespace pingvox
