#include "pingvox/slam/slam_smoother.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>

#include "slam/echo_runs.hpp"
#include "slam/navigation.hpp"
#include "slam/pose2.hpp"
#include "slam/slam_problem.hpp"
#include "slam/slam_solver.hpp"
#include "slam/sonar_odometry.hpp"
#include "slam/sweep_loops.hpp"

namespace pingvox {
namespace {

constexpr double kKnotsOfSweep = 4.0;
/// How far apart the echoes of a pair may be, in each iteration.
constexpr std::array<double, 18> kGates_m = {10.0, 8.0, 6.0, 5.0, 4.0, 3.0, 3.0, 2.5, 2.0,
                                             2.0,  1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5};
/// Iterations without pairs: the problem is nearly linear then.
constexpr std::size_t kAlone = 4;
/// Causal: solved anew after so many sweeps, from where the last solution was.
constexpr std::size_t kSweepsOfStep = 2;
constexpr std::array<double, 3> kCausalGates_m = {3.0, 2.0, 1.5};
/// For so long the compasses' deviations are found, and the frame of the poses turns with them.
constexpr double kSettle_s = 600.0;
/// As many samples as around, but earlier ones.
constexpr OutlierWindow kEarlier = {10, 0};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

SonarMount sonar_mount(const Pose& pose) {
  return {pose.translation().head<2>(), std::atan2(pose.rotation()(1, 0), pose.rotation()(0, 0))};
}

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
                                    "place of the sonar, ahead", "place of the sonar, to port"};
  for (const HeadingSource& heading : problem.headings()) {
    for (const char* part : {"constant", "sin1", "cos1", "sin2", "cos2"}) {
      names.push_back(fmt::format("{} of heading {}", part, heading.name));
    }
  }
  return names;
}

std::vector<std::string> not_observable(const SlamSolver& solver) {
  constexpr double kMostOfVariance = 0.5;
  std::vector<std::string> unknown;
  const std::vector<std::string> names = global_names(solver.problem());
  const std::vector<Estimate> priors = solver.problem().global_priors();
  for (std::size_t g = 0; g < priors.size(); ++g) {
    const auto i = static_cast<Eigen::Index>(g);
    if (priors[g].deviation <= kHeld) continue;
    const double before = priors[g].deviation * priors[g].deviation;
    if (solver.global_covariance()(i, i) > kMostOfVariance * before) unknown.push_back(names[g]);
  }
  return unknown;
}

}  // namespace

PlaceEllipse place_ellipse(const Eigen::Matrix3d& covariance) {
  const double xx = covariance(0, 0), xy = covariance(0, 1), yy = covariance(1, 1);
  const double mean = 0.5 * (xx + yy), radius = std::hypot(0.5 * (xx - yy), xy);
  return {std::sqrt(mean + radius), std::sqrt(std::max(0.0, mean - radius)), 0.5 * std::atan2(2.0 * xy, xx - yy)};
}

Result<void> SlamOptions::validate() const {
  if (!std::isfinite(nav_offset_s)) return fail(Error::Code::kBadOption, "nav_offset_s: must be finite");
  if (!(sound_speed_ratio > 0.0) || !std::isfinite(sound_speed_ratio)) {
    return fail(Error::Code::kBadOption, "sound_speed_ratio: must be finite and above 0");
  }
  if (calibration) {
    if (const auto valid = calibration->validate(); !valid) {
      return fail(valid.error().code, "calibration: " + valid.error().message);
    }
  }
  if (causal_sweeps < kSweepsOfStep) {
    return fail(Error::Code::kBadOption, fmt::format("causal_sweeps: must be {} or more", kSweepsOfStep));
  }
  if (const auto valid = filter.validate(); !valid) return valid;
  return echo.validate();
}

struct SlamSmoother::State {
  SlamOptions options;
  SweepAssembler assembler;
  std::vector<double> beam_times_s;
  std::vector<HeardSweep> sweeps;
  std::vector<NavSource> sources;

  HeardSweep heard(const Sweep& sweep) const {
    HeardSweep heard{sweep.extent, sweep.beams.front().time_s, sweep.beams.back().time_s,
                     echo_runs(sweep, options.filter, options.echo)};
    for (EchoRun& run : heard.runs) {
      run.middle_m *= options.sound_speed_ratio;
      run.half_length_m *= options.sound_speed_ratio;
    }
    return heard;
  }
};

SlamSmoother::SlamSmoother(SlamOptions options) : state_(std::make_unique<State>()) {
  assert(options.validate());
  state_->options = std::move(options);
}
SlamSmoother::~SlamSmoother() = default;
SlamSmoother::SlamSmoother(SlamSmoother&&) noexcept = default;
SlamSmoother& SlamSmoother::operator=(SlamSmoother&&) noexcept = default;

void SlamSmoother::add(Beam beam) {
  state_->beam_times_s.push_back(beam.time_s);
  if (const auto sweep = state_->assembler.add(std::move(beam))) state_->sweeps.push_back(state_->heard(*sweep));
}

Result<void> SlamSmoother::add(std::string_view source, NavQuantity quantity, const NavSample& sample) {
  if (!std::isfinite(sample.time_s) || !sample.value.allFinite()) {
    return fail(Error::Code::kCorrupt,
                fmt::format("{} of {}: a sample has a number that is not finite", name_of(quantity), source));
  }
  auto known = std::ranges::find_if(state_->sources,
                                    [&](const NavSource& s) { return s.quantity == quantity && s.name == source; });
  if (known == state_->sources.end()) {
    state_->sources.push_back({std::string(source), quantity, {}});
    known = state_->sources.end() - 1;
  }
  known->samples.push_back(sample);
  known->samples.back().time_s += state_->options.nav_offset_s;
  return {};
}

Result<void> SlamSmoother::add(const NavLog& log) {
  for (const NavSource& source : log.sources()) {
    for (const NavSample& sample : source.samples) {
      if (const auto added = add(source.name, source.quantity, sample); !added) return added;
    }
  }
  return {};
}

namespace {

Pose mount_of(const SlamOptions& options, const std::string& source) {
  const auto mount = options.body_from_source.find(source);
  return mount == options.body_from_source.end() ? Pose::Identity() : mount->second;
}

/// What is used of the navigation, the heading with most samples first.
struct Navigation {
  VelocitySource velocity;
  std::vector<HeadingSource> headings;
  std::optional<TimeSeries> depth;
};

std::optional<VelocitySource> velocity_of(const NavLog& log, const SlamOptions& options) {
  const NavSource* fastest = log.best(NavQuantity::kVelocity);
  if (fastest == nullptr) return std::nullopt;
  if (fastest->name == kSonarSource) return sonar_velocity(*fastest);
  const OutlierWindow window = options.estimation == Estimation::kCausal ? kEarlier : OutlierWindow{};
  return velocity_source(*fastest, mount_of(options, fastest->name), window);
}

/// All headings, the one with the most samples first. Without any, how the turn rates turn.
std::vector<HeadingSource> headings_of(const NavLog& log, const SlamOptions& options) {
  std::vector<HeadingSource> headings, turns;
  for (const NavSource& source : log.sources()) {
    const Pose mount = mount_of(options, source.name);
    if (source.quantity == NavQuantity::kHeading || source.quantity == NavQuantity::kAttitude) {
      auto heading = heading_source(source, mount);
      if (!heading) continue;
      heading->drifts = source.name == kSonarSource;
      headings.push_back(*std::move(heading));
    } else if (source.quantity == NavQuantity::kTurnRate) {
      if (auto heading = turned_heading(source, mount)) turns.push_back(*std::move(heading));
    }
  }
  if (headings.empty()) headings = std::move(turns);
  std::ranges::sort(headings, [](const HeadingSource& a, const HeadingSource& b) {
    return std::tuple(b.yaw_rad.size(), a.name) < std::tuple(a.yaw_rad.size(), b.name);
  });
  return headings;
}

Result<Navigation> navigation_of(const NavLog& log, const SlamOptions& options) {
  for (const auto& [name, mount] : options.body_from_source) {
    if (std::ranges::find(log.sources(), name, &NavSource::name) != log.sources().end()) continue;
    std::string known;
    for (const NavSource& source : log.sources()) known += (known.empty() ? "" : ", ") + source.name;
    return fail(Error::Code::kBadOption,
                fmt::format("'{}' has a mount, but is no source of the navigation: {}", name, known));
  }
  std::optional<VelocitySource> velocity = velocity_of(log, options);
  std::vector<HeadingSource> headings = headings_of(log, options);
  if (!velocity || headings.empty()) {
    return fail(Error::Code::kUnsupported,
                fmt::format("the navigation has no valid {}", !velocity && headings.empty() ? "velocity and no heading"
                                                              : !velocity                   ? "velocity over ground"
                                                                                            : "heading or attitude"));
  }
  if (options.calibration && options.calibration->velocity != velocity->name) {
    return fail(Error::Code::kBadOption, fmt::format("the calibration is of the velocity of {}, not of {}",
                                                     options.calibration->velocity, velocity->name));
  }
  Navigation navigation{*std::move(velocity), std::move(headings), std::nullopt};
  if (const auto depth = depth_source(log)) navigation.depth = number_source(*depth);
  return navigation;
}

/// A stretch of time.
struct Span {
  double from_s, to_s;
};

bool overlap(const Span& span, const TimeSeries& series) {
  return series.from_s() < span.to_s && series.to_s() > span.from_s;
}

tl::unexpected<Error> no_overlap(const Span& beams, const TimeSeries& series, const std::string& what) {
  return fail(Error::Code::kUnsupported,
              fmt::format("beams and navigation do not overlap in time: the beams are from {:.3f} to {:.3f} s, the "
                          "{} is from {:.3f} to {:.3f} s",
                          beams.from_s, beams.to_s, what, series.from_s(), series.to_s()));
}

/// The time that is common to all that is needed.
Result<Span> common_span(std::span<const double> beam_times_s, const Navigation& navigation) {
  const Span beams{beam_times_s.front(), beam_times_s.back()};
  Span span = beams;
  const auto cut = [&](const TimeSeries& series, const std::string& what) -> Result<void> {
    if (!overlap(span, series)) return no_overlap(beams, series, what);
    span = {std::max(span.from_s, series.from_s()), std::min(span.to_s, series.to_s())};
    return {};
  };
  if (const auto done = cut(navigation.velocity.ahead, "velocity of " + navigation.velocity.name); !done) {
    return tl::unexpected(done.error());
  }
  const HeadingSource& main = navigation.headings.front();
  if (const auto done = cut(main.yaw_rad, "heading of " + main.name); !done) return tl::unexpected(done.error());
  return span;
}

/// Usual time of a sweep: of complete ones, where there are any.
double sweep_duration_s(std::span<const HeardSweep> sweeps) {
  std::vector<double> complete_s, all_s;
  for (const HeardSweep& sweep : sweeps) {
    const double duration_s = sweep.to_s - sweep.from_s;
    if (sweep.extent != Sweep::Extent::kCut) complete_s.push_back(duration_s);
    all_s.push_back(duration_s);
  }
  return median(complete_s.empty() ? std::move(all_s) : std::move(complete_s));
}

Result<std::vector<double>> knot_times(const Span& span, double step_s, std::size_t beams) {
  const double steps = std::max(1.0, std::ceil((span.to_s - span.from_s) / step_s));
  if (!(steps <= static_cast<double>(beams) + kKnotsOfSweep)) {
    return fail(Error::Code::kCorrupt,
                fmt::format("{} beams over {:.6g} s: their times jump", beams, span.to_s - span.from_s));
  }
  std::vector<double> times_s;
  for (double i = 0.0; i < steps; i += 1.0) times_s.push_back(span.from_s + (span.to_s - span.from_s) * i / steps);
  times_s.push_back(span.to_s);
  return times_s;
}

/// What was recorded until some time.
struct Recording {
  std::span<const double> beam_times_s;
  std::span<const HeardSweep> sweeps;
  Navigation navigation;
  Span span;
};

Result<Recording> recording_of(std::span<const double> beam_times_s, std::span<const HeardSweep> sweeps,
                               std::vector<NavSource> sources, const SlamOptions& options) {
  const Result<NavLog> log = NavLog::make(std::move(sources), NavClock::kUnknown);
  if (!log) return tl::unexpected(log.error());
  Result<Navigation> navigation = navigation_of(*log, options);
  if (!navigation) return tl::unexpected(navigation.error());
  const Result<Span> span = common_span(beam_times_s, *navigation);
  if (!span) return tl::unexpected(span.error());
  return Recording{beam_times_s, sweeps, *std::move(navigation), *span};
}

Result<SlamProblem> problem_of(const Recording& recording, const SlamOptions& options) {
  const double step_s = sweep_duration_s(recording.sweeps) / kKnotsOfSweep;
  if (!(step_s > 0.0)) return fail(Error::Code::kUnsupported, "all beams have the same time");
  Result<std::vector<double>> knots = knot_times(recording.span, step_s, recording.beam_times_s.size());
  if (!knots) return tl::unexpected(knots.error());
  return SlamProblem(*std::move(knots), recording.navigation.velocity, recording.navigation.headings,
                     options.calibration);
}

SlamSolver solver_of(SlamProblem problem, const Recording& recording, const SlamOptions& options, Unknowns start,
                     Before before = {}) {
  const Pose velocity_from_sonar =
      Pose(Eigen::Translation3d(-mount_of(options, recording.navigation.velocity.name).translation())) *
      options.body_from_sonar;
  return SlamSolver(std::move(problem), sonar_mount(velocity_from_sonar), recording.sweeps, options.seed,
                    std::move(start), std::move(before));
}

/// The body's pose at each beam that is later than `after_s` and within the time of the knots.
std::vector<StampedPose> poses_of(const SlamSolver& solver, const Recording& recording, const SlamOptions& options,
                                  double after_s) {
  const auto& [velocity, headings, depth] = recording.navigation;
  const Eigen::Vector3d velocity_place = mount_of(options, velocity.name).translation();
  const HeadingSource& main = headings.front();
  const std::vector<SlamProblem::Way> ways = solver.problem().ways(solver.unknowns());
  std::vector<StampedPose> poses;
  for (const double time_s : recording.beam_times_s) {
    const auto between = solver.problem().between_knots(time_s);
    if (!between || time_s <= (poses.empty() ? after_s : poses.back().time_s)) continue;
    const auto [knot, share] = *between;
    const Eigen::Vector3d state = solver.knot_at(knot, share);
    const Eigen::Vector2d place = state.head<2>() + solver.problem().bulge(solver.unknowns(), ways[knot], knot, time_s);
    Pose pose = pose_from_rpy({place.x(), place.y(), depth ? -depth->at(time_s) : 0.0},
                              main.roll_rad ? main.roll_rad->at(time_s) : 0.0,
                              main.pitch_rad ? main.pitch_rad->at(time_s) : 0.0, main.yaw_rad.at(time_s) + state.z());
    // The knots are where the velocity is measured.
    const Eigen::Vector3d offset = pose.rotation() * Eigen::Vector3d(velocity_place.x(), velocity_place.y(), 0.0);
    pose.translation().head<2>() -= offset.head<2>();
    poses.push_back({time_s, pose});
  }
  return poses;
}

SlamReport report_of(const SlamSolver& solver, const Recording& recording) {
  const VelocitySource& velocity = recording.navigation.velocity;
  SlamReport report;
  report.beams = recording.beam_times_s.size();
  report.sweeps = static_cast<std::size_t>(
      std::ranges::count_if(recording.sweeps, [](const HeardSweep& s) { return s.extent != Sweep::Extent::kCut; }));
  report.echoes = solver.echoes();
  report.knots = solver.problem().knots();
  report.pairs = solver.pairs().pairs.size();
  std::vector<double> distances_m;
  for (const EchoPair& pair : solver.pairs().pairs) distances_m.push_back(std::abs(pair.distance_m));
  if (!distances_m.empty()) report.pair_median_m = median(std::move(distances_m));
  report.loops_found = solver.pairs().loops_found;
  report.loops_kept = solver.pairs().loops_kept;
  report.velocities = velocity.ahead.size();
  report.velocities_clipped = velocity.clipped;
  report.longest_gap_s = velocity.ahead.longest_step_s();
  report.velocity = velocity.name;
  report.heading = recording.navigation.headings.front().name;
  if (velocity.by_sonar) {
    double variance_m2 = 0.0;
    for (const SlamProblem::Way& way : solver.problem().ways(solver.unknowns())) {
      variance_m2 += way.deviation_m * way.deviation_m;
    }
    // The first and the last sample go on to the ends of the recording.
    report.by_sonar = {velocity.ahead.size() - 2, velocity.density.values().front(), std::sqrt(variance_m2)};
  }
  return report;
}

Result<SlamSolution> solution_of(const SlamSolver& solver, const Recording& recording, const SlamOptions& options,
                                 std::vector<StampedPose> poses) {
  if (poses.empty()) return fail(Error::Code::kUnsupported, "no beam is within the time of the navigation");
  const Eigen::Vector2d origin = poses.front().map_from_body.translation().head<2>();
  for (StampedPose& pose : poses) pose.map_from_body.translation().head<2>() -= origin;
  Result<Trajectory> trajectory = Trajectory::make(std::move(poses));
  if (!trajectory) return tl::unexpected(trajectory.error());
  SlamSolution solution{*std::move(trajectory), {}, {}, report_of(solver, recording)};
  if (options.matching == Matching::kPairs) {
    solution.calibration = calibration_of(solver);
    solution.report.not_observable = not_observable(solver);
  }
  return solution;
}

/// Of the body, whose origin is carried by the place of the velocity's source.
std::vector<PoseCovariance> covariances_of(const SlamSolver& solver, const std::vector<Eigen::Matrix3d>& of_knots,
                                           const Recording& recording, const SlamOptions& options) {
  const Eigen::Vector2d velocity_place = mount_of(options, recording.navigation.velocity.name).translation().head<2>();
  std::vector<PoseCovariance> covariances;
  for (std::size_t k = 0; k < of_knots.size(); ++k) {
    const double time_s = solver.problem().knot_times_s()[k];
    const double yaw_rad = solver.problem().main_yaw_rad(time_s) + solver.unknowns().knots[k].z();
    Eigen::Matrix3d body_by_knot = Eigen::Matrix3d::Identity();
    body_by_knot.block<2, 1>(0, 2) = -quarter_turn(rotation2(yaw_rad) * velocity_place);
    covariances.push_back({time_s, body_by_knot * of_knots[k] * body_by_knot.transpose()});
  }
  return covariances;
}

Result<SlamSolution> solve_batch(const Recording& recording, const SlamOptions& options) {
  Result<SlamProblem> problem = problem_of(recording, options);
  if (!problem) return tl::unexpected(problem.error());
  Unknowns start = problem->dead_reckoning();
  SlamSolver solver = solver_of(*std::move(problem), recording, options, std::move(start));
  bool determined = true;
  std::optional<SweepLoops> loops;
  if (options.matching == Matching::kPairs) {
    for (std::size_t i = 0; i < kAlone; ++i) determined = determined && solver.step(std::nullopt);
    if (determined) loops = close_sweep_loops(solver);
    determined = determined && loops;
    for (const double gate_m : kGates_m) determined = determined && solver.step(gate_m);
  }
  std::optional<std::vector<Eigen::Matrix3d>> of_knots;
  if (determined) of_knots = solver.knot_covariances();
  if (!of_knots) {
    return fail(Error::Code::kUnsupported, "the recording does not determine the trajectory");
  }
  Result<SlamSolution> solution =
      solution_of(solver, recording, options, poses_of(solver, recording, options, -kInfinity));
  if (!solution) return solution;
  solution->covariances = covariances_of(solver, *of_knots, recording, options);
  if (loops) {
    solution->report.submap_loops_found = loops->found;
    solution->report.submap_loops_kept = loops->kept.size();
  }
  return solution;
}

/// The sources, and how the sonar says that the vehicle moved where they have no velocity.
Result<std::vector<NavSource>> with_sonar_odometry(std::vector<NavSource> sources, std::span<const HeardSweep> sweeps,
                                                   const SlamOptions& options) {
  const Result<NavLog> log = NavLog::make(sources, NavClock::kUnknown);
  if (!log) return tl::unexpected(log.error());
  if (velocity_of(*log, options)) return sources;
  const std::vector<HeadingSource> headings = headings_of(*log, options);
  if (options.estimation == Estimation::kCausal) {
    return fail(Error::Code::kUnsupported,
                "the navigation has no valid velocity over ground, which estimation as on board needs");
  }
  if (!headings.empty()) {
    const Span beams{sweeps.front().from_s, sweeps.back().to_s};
    const HeadingSource& main = headings.front();
    if (!overlap(beams, main.yaw_rad)) return no_overlap(beams, main.yaw_rad, "heading of " + main.name);
  }
  SonarOdometry odometry =
      sonar_odometry(sweeps, sonar_mount(options.body_from_sonar), headings.empty() ? nullptr : &headings.front());
  if (!odometry.tells) {
    return fail(Error::Code::kUnsupported,
                fmt::format("the navigation has no valid velocity over ground{}, and the sonar does not tell how the "
                            "vehicle moved: {} of {} sweeps match those before them",
                            headings.empty() ? " and no heading" : "", odometry.matched, sweeps.size() - 1));
  }
  // One without a valid sample would be in its way.
  std::erase_if(sources, [](const NavSource& source) { return source.quantity == NavQuantity::kVelocity; });
  sources.push_back(std::move(odometry.velocity));
  if (headings.empty()) sources.push_back(std::move(odometry.heading));
  return sources;
}

/// Samples until a time, from a time on, and those before it that tell noise and outliers at that time. They are in
/// order.
std::vector<NavSource> sources_within(const std::vector<NavSource>& sources, double from_s, double to_s) {
  constexpr double kBefore_s = 60.0;
  constexpr std::ptrdiff_t kSamplesBefore = 16;  // at least: a source that falls silent stays known
  std::vector<NavSource> within;
  for (const NavSource& source : sources) {
    const auto& samples = source.samples;
    const auto end = std::ranges::upper_bound(samples, to_s, {}, &NavSample::time_s);
    auto first = std::ranges::lower_bound(samples.begin(), end, from_s - kBefore_s, {}, &NavSample::time_s);
    first -= std::min(kSamplesBefore, first - samples.begin());
    within.push_back({source.name, source.quantity, {first, end}});
  }
  return within;
}

/// The turn and move that brings places nearest to others, in the mean square.
Pose2 align(const std::vector<Eigen::Vector3d>& places, const std::vector<Eigen::Vector3d>& to) {
  const auto count = static_cast<double>(places.size());
  Eigen::Vector2d mean = Eigen::Vector2d::Zero(), mean_to = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < places.size(); ++k) {
    mean += places[k].head<2>() / count;
    mean_to += to[k].head<2>() / count;
  }
  double cosine = 0.0, sine = 0.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Eigen::Vector2d a = places[k].head<2>() - mean, b = to[k].head<2>() - mean_to;
    cosine += a.dot(b);
    sine += a.x() * b.y() - a.y() * b.x();
  }
  const double yaw_rad = std::atan2(sine, cosine);
  return {mean_to - rotation2(yaw_rad) * mean, yaw_rad};
}

/// The part of the trajectory that is still estimated, and what is left of the time before.
struct Window {
  std::size_t first_sweep = 0;  ///< of the log
  std::vector<double> times_s;  ///< of the knots
  /// Of each step of the solution: how many knots it added.
  std::deque<std::size_t> steps;
  std::vector<Eigen::Vector3d> poses;  ///< of the knots: x, y, yaw
  std::vector<std::string> headings;
  Eigen::VectorXd globals;
  std::optional<WindowPrior> prior;  ///< its knot's last number is the yaw
  HeldSweeps held;
  std::size_t echoes = 0, left_knots = 0, left_echoes = 0;
  LargestSolution largest;
};

/// Keeps what a solution says, and lets knots and sweeps older than the window leave. False: not determined.
bool keep(const SlamSolver& solver, std::span<const HeardSweep> sweeps, std::size_t longest, Window& window) {
  const SlamProblem& problem = solver.problem();
  const auto yaw_rad = [&](std::size_t knot) { return problem.main_yaw_rad(window.times_s[knot]); };
  window.poses = solver.unknowns().knots;
  for (std::size_t k = 0; k < window.poses.size(); ++k) window.poses[k].z() += yaw_rad(k);
  window.globals = solver.unknowns().globals;
  window.headings.clear();
  for (const HeadingSource& heading : problem.headings()) window.headings.push_back(heading.name);
  std::size_t leaving = 0;
  while (window.steps.size() * kSweepsOfStep > longest) {
    leaving += window.steps.front();
    window.steps.pop_front();
  }
  window.prior = leaving > 0 ? solver.prior_at(leaving) : solver.before().prior;
  if (leaving > 0 && !window.prior) return false;
  if (window.prior) window.prior->knot.z() += yaw_rad(leaving);
  if (leaving == 0) return true;
  std::size_t ended = 0;
  while (ended < sweeps.size() && 0.5 * (sweeps[ended].from_s + sweeps[ended].to_s) < window.times_s[leaving]) ++ended;
  for (HeldSweep& sweep : solver.hold(ended)) {
    window.left_echoes += sweep.echoes.size();
    window.echoes -= sweep.echoes.size();
    window.held.add(std::move(sweep));
  }
  window.left_knots += leaving;
  window.first_sweep += ended;
  window.times_s.erase(window.times_s.begin(), window.times_s.begin() + static_cast<std::ptrdiff_t>(leaving));
  window.poses.erase(window.poses.begin(), window.poses.begin() + static_cast<std::ptrdiff_t>(leaving));
  return true;
}

/// The globals of a problem by those of the window, where they are: a heading may be new, or the main one.
std::vector<std::optional<Eigen::Index>> known_globals(const SlamProblem& problem, const Window& window) {
  std::vector<std::optional<Eigen::Index>> known;
  for (std::size_t g = 0; g < global::kHeadings; ++g) known.emplace_back(static_cast<Eigen::Index>(g));
  for (const HeadingSource& heading : problem.headings()) {
    const auto same = std::ranges::find(window.headings, heading.name);
    for (std::size_t i = 0; i < global::kOfHeading; ++i) {
      const std::size_t from = global::heading(static_cast<std::size_t>(same - window.headings.begin())) + i;
      known.push_back(same == window.headings.end() ? std::nullopt : std::optional(static_cast<Eigen::Index>(from)));
    }
  }
  return known;
}

/// What the window says of the problem that goes on longer; dead reckoning after its end.
Unknowns continue_from(const Window& window, const SlamProblem& problem) {
  Unknowns start = problem.dead_reckoning();
  const auto known = known_globals(problem, window);
  for (std::size_t g = 0; g < known.size(); ++g) {
    if (known[g]) start.globals[static_cast<Eigen::Index>(g)] = window.globals[*known[g]];
  }
  double error_rad = 0.0;
  for (std::size_t k = 0; k < problem.knots(); ++k) {
    if (k < window.poses.size()) {
      start.knots[k] = window.poses[k];
      const double error = window.poses[k].z() - problem.main_yaw_rad(problem.knot_times_s()[k]);
      error_rad += wrap_angle(error - error_rad);
    }
    // After the end of the window, as at its end.
    start.knots[k].z() = error_rad;
  }
  const std::vector<SlamProblem::Way> moved = problem.ways(start);
  for (std::size_t k = window.poses.size() - 1; k + 1 < problem.knots(); ++k) {
    start.knots[k + 1].head<2>() = start.knots[k].head<2>() + moved[k].moved;
  }
  return start;
}

/// The window's prior in the unknowns of a problem that starts with `start`. A heading that is new is believed as
/// usual.
std::optional<WindowPrior> prior_of(const Window& window, const SlamProblem& problem, const Unknowns& start) {
  if (!window.prior) return std::nullopt;
  const WindowPrior& from = *window.prior;
  const auto known = known_globals(problem, window);
  const auto size = static_cast<Eigen::Index>(3 + known.size());
  const std::vector<Estimate> usual = problem.global_priors();
  WindowPrior prior{from.knot, start.globals, Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
  const double error_rad = start.knots.front().z();
  prior.knot.z() = error_rad + wrap_angle(from.knot.z() - problem.main_yaw_rad(window.times_s.front()) - error_rad);
  std::vector<std::optional<Eigen::Index>> places = {0, 1, 2};
  for (const auto& place : known) places.push_back(place ? std::optional(*place + 3) : std::nullopt);
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto& row = places[static_cast<std::size_t>(i)];
    if (!row) {
      const Estimate& believed = usual[static_cast<std::size_t>(i - 3)];
      prior.globals[i - 3] = believed.value;
      prior.information(i, i) = 1.0 / (believed.deviation * believed.deviation);
      continue;
    }
    if (i >= 3) prior.globals[i - 3] = from.globals[*row - 3];
    prior.gradient[i] = from.gradient[*row];
    for (Eigen::Index j = 0; j < size; ++j) {
      const auto& column = places[static_cast<std::size_t>(j)];
      if (column) prior.information(i, j) = from.information(*row, *column);
    }
  }
  return prior;
}

/// The knots of the window, and new ones until the end of what was recorded.
Result<std::vector<double>> window_knot_times(const Window& window, const Recording& recording) {
  const double step_s = sweep_duration_s(recording.sweeps) / kKnotsOfSweep;
  if (!(step_s > 0.0)) return fail(Error::Code::kUnsupported, "all beams have the same time");
  const bool is_first = window.times_s.empty();
  const Span span{is_first ? recording.span.from_s : window.times_s.back(), recording.span.to_s};
  Result<std::vector<double>> added = knot_times(span, step_s, recording.beam_times_s.size());
  if (!added || is_first) return added;
  std::vector<double> times_s = window.times_s;
  times_s.insert(times_s.end(), added->begin() + 1, added->end());
  return times_s;
}

Result<SlamSolution> window_solution(const SlamSolver& solver, const Recording& whole, const Window& window,
                                     const SlamOptions& options, std::vector<StampedPose> poses) {
  Result<SlamSolution> solution = solution_of(solver, whole, options, std::move(poses));
  if (!solution) return solution;
  solution->report.knots = window.left_knots + window.times_s.size();
  solution->report.echoes = window.left_echoes + window.echoes;
  solution->report.largest = window.largest;
  return solution;
}

/// After each few sweeps, the poses of their beams by dead reckoning from the last solution; then a new solution of the
/// window.
Result<SlamSolution> solve_causal(const Recording& whole, const std::vector<NavSource>& unsorted,
                                  const SlamOptions& options) {
  const Result<NavLog> log = NavLog::make(unsorted, NavClock::kUnknown);
  if (!log) return tl::unexpected(log.error());
  const std::vector<NavSource>& sources = log->sources();
  std::optional<SlamSolver> last;
  Window window{.first_sweep = 0,
                .times_s = {},
                .steps = {},
                .poses = {},
                .headings = {},
                .globals = {},
                .prior = std::nullopt,
                .held = HeldSweeps(options.seed),
                .echoes = 0,
                .left_knots = 0,
                .left_echoes = 0,
                .largest = {}};
  std::vector<StampedPose> poses;
  // Later solutions turn the whole trajectory as they learn how the compasses deviate. The poses go on in the frame of
  // those before, or their map would bend. What left the window keeps its frame.
  Pose2 frame;
  for (std::size_t end = std::min(kSweepsOfStep, whole.sweeps.size());;
       end = std::min(end + kSweepsOfStep, whole.sweeps.size())) {
    const bool is_whole = end == whole.sweeps.size();
    const double until_s = whole.sweeps[end - 1].to_s;
    const double from_s = window.times_s.empty() ? -kInfinity : window.times_s.front();
    const auto first_beam = std::ranges::lower_bound(whole.beam_times_s, from_s) - whole.beam_times_s.begin();
    const auto end_beam = std::ranges::upper_bound(whole.beam_times_s, until_s) - whole.beam_times_s.begin();
    const Result<Recording> recording =
        recording_of(whole.beam_times_s.subspan(static_cast<std::size_t>(first_beam),
                                                static_cast<std::size_t>(end_beam - first_beam)),
                     whole.sweeps.subspan(window.first_sweep, end - window.first_sweep),
                     sources_within(sources, from_s, is_whole ? kInfinity : until_s), options);
    const bool goes_on = recording && (window.times_s.empty() || recording->span.to_s > window.times_s.back());
    Result<std::vector<double>> times_s =
        recording.and_then([&](const Recording& part) { return window_knot_times(window, part); });
    if (!goes_on || !times_s) {
      if (!is_whole) continue;  // Too early for velocity and heading, or they are silent: these beams have no pose yet.
      if (last) return window_solution(*last, whole, window, options, std::move(poses));
      return tl::unexpected(recording ? times_s.error() : recording.error());
    }
    window.steps.push_back(times_s->size() - std::max<std::size_t>(window.times_s.size(), 1));
    SlamProblem problem(*times_s, recording->navigation.velocity, recording->navigation.headings, options.calibration);
    const Unknowns start = last ? continue_from(window, problem) : problem.dead_reckoning();
    Before before{window.first_sweep, prior_of(window, problem, start), &window.held};
    window.times_s = *std::move(times_s);
    SlamSolver solver = solver_of(std::move(problem), *recording, options, start, std::move(before));
    for (const StampedPose& pose :
         poses_of(solver, *recording, options, poses.empty() ? -kInfinity : poses.back().time_s)) {
      const Eigen::AngleAxisd turn(frame.yaw_rad, Eigen::Vector3d::UnitZ());
      Pose moved = turn * pose.map_from_body;
      moved.translation().head<2>() += frame.place_m;
      poses.push_back({pose.time_s, moved});
    }
    if (options.matching == Matching::kPairs && end > 1) {
      if (!last) solver.step(std::nullopt);
      for (const double gate_m : kCausalGates_m) solver.step(gate_m);
    }
    if (!poses.empty() && !window.prior && until_s - poses.front().time_s > kSettle_s)
      frame = frame * align(solver.unknowns().knots, start.knots);
    window.echoes = solver.echoes();
    window.largest.knots = std::max(window.largest.knots, solver.problem().knots());
    window.largest.echoes = std::max(window.largest.echoes, solver.echoes() + solver.held_echoes());
    window.largest.pairs = std::max(window.largest.pairs, solver.pairs().pairs.size());
    if (is_whole) return window_solution(solver, whole, window, options, std::move(poses));
    if (!keep(solver, recording->sweeps, options.causal_sweeps, window)) {
      return fail(Error::Code::kUnsupported, "the recording does not determine the trajectory");
    }
    last.emplace(std::move(solver));
  }
}

}  // namespace

Result<SlamSolution> SlamSmoother::solve() const {
  const SlamOptions& options = state_->options;
  const std::vector<double>& times_s = state_->beam_times_s;
  if (times_s.empty()) return fail(Error::Code::kUnsupported, "there are no beams");
  if (const auto back = std::ranges::adjacent_find(times_s, std::ranges::greater()); back != times_s.end()) {
    return fail(Error::Code::kCorrupt, fmt::format("the times of the beams do not rise: beam {} is at {:.3f} s, the "
                                                   "next at {:.3f} s",
                                                   back - times_s.begin(), *back, *(back + 1)));
  }
  std::vector<HeardSweep> sweeps = state_->sweeps;
  SweepAssembler rest = state_->assembler;
  if (const auto sweep = rest.finish()) sweeps.push_back(state_->heard(*sweep));
  const Result<std::vector<NavSource>> sources = with_sonar_odometry(state_->sources, sweeps, options);
  if (!sources) return tl::unexpected(sources.error());
  const Result<Recording> recording = recording_of(times_s, sweeps, *sources, options);
  if (!recording) return tl::unexpected(recording.error());
  if (options.matching == Matching::kPairs && sweeps.size() < 2) {
    return fail(Error::Code::kUnsupported, "there is only one sweep, and nothing to match it with");
  }
  return options.estimation == Estimation::kCausal ? solve_causal(*recording, *sources, options)
                                                   : solve_batch(*recording, options);
}

}  // namespace pingvox
