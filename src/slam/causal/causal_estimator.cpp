#include "slam/causal/causal_estimator.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "slam/odometry/velocity_gaps.hpp"
#include "slam/smoother/solution.hpp"

namespace pingvox {
namespace {

constexpr std::array<double, 3> kSweepGates_m = {3.0, 2.0, 1.5};
/// For so long the compasses' deviations are found, and the frame of the poses turns with them.
constexpr double kSettle_s = 600.0;
/// Samples so long before the window tell noise and outliers at its beginning.
constexpr double kBefore_s = 60.0;

constexpr std::ptrdiff_t kSamplesBefore = 16;  ///< at least: a source that falls silent stays known

/// Samples until a time, from some time before another on: those that tell noise and outliers at that time.
/// REQUIRES samples in order.
std::vector<NavSource> sources_within(const std::vector<NavSource>& sources, double from_s, double to_s,
                                      double before_s) {
  std::vector<NavSource> within;
  for (const NavSource& source : sources) {
    const auto& samples = source.samples;
    const auto end = std::ranges::upper_bound(samples, to_s, {}, &NavSample::time_s);
    auto first = std::ranges::lower_bound(samples.begin(), end, from_s - before_s, {}, &NavSample::time_s);
    first -= std::min(kSamplesBefore, first - samples.begin());
    within.push_back({source.name, source.quantity, {first, end}});
  }
  return within;
}

/// The valid samples from a time on, and the last ones before: a device may say for long that it measures nothing, and
/// would be taken for one that never does.
std::vector<NavSource> valid_since(const std::vector<NavSource>& sources, double from_s) {
  std::vector<NavSource> since;
  for (const NavSource& source : sources) {
    const auto& samples = source.samples;
    auto first = std::ranges::lower_bound(samples, from_s, {}, &NavSample::time_s);
    for (std::ptrdiff_t before = 0; before < kSamplesBefore && first != samples.begin();) {
      before += (--first)->valid ? 1 : 0;
    }
    NavSource valid{source.name, source.quantity, {}};
    std::copy_if(first, samples.end(), std::back_inserter(valid.samples), [](const NavSample& s) { return s.valid; });
    since.push_back(std::move(valid));
  }
  return since;
}

std::vector<Eigen::Vector2d> places_of(const Unknowns& unknowns) {
  std::vector<Eigen::Vector2d> places_m;
  for (const Eigen::Vector3d& knot : unknowns.knots) places_m.emplace_back(knot.head<2>());
  return places_m;
}

/// The knots of the window, and new ones until the end of what was recorded.
Result<std::vector<double>> window_knot_times(const CausalWindow& window, const SlamInput& recording) {
  const bool is_first = window.times_s.empty();
  const TimeSpan span{is_first ? recording.span.from_s : window.times_s.back(), recording.span.to_s};
  Result<std::vector<double>> added = knot_times(span, recording.sweeps, recording.beam_times_s.size());
  if (!added || is_first) return added;
  std::vector<double> times_s = window.times_s;
  times_s.insert(times_s.end(), added->begin() + 1, added->end());
  return times_s;
}

}  // namespace

CausalEstimator::CausalEstimator(SlamOptions options) : options_(std::move(options)), window_(options_.seed) {}

void CausalEstimator::add_beam(double time_s) {
  beam_times_s_.push_back(time_s);
  ++beams_;
}

void CausalEstimator::take(SweepEchoes sweep) {
  if (sweep.extent != Sweep::Extent::kCut) ++complete_sweeps_;
  sweeps_.push_back(std::move(sweep));
  ++all_sweeps_;
}

Result<void> CausalEstimator::add_sample(std::string_view source, NavQuantity quantity, const NavSample& sample) {
  return pingvox::add_sample(source, quantity, sample, options_.nav_offset_s, sources_);
}

Result<void> CausalEstimator::add_sweep(SweepEchoes sweep) {
  take(std::move(sweep));
  if (++sweeps_of_step_ < kSweepsOfStep) return {};
  sweeps_of_step_ = 0;
  return solve_until(sweeps_.back().to_s);
}

MotionSources CausalEstimator::sources_of_window(double nav_until_s) {
  const double from_s = window_.times_s.empty() ? -kInfinity : window_.times_s.front();
  MotionSources sources{sources_within(sources_, from_s, nav_until_s, kBefore_s)};
  if (options_.motion == MotionSource::kVelocity) return sources;
  const Result<NavLog> log = NavLog::make(sources.measured, NavClock::kUnknown);
  if (!log) return sources;
  const std::vector<HeadingSource> headings = headings_of(*log, options_);
  odometry_.extend(sweeps_, pose2_of(options_.body_from_sonar), headings.empty() ? nullptr : &headings.front());
  if (odometry_.has_motion()) {
    sources.by_sonar = odometry_.sources();
  } else {
    std::erase_if(sources.measured, [](const NavSource& s) { return s.quantity == NavQuantity::kVelocity; });
  }
  return sources;
}

Result<void> CausalEstimator::solve_until(double nav_until_s) {
  const auto end = std::ranges::upper_bound(beam_times_s_, sweeps_.back().to_s) - beam_times_s_.begin();
  Result<Navigation> navigation = navigation_of(sources_of_window(nav_until_s), options_, kEarlierSamples);
  if (navigation) fill_gaps(*navigation);
  const Result<SlamInput> recording = std::move(navigation).and_then([&](Navigation part) {
    return slam_input_of(std::span(beam_times_s_).first(static_cast<std::size_t>(end)), sweeps_, std::move(part));
  });
  const bool goes_on = recording && (window_.times_s.empty() || recording->span.to_s > window_.times_s.back());
  Result<std::vector<double>> times_s =
      recording.and_then([&](const SlamInput& part) { return window_knot_times(window_, part); });
  if (!goes_on || !times_s) {
    // Too early for velocity and heading, or they are silent: these beams have no pose yet.
    if (!times_s) missing_ = times_s.error();
    return {};
  }
  SlamProblem problem(*std::move(times_s), recording->navigation.velocity, recording->navigation.headings,
                      options_.calibration);
  const bool is_first = !solver_;
  const Unknowns start = is_first ? problem.dead_reckoning() : window_.continue_in(problem);
  Before before{window_.first_sweep, window_.prior_in(problem, start), &window_.fixed};
  SlamSolver solver = solver_of(std::move(problem), *recording, options_, start, std::move(before));
  std::vector<StampedPose> poses = new_poses(solver, *recording);
  SweepLoops found;
  if (options_.matching == Matching::kPairs) {
    bool determined = !is_first || solver.step(std::nullopt);
    std::optional<SweepLoops> loops;
    if (determined) loops = close_new_loops(solver);
    determined = determined && loops;
    const double widest_m = kGateOfReach * solver.reach_m();
    for (const double gate_m : kSweepGates_m) determined = determined && solver.step(std::min(gate_m, widest_m));
    if (!determined) return not_determined();
    found = *loops;
  }
  const bool settles = !window_.prior;
  const auto left = window_.keep(solver, sweeps_, options_.causal_sweeps);
  if (!left) return not_determined();
  // Nothing of a solution that fails is kept: the next one begins where the last one ended.
  for (const StampedPose& pose : poses) poses_.emplace_back(pose);
  if (!origin_m_ && !poses_.empty()) origin_m_ = poses_.front().pose()->translation().head<2>();
  loops_.found += found.found;
  loops_.kept += found.kept;
  if (settles && !poses_.empty() && sweeps_.back().to_s - poses_.front().time_s > kSettle_s)
    frame_ = frame_ * fit_pose2(places_of(solver.unknowns()), places_of(start));
  sweeps_.erase(sweeps_.begin(), sweeps_.begin() + static_cast<std::ptrdiff_t>(*left));
  solver_.emplace(std::move(solver));
  depth_ = recording->navigation.depth;
  ++solutions_;
  const auto leaving = std::ranges::lower_bound(beam_times_s_, window_.times_s.front()) - beam_times_s_.begin();
  const std::vector<StampedPose> last = solved_poses(std::span(beam_times_s_).first(static_cast<std::size_t>(leaving)));
  first_newest_ = left_.size();
  for (const StampedPose& pose : last) left_.emplace_back(pose);
  forget();
  return {};
}

void CausalEstimator::fill_gaps(Navigation& navigation) {
  VelocitySource& velocity = navigation.velocity;
  if (options_.matching == Matching::kNone || velocity.by_sonar) return;
  const TimeSpan span{velocity.ahead.from_s(), solver_ ? sweeps_.back().to_s : velocity.ahead.to_s()};
  for (const TimeSpan& gap : fill_velocity_gaps(sweeps_, span, velocity_from_sonar(velocity, options_),
                                                navigation.headings.front(), velocity)) {
    filled_s_ += std::max(0.0, gap.to_s - std::max(gap.from_s, filled_until_s_));
    filled_until_s_ = std::max(filled_until_s_, gap.to_s);
  }
}

std::vector<StampedPose> CausalEstimator::new_poses(const SlamSolver& solver, const SlamInput& recording) const {
  const double after_s = poses_.empty() ? -kInfinity : poses_.back().time_s;
  const auto first = std::ranges::upper_bound(recording.beam_times_s, after_s);
  std::vector<StampedPose> poses = poses_at({first, recording.beam_times_s.end()}, solver.problem(), solver.unknowns(),
                                            recording.navigation.depth, options_);
  for (StampedPose& pose : poses) pose.map_from_body = in_frame(pose.map_from_body);
  return poses;
}

Result<void> CausalEstimator::not_determined() {
  missing_ = {Error::Code::kUnsupported, "the recording does not determine the trajectory"};
  return tl::unexpected(missing_);
}

bool CausalEstimator::is_observable() const {
  return odometry_.matched() >= odometry_.min_matched(all_sweeps_ - 1);
}

/// What is before the window.
void CausalEstimator::forget() {
  const double from_s = window_.times_s.front();
  sources_ = sources_within(sources_, from_s, kInfinity, kBefore_s);
  odometry_.forget_before(from_s);
  beam_times_s_.erase(beam_times_s_.begin(), std::ranges::lower_bound(beam_times_s_, from_s));
}

Pose CausalEstimator::in_frame(const Pose& pose) const {
  Pose moved = Eigen::AngleAxisd(frame_.yaw_rad, Eigen::Vector3d::UnitZ()) * pose;
  moved.translation().head<2>() += frame_.place_m;
  return moved;
}

std::vector<StampedPose> CausalEstimator::solved_poses(std::span<const double> times_s) const {
  std::vector<StampedPose> poses = poses_at(times_s, solver_->problem(), solver_->unknowns(), depth_, options_);
  for (StampedPose& pose : poses) pose.map_from_body = in_frame(pose.map_from_body);
  return poses;
}

std::vector<StampedPose> CausalEstimator::path_from(std::size_t first) const {
  if (!solver_ || !origin_m_) return {};
  std::vector<StampedPose> path;
  for (std::size_t i = first; i < left_.size(); ++i) path.push_back(left_[i].stamped());
  const std::vector<StampedPose> window = solved_poses(beam_times_s_);
  path.insert(path.end(), window.begin(), window.end());
  for (StampedPose& pose : path) pose.map_from_body.translation().head<2>() -= *origin_m_;
  return path;
}

std::vector<StampedPose> CausalEstimator::path() const {
  return path_from(0);
}

std::vector<StampedPose> CausalEstimator::newest_path() const {
  return path_from(first_newest_);
}

std::optional<MotionReport> CausalEstimator::motion() const {
  if (!solver_) return std::nullopt;
  const VelocitySource& velocity = solver_->problem().velocity();
  return MotionReport{velocity.name, solver_->problem().headings().front().name, velocity.by_sonar,
                      velocity.density.at(window_.times_s.back())};
}

std::optional<StampedPose> CausalEstimator::pose(double until_s) const {
  const std::optional<PredictedPose> last = pose_until(until_s, Until::kMeasured);
  return last ? std::optional(last->pose) : std::nullopt;
}

std::optional<PredictedPose> CausalEstimator::predict(double until_s) const {
  return pose_until(until_s, Until::kHeading);
}

std::optional<PredictedPose> CausalEstimator::pose_until(double until_s, Until until) const {
  if (!solver_ || poses_.empty()) return std::nullopt;
  if (odometry_.has_motion() && !(odometry_.is_observable_now() && is_observable())) return std::nullopt;
  const double from_s = window_.times_s.back();
  MotionSources sources{valid_since(sources_, from_s)};
  if (odometry_.has_motion()) sources.by_sonar = odometry_.sources();
  Result<Navigation> navigation = navigation_of(std::move(sources), options_, kEarlierSamples);
  if (!navigation) return std::nullopt;
  // The window's last error of the heading is that of its main one.
  std::vector<HeadingSource>& headings = navigation->headings;
  const auto main = std::ranges::find(headings, window_.headings.front(), &HeadingSource::name);
  if (main == headings.end()) return std::nullopt;
  std::rotate(headings.begin(), main, main + 1);
  // By the sonar the velocity is known at the end of a sweep, or was in a gap, and goes on.
  const double measured_s = navigation->velocity.ahead.to_s();
  const bool is_in_gap = measured_s < from_s;
  if (is_in_gap) navigation->velocity = solver_->problem().velocity();
  const bool goes_on = until == Until::kHeading || is_in_gap || navigation->velocity.by_sonar;
  const double to_s = std::min({goes_on ? kInfinity : measured_s, headings.front().yaw_rad.to_s(), until_s});
  PredictedPose last{poses_.back().stamped(), 0.0, 0.0};
  if (!navigation->velocity.by_sonar) last.without_velocity_s = std::max(0.0, std::max(to_s, from_s) - measured_s);
  if (to_s > from_s) {
    const SlamProblem problem({from_s, to_s}, std::move(navigation->velocity), std::move(headings),
                              options_.calibration);
    CausalWindow end(options_.seed);
    end.times_s = {from_s};
    end.poses = {window_.poses.back()};
    end.headings = window_.headings;
    end.globals = window_.globals;
    const Unknowns unknowns = end.continue_in(problem);
    const std::vector<StampedPose> poses =
        poses_at(std::span(&to_s, 1), problem, unknowns, navigation->depth, options_);
    last.pose = {to_s, in_frame(poses.front().map_from_body)};
    last.deviation_m = problem.ways(unknowns).front().with_steady_m;
  }
  last.pose.map_from_body.translation().head<2>() -= *origin_m_;
  return last;
}

Result<SlamSolution> CausalEstimator::finish(std::optional<SweepEchoes> last) {
  if (last) take(*std::move(last));
  if (sweeps_.empty() && !solver_) return fail(Error::Code::kUnsupported, "there are no beams");
  if (!sweeps_.empty()) {
    if (const auto solved = solve_until(kInfinity); !solved) return tl::unexpected(solved.error());
  }
  if (!solver_) {
    Error missing = missing_;
    if (options_.motion == MotionSource::kSonar) missing.message += ", and motion cannot be estimated from the sonar";
    return tl::unexpected(std::move(missing));
  }
  if (odometry_.has_motion() && !is_observable()) {
    return fail(Error::Code::kUnsupported,
                fmt::format("there is no velocity over ground, and motion cannot be estimated from the sonar: "
                            "{} of {} sweeps match those before them",
                            odometry_.matched(), all_sweeps_ - 1));
  }
  std::vector<StampedPose> all_poses;
  for (const CompactPose& pose : std::exchange(poses_, {})) all_poses.push_back(pose.stamped());
  begin_at_origin(all_poses);
  Result<SlamSolution> solution = solution_of(*solver_, options_, std::move(all_poses));
  if (!solution) return solution;
  solution->report.beams = beams_;
  solution->report.sweeps = complete_sweeps_;
  solution->report.knots = window_.left_knots + window_.times_s.size();
  solution->report.echoes = window_.left_echoes + window_.echoes;
  solution->report.largest = window_.largest;
  solution->report.velocity.gaps_by_sonar_s = filled_s_;
  solution->report.pairs.submap_loops = {loops_.found, loops_.kept};
  if (solution->report.velocity.by_sonar) {
    SonarMotion& motion = *solution->report.velocity.by_sonar;
    motion.matched = odometry_.matched();
    const std::vector<StampedPose>& told = solution->trajectory.poses();
    motion.drift_m = motion.noise_m_sqrt_s * std::sqrt(told.back().time_s - told.front().time_s);
  }
  return solution;
}

}  // namespace pingvox
