#include "pingvox/slam/slam_smoother.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "base/option_errors.hpp"
#include "base/without_exceptions.hpp"
#include "slam/odometry/sonar_odometry.hpp"
#include "slam/odometry/velocity_gaps.hpp"
#include "slam/smoother/map_solution.hpp"
#include "slam/smoother/slam_data.hpp"
#include "slam/smoother/slam_input.hpp"
#include "slam/smoother/slam_problem.hpp"
#include "slam/smoother/slam_solver.hpp"
#include "slam/smoother/solution.hpp"
#include "slam/smoother/sonar_checks.hpp"
#include "slam/smoother/sweep_loops.hpp"
#include "slam/sweeps/level_head.hpp"

namespace pingvox {
namespace {

/// How far apart the echoes of a pair may be, in each iteration.
constexpr std::array<double, 18> kGates_m = {10.0, 8.0, 6.0, 5.0, 4.0, 3.0, 3.0, 2.5, 2.0,
                                             2.0,  1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5};
/// Iterations without pairs: the problem is nearly linear then.
constexpr std::size_t kAlone = 4;

}  // namespace

PlaceEllipse place_ellipse(const Eigen::Matrix3d& covariance) {
  const double xx = covariance(0, 0), xy = covariance(0, 1), yy = covariance(1, 1);
  const double mean = 0.5 * (xx + yy), radius = std::hypot(0.5 * (xx - yy), xy);
  return {std::sqrt(mean + radius), std::sqrt(std::max(0.0, mean - radius)), 0.5 * std::atan2(2.0 * xy, xx - yy)};
}

Result<void> SlamOptions::validate() const {
  OptionErrors errors;
  errors.require(std::isfinite(nav_offset_s), "nav_offset_s", "finite", nav_offset_s);
  if (!body_from_sonar.matrix().allFinite() || !is_level(body_from_sonar)) {
    errors.add(
        "body_from_sonar, the mount of the sonar, must be finite and level within 45 degrees, upside down or not");
  }
  errors.require(sound_speed_ratio > 0.0 && std::isfinite(sound_speed_ratio), "sound_speed_ratio", "finite and above 0",
                 sound_speed_ratio);
  if (calibration) {
    if (const auto valid = calibration->validate(); !valid) errors.add("calibration: " + valid.error().message);
  }
  errors.require(causal_sweeps >= kMinCausalSweeps, "causal_sweeps", fmt::format("{} or more", kMinCausalSweeps),
                 causal_sweeps);
  errors.add(filter.validate());
  errors.add(echo.validate());
  return errors.result("slam");
}

struct SlamSmoother::State {
  SlamData log;
};

SlamSmoother::SlamSmoother(SlamOptions options)
    : state_(std::make_unique<State>(State{SlamData(std::move(options))})) {}
SlamSmoother::~SlamSmoother() = default;
SlamSmoother::SlamSmoother(SlamSmoother&&) noexcept = default;
SlamSmoother& SlamSmoother::operator=(SlamSmoother&&) noexcept = default;

void SlamSmoother::add(Beam beam) {
  state_->log.add(std::move(beam));
}

Result<void> SlamSmoother::add(std::string_view source, NavQuantity quantity, const NavSample& sample) {
  return state_->log.add(source, quantity, sample);
}

Result<void> SlamSmoother::add(const NavLog& log) {
  return state_->log.add(log);
}

namespace {

/// How far a velocity that the sonar contradicts may be from the truth, instead of how much it scatters.
void allow_noise(double density, VelocitySource& velocity) {
  std::vector<double> densities = velocity.density.values();
  for (double& each : densities) each = std::max(each, density);
  velocity.density = TimeSeries(velocity.density.times_s(), std::move(densities));
}

/// @return for how long [s] the sonar tells the motion where the velocity is missing
Result<double> fill_gaps(SlamInput& input, const SlamOptions& options) {
  const std::span<const double> times_s = input.beam_times_s;
  VelocitySource& velocity = input.navigation.velocity;
  double filled_s = 0.0;
  for (const TimeSpan& gap :
       fill_velocity_gaps(input.sweeps, {times_s.front(), times_s.back()}, velocity_from_sonar(velocity, options),
                          input.navigation.headings.front(), velocity)) {
    filled_s += gap.to_s - gap.from_s;
  }
  Result<SlamInput> longer = slam_input_of(times_s, input.sweeps, std::move(input.navigation));
  if (!longer) return tl::unexpected(longer.error());
  input = *std::move(longer);
  return filled_s;
}

Result<SlamSolution> solve_batch(SlamInput input, const SonarChecks& checks, const SlamOptions& options) {
  VelocitySource& velocity = input.navigation.velocity;
  const VelocitySource measured = velocity;
  const bool contradicts = checks.contradict_velocity();
  double filled_s = 0.0;
  if (options.matching == Matching::kPairs && !contradicts && !velocity.by_sonar) {
    const Result<double> filled = fill_gaps(input, options);
    if (!filled) return tl::unexpected(filled.error());
    filled_s = *filled;
  }
  Result<std::vector<double>> times_s = knot_times(input.span, input.sweeps, input.beam_times_s.size());
  if (!times_s) return tl::unexpected(times_s.error());
  const auto checked = check_headings(input.navigation.headings, input.beam_times_s);
  if (!checked) return tl::unexpected(checked.error());
  if (contradicts) allow_noise(checks.velocity->difference_m_s * std::sqrt(checks.velocity->over_s), velocity);
  SlamProblem problem(*std::move(times_s), velocity, input.navigation.headings, options.calibration);
  Unknowns start = problem.dead_reckoning();
  SlamSolver solver = solver_of(std::move(problem), input, options, std::move(start));
  bool determined = true;
  std::optional<SweepLoops> loops;
  if (options.matching == Matching::kPairs) {
    const bool is_trusted = !contradicts && !velocity.by_sonar;
    if (is_trusted) solver.expect_steady_motion();
    for (std::size_t i = 0; i < kAlone; ++i) determined = determined && solver.step(std::nullopt);
    if (determined) loops = close_sweep_loops(solver);
    determined = determined && loops;
    const double in_gaps_m = solver.problem().gap_deviation_m(sweep_duration_s(input.sweeps));
    const double widest_m = is_trusted ? kGateOfReach * solver.reach_m() + in_gaps_m : kInfinity;
    for (const double gate_m : kGates_m) determined = determined && solver.step(std::min(gate_m, widest_m));
  }
  std::optional<std::vector<Eigen::Matrix3d>> of_knots;
  if (determined) of_knots = solver.knot_covariances();
  if (!of_knots) {
    return fail(Error::Code::kUnsupported, "the recording does not determine the trajectory");
  }
  const std::vector<double> in_pauses_s = times_in_pauses(input);
  std::vector<double> poses_s;
  std::ranges::merge(input.beam_times_s, in_pauses_s, std::back_inserter(poses_s));
  std::vector<StampedPose> poses =
      poses_at(poses_s, solver.problem(), solver.unknowns(), input.navigation.depth, options);
  begin_at_origin(poses);
  Result<SlamSolution> solution =
      solution_of(solver, options, std::move(poses), in_pauses_s.empty() ? 0.0 : velocity.ahead.usual_limit_s());
  if (!solution) return solution;
  solution->report.in_pauses = static_cast<std::size_t>(
      std::ranges::count_if(in_pauses_s, [&](double time_s) { return solution->trajectory.at(time_s).has_value(); }));
  solution->report.beams = input.beam_times_s.size();
  solution->report.sweeps = static_cast<std::size_t>(
      std::ranges::count_if(input.sweeps, [](const SweepEchoes& s) { return s.extent != Sweep::Extent::kCut; }));
  solution->covariances = covariances_of(solver, *of_knots, options);
  report_checks(checks, solution->report);
  if (filled_s > 0.0) {
    report_velocity(measured, input.span, solution->report.velocity);
    solution->report.velocity.gaps_by_sonar_s = filled_s;
  }
  if (loops) solution->report.pairs.submap_loops = {loops->found, loops->kept};
  return solution;
}

/// The sources, and how the sonar says that the vehicle moved where they have no velocity.
Result<MotionSources> with_sonar_odometry(std::vector<NavSource> sources, std::span<const SweepEchoes> sweeps,
                                          const SlamOptions& options) {
  const Result<NavLog> log = NavLog::make(sources, NavClock::kUnknown);
  if (!log) return tl::unexpected(log.error());
  if (options.motion == MotionSource::kVelocity) {
    if (velocity_of(*log, options)) return MotionSources{std::move(sources)};
    if (const auto checked = check_sources(*log, kVelocityQuantities); !checked) return tl::unexpected(checked.error());
  }
  if (sweeps.size() < 2) {
    return fail(Error::Code::kUnsupported,
                "there is no valid velocity over ground, and there is only one sweep: nothing to match it with");
  }
  const std::vector<HeadingSource> headings = headings_of(*log, options);
  if (!headings.empty()) {
    const TimeSpan beams{sweeps.front().from_s, sweeps.back().to_s};
    const HeadingSource& main = headings.front();
    if (!overlap(beams, main.yaw_rad)) return no_overlap(beams, main.yaw_rad, "heading of " + main.name);
  }
  SonarOdometry odometry =
      sonar_odometry(sweeps, pose2_of(options.body_from_sonar), headings.empty() ? nullptr : &headings.front());
  if (!odometry.is_observable) {
    const bool are_too_few = headings.empty() && odometry.matched < kMatchesAlone;
    return fail(Error::Code::kUnsupported,
                fmt::format("there is no valid velocity over ground{}, and motion cannot be estimated from the sonar: "
                            "{} of {} sweeps match those before them{}",
                            headings.empty() ? " and no heading" : "", odometry.matched, sweeps.size() - 1,
                            are_too_few ? fmt::format(" (without a heading, {} have to)", kMatchesAlone) : ""));
  }
  SonarSources by_sonar{std::move(odometry.velocity), std::nullopt};
  if (headings.empty()) by_sonar.heading = std::move(odometry.heading);
  return MotionSources{std::move(sources), std::move(by_sonar)};
}

}  // namespace

Result<MapSolution> SlamSmoother::solve_in(const DistanceField& map, const Trajectory& near) const {
  return detail::without_exceptions([&]() -> Result<MapSolution> {
    const SlamData& heard = state_->log;
    const Result<std::vector<SweepEchoes>> sweeps = heard.sweeps();
    if (!sweeps) return tl::unexpected(sweeps.error());
    const Result<SlamInput> input = slam_input_of(heard.beam_times_s(), *sweeps, {heard.sources()}, heard.options());
    if (!input) return tl::unexpected(input.error());
    const Result<NavLog> log = NavLog::make(heard.sources(), NavClock::kUnknown);
    if (!log) return tl::unexpected(log.error());
    return solve_in_map(*input, *log, heard.options(), map, near);
  });
}

Result<SlamSolution> SlamSmoother::solve() const {
  return detail::without_exceptions([&]() -> Result<SlamSolution> {
    const SlamData& heard = state_->log;
    const SlamOptions& options = heard.options();
    const Result<std::vector<SweepEchoes>> sweeps = heard.sweeps();
    if (!sweeps) return tl::unexpected(sweeps.error());
    Result<MotionSources> sources = with_sonar_odometry(heard.sources(), *sweeps, options);
    if (!sources) return tl::unexpected(sources.error());
    Result<SlamInput> input = slam_input_of(heard.beam_times_s(), *sweeps, *std::move(sources), options);
    if (!input) return tl::unexpected(input.error());
    const Navigation& navigation = input->navigation;
    const SonarChecks checks =
        checks_of(navigation.velocity, navigation.headings.front(), *sweeps, heard.turns(), options);
    return solve_batch(*std::move(input), checks, options);
  });
}

}  // namespace pingvox
