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
#include "pingvox/slam/picture_turns.hpp"
#include "slam/causal/causal_estimator.hpp"
#include "slam/odometry/sonar_odometry.hpp"
#include "slam/odometry/velocity_gaps.hpp"
#include "slam/smoother/map_solution.hpp"
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
  errors.require(causal_sweeps >= kSweepsOfStep, "causal_sweeps", fmt::format("{} or more", kSweepsOfStep),
                 causal_sweeps);
  errors.add(filter.validate());
  errors.add(echo.validate());
  return errors.result("slam");
}

struct SlamSmoother::State {
  SlamOptions options;
  SweepAssembler assembler;
  PictureTurns turns;  ///< only where echoes are matched
  std::vector<double> beam_times_s;
  std::vector<HeardSweep> sweeps;
  std::vector<NavSource> sources;

  /// With what there is of the last. @return kUnsupported without beams; kCorrupt when their times do not rise
  Result<std::vector<HeardSweep>> all_sweeps() const;
};

Result<std::vector<HeardSweep>> SlamSmoother::State::all_sweeps() const {
  if (beam_times_s.empty()) return fail(Error::Code::kUnsupported, "there are no beams");
  if (const auto back = std::ranges::adjacent_find(beam_times_s, std::ranges::greater()); back != beam_times_s.end()) {
    return fail(Error::Code::kCorrupt, fmt::format("the times of the beams do not rise: beam {} is at {:.3f} s, the "
                                                   "next at {:.3f} s",
                                                   back - beam_times_s.begin(), *back, *(back + 1)));
  }
  std::vector<HeardSweep> all = sweeps;
  SweepAssembler rest = assembler;
  if (const auto sweep = rest.finish()) all.push_back(heard_sweep(*sweep, options));
  return all;
}

SlamSmoother::SlamSmoother(SlamOptions options) : state_(std::make_unique<State>()) {
  assert(options.validate());
  state_->turns = PictureTurns(options.body_from_sonar);
  state_->options = std::move(options);
}
SlamSmoother::~SlamSmoother() = default;
SlamSmoother::SlamSmoother(SlamSmoother&&) noexcept = default;
SlamSmoother& SlamSmoother::operator=(SlamSmoother&&) noexcept = default;

void SlamSmoother::add(Beam beam) {
  state_->beam_times_s.push_back(beam.time_s);
  if (state_->options.matching == Matching::kPairs) state_->turns.add(beam);
  if (const auto sweep = state_->assembler.add(std::move(beam))) {
    state_->sweeps.push_back(heard_sweep(*sweep, state_->options));
  }
}

Result<void> SlamSmoother::add(std::string_view source, NavQuantity quantity, const NavSample& sample) {
  return add_sample(source, quantity, sample, state_->options.nav_offset_s, state_->sources);
}

Result<void> SlamSmoother::add(const NavLog& log) {
  return detail::without_exceptions([&]() -> Result<void> {
    if (const auto checked = check_sources(log, kReckoningQuantities); !checked) return checked;
    for (NavSource source : log.sources()) {
      if (source.subject == NavSubject::kOther) continue;
      for (NavSample& sample : source.samples) sample.time_s += state_->options.nav_offset_s;
      add_samples(source, source_in(state_->sources, source.name, source.quantity));
    }
    return {};
  });
}

namespace {

/// @return kUnsupported where no heading is known for long while beams come
Result<void> check_headings(std::span<const HeadingSource> headings, std::span<const double> beam_times_s) {
  // Over a longer time the turns of a vehicle are no more than a guess.
  constexpr double kLongest_s = 30.0;
  const TimeSeries& main = headings.front().yaw_rad;
  for (const TimeSpan& gap : main.gaps(main.from_s(), main.to_s())) {
    const bool is_known = std::ranges::any_of(headings, [&](const HeadingSource& heading) {
      return heading.yaw_rad.gap_s(gap.from_s, gap.to_s) <= kLongest_s;
    });
    const auto beams =
        std::ranges::upper_bound(beam_times_s, gap.to_s) - std::ranges::lower_bound(beam_times_s, gap.from_s);
    if (is_known || beams == 0) continue;
    return fail(
        Error::Code::kUnsupported,
        fmt::format("no heading is known from {:.3f} to {:.3f} s, where there are {} beams: did the clock of {} "
                    "jump?",
                    gap.from_s, gap.to_s, beams, headings.front().name));
  }
  return {};
}

/// How far a velocity that the sonar contradicts may be from the truth, instead of how much it scatters.
void allow_noise(double density, VelocitySource& velocity) {
  std::vector<double> densities = velocity.density.values();
  for (double& each : densities) each = std::max(each, density);
  velocity.density = TimeSeries(velocity.density.times_s(), std::move(densities));
}

/// @return for how long [s] the sonar tells the motion where the velocity is missing
Result<double> fill_gaps(SlamInput& recording, const SlamOptions& options) {
  const std::span<const double> times_s = recording.beam_times_s;
  VelocitySource& velocity = recording.navigation.velocity;
  double filled_s = 0.0;
  for (const TimeSpan& gap :
       fill_velocity_gaps(recording.sweeps, {times_s.front(), times_s.back()}, velocity_from_sonar(velocity, options),
                          recording.navigation.headings.front(), velocity)) {
    filled_s += gap.to_s - gap.from_s;
  }
  Result<SlamInput> longer = slam_input_of(times_s, recording.sweeps, std::move(recording.navigation));
  if (!longer) return tl::unexpected(longer.error());
  recording = *std::move(longer);
  return filled_s;
}

Result<SlamSolution> solve_batch(SlamInput recording, const SonarChecks& checks, const SlamOptions& options) {
  VelocitySource& velocity = recording.navigation.velocity;
  const VelocitySource measured = velocity;
  const bool contradicts = checks.contradict_velocity();
  double filled_s = 0.0;
  if (options.matching == Matching::kPairs && !contradicts && !velocity.by_sonar) {
    const Result<double> filled = fill_gaps(recording, options);
    if (!filled) return tl::unexpected(filled.error());
    filled_s = *filled;
  }
  Result<std::vector<double>> times_s = knot_times(recording.span, recording.sweeps, recording.beam_times_s.size());
  if (!times_s) return tl::unexpected(times_s.error());
  const auto checked = check_headings(recording.navigation.headings, recording.beam_times_s);
  if (!checked) return tl::unexpected(checked.error());
  if (contradicts) allow_noise(checks.velocity->difference_m_s * std::sqrt(checks.velocity->over_s), velocity);
  SlamProblem problem(*std::move(times_s), velocity, recording.navigation.headings, options.calibration);
  Unknowns start = problem.dead_reckoning();
  SlamSolver solver = solver_of(std::move(problem), recording, options, std::move(start));
  bool determined = true;
  std::optional<SweepLoops> loops;
  if (options.matching == Matching::kPairs) {
    const bool is_believed = !contradicts && !velocity.by_sonar;
    if (is_believed) solver.expect_steady_motion();
    for (std::size_t i = 0; i < kAlone; ++i) determined = determined && solver.step(std::nullopt);
    if (determined) loops = close_sweep_loops(solver);
    determined = determined && loops;
    const double in_gaps_m = solver.problem().gap_deviation_m(sweep_duration_s(recording.sweeps));
    const double widest_m = is_believed ? kGateOfReach * solver.reach_m() + in_gaps_m : kInfinity;
    for (const double gate_m : kGates_m) determined = determined && solver.step(std::min(gate_m, widest_m));
  }
  std::optional<std::vector<Eigen::Matrix3d>> of_knots;
  if (determined) of_knots = solver.knot_covariances();
  if (!of_knots) {
    return fail(Error::Code::kUnsupported, "the recording does not determine the trajectory");
  }
  const std::vector<double> in_pauses_s = times_in_pauses(recording);
  std::vector<double> poses_s;
  std::ranges::merge(recording.beam_times_s, in_pauses_s, std::back_inserter(poses_s));
  std::vector<StampedPose> poses =
      poses_at(poses_s, solver.problem(), solver.unknowns(), recording.navigation.depth, options);
  begin_at_origin(poses);
  Result<SlamSolution> solution =
      solution_of(solver, options, std::move(poses), in_pauses_s.empty() ? 0.0 : velocity.ahead.usual_limit_s());
  if (!solution) return solution;
  solution->report.in_pauses = static_cast<std::size_t>(
      std::ranges::count_if(in_pauses_s, [&](double time_s) { return solution->trajectory.at(time_s).has_value(); }));
  solution->report.beams = recording.beam_times_s.size();
  solution->report.sweeps = static_cast<std::size_t>(
      std::ranges::count_if(recording.sweeps, [](const HeardSweep& s) { return s.extent != Sweep::Extent::kCut; }));
  solution->covariances = covariances_of(solver, *of_knots, options);
  report_checks(checks, solution->report);
  if (filled_s > 0.0) {
    report_velocity(measured, recording.span, solution->report);
    solution->report.gaps_by_sonar_s = filled_s;
  }
  if (loops) {
    solution->report.submap_loops_found = loops->found;
    solution->report.submap_loops_kept = loops->kept;
  }
  return solution;
}

constexpr std::array kVelocityQuantities = {NavQuantity::kVelocity};

/// The sources, and how the sonar says that the vehicle moved where they have no velocity.
Result<MotionSources> with_sonar_odometry(std::vector<NavSource> sources, std::span<const HeardSweep> sweeps,
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
  if (!odometry.tells) {
    const bool are_too_few = headings.empty() && odometry.matched < kMatchesAlone;
    return fail(Error::Code::kUnsupported,
                fmt::format("there is no valid velocity over ground{}, and the sonar does not tell how the vehicle "
                            "moved: {} of {} sweeps match those before them{}",
                            headings.empty() ? " and no heading" : "", odometry.matched, sweeps.size() - 1,
                            are_too_few ? fmt::format(" (without a heading, {} have to)", kMatchesAlone) : ""));
  }
  SonarSources by_sonar{std::move(odometry.velocity), std::nullopt};
  if (headings.empty()) by_sonar.heading = std::move(odometry.heading);
  return MotionSources{std::move(sources), std::move(by_sonar)};
}

/// All that was recorded, as it came.
Result<SlamSolution> solve_causal(std::span<const double> beam_times_s, std::span<const HeardSweep> sweeps,
                                  std::vector<NavSource> sources, const PictureTurns& turns, SlamOptions options) {
  const Result<NavLog> log = NavLog::make(std::move(sources), NavClock::kUnknown);
  if (!log) return tl::unexpected(log.error());
  options.nav_offset_s = 0.0;  // the sources are on the clock of the beams
  const std::vector<HeadingSource> headings = headings_of(*log, options);
  if (!headings.empty()) {
    if (const auto checked = check_headings(headings, beam_times_s); !checked) return tl::unexpected(checked.error());
  }
  const std::optional<VelocitySource> velocity = velocity_of(*log, options);
  if (!velocity && options.motion == MotionSource::kVelocity) {
    if (const auto checked = check_sources(*log, kVelocityQuantities); !checked) return tl::unexpected(checked.error());
  }
  if (!velocity) options.motion = MotionSource::kSonar;
  CausalEstimator estimator(options);
  auto beam = beam_times_s.begin();
  std::vector<std::size_t> added(log->sources().size(), 0);
  const auto add_until = [&](double time_s) -> Result<void> {
    for (; beam != beam_times_s.end() && *beam <= time_s; ++beam) estimator.add_beam(*beam);
    for (std::size_t s = 0; s < added.size(); ++s) {
      const NavSource& source = log->sources()[s];
      for (; added[s] < source.samples.size() && source.samples[added[s]].time_s <= time_s; ++added[s]) {
        const auto done = estimator.add_sample(source.name, source.quantity, source.samples[added[s]]);
        if (!done) return done;
      }
    }
    return {};
  };
  for (std::size_t end = 1; end < sweeps.size(); ++end) {
    if (const auto done = add_until(sweeps[end - 1].to_s); !done) return tl::unexpected(done.error());
    estimator.add_sweep(sweeps[end - 1]);
    if (end % kSweepsOfStep != 0) continue;
    if (const auto solved = estimator.solve(); !solved) return tl::unexpected(solved.error());
  }
  if (const auto done = add_until(kInfinity); !done) return tl::unexpected(done.error());
  estimator.add_sweep(sweeps.back());
  Result<SlamSolution> solution = estimator.finish();
  // Of all, not of the window.
  if (!solution || solution->report.by_sonar || !velocity) return solution;
  const std::vector<StampedPose>& poses = solution->trajectory.poses();
  report_velocity(*velocity, {poses.front().time_s, poses.back().time_s}, solution->report);
  report_checks(checks_of(*velocity, headings.front(), sweeps, turns, options), solution->report);
  return solution;
}

}  // namespace

Result<SlamSolution> SlamSmoother::solve_in(const DistanceField& map, const Trajectory& near) const {
  return detail::without_exceptions([&]() -> Result<SlamSolution> {
    const SlamOptions& options = state_->options;
    const Result<std::vector<HeardSweep>> sweeps = state_->all_sweeps();
    if (!sweeps) return tl::unexpected(sweeps.error());
    const Result<SlamInput> recording = slam_input_of(state_->beam_times_s, *sweeps, {state_->sources}, options);
    if (!recording) return tl::unexpected(recording.error());
    const Result<NavLog> log = NavLog::make(state_->sources, NavClock::kUnknown);
    if (!log) return tl::unexpected(log.error());
    return solve_in_map(*recording, *log, options, map, near);
  });
}

Result<SlamSolution> SlamSmoother::solve() const {
  return detail::without_exceptions([&]() -> Result<SlamSolution> {
    const SlamOptions& options = state_->options;
    Result<std::vector<HeardSweep>> heard = state_->all_sweeps();
    if (!heard) return tl::unexpected(heard.error());
    const std::vector<HeardSweep>& sweeps = *heard;
    const std::vector<double>& times_s = state_->beam_times_s;
    if (options.estimation == Estimation::kCausal) {
      return solve_causal(times_s, sweeps, state_->sources, state_->turns, options);
    }
    Result<MotionSources> sources = with_sonar_odometry(state_->sources, sweeps, options);
    if (!sources) return tl::unexpected(sources.error());
    Result<SlamInput> recording = slam_input_of(times_s, sweeps, *std::move(sources), options);
    if (!recording) return tl::unexpected(recording.error());
    const Navigation& navigation = recording->navigation;
    const SonarChecks checks =
        checks_of(navigation.velocity, navigation.headings.front(), sweeps, state_->turns, options);
    return solve_batch(*std::move(recording), checks, options);
  });
}

}  // namespace pingvox
