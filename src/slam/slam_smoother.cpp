#include "pingvox/slam/slam_smoother.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <tuple>
#include <utility>

#include "slam/echo_pairs.hpp"
#include "slam/echo_runs.hpp"
#include "slam/navigation.hpp"
#include "slam/normal_equations.hpp"
#include "slam/slam_problem.hpp"

namespace pingvox {
namespace {

constexpr double kKnotsOfSweep = 4.0;
/// How far apart the echoes of a pair may be, in each iteration.
constexpr std::array<double, 18> kGates_m = {10.0, 8.0, 6.0, 5.0, 4.0, 3.0, 3.0, 2.5, 2.0,
                                             2.0,  1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5};
/// Iterations without pairs: the problem is nearly linear then.
constexpr std::size_t kAlone = 4;

double yaw_of(const Pose& pose) {
  return std::atan2(pose.rotation()(1, 0), pose.rotation()(0, 0));
}

double median(std::vector<double> numbers) {
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

/// A sweep that ended.
struct HeardSweep {
  Sweep::Extent extent;
  double from_s, to_s;
  std::vector<EchoRun> runs;
};

/// The least-squares problem of all sweeps, and its iterations.
class Solver {
 public:
  Solver(SlamProblem problem, const SonarMount& mount, const std::vector<HeardSweep>& sweeps, std::uint64_t seed)
      : problem_(std::move(problem)), mount_(mount), seed_(seed), unknowns_(problem_.dead_reckoning()) {
    sweeps_.push_back(0);
    for (const HeardSweep& sweep : sweeps) {
      for (const EchoRun& run : sweep.runs) {
        const auto between = problem_.between_knots(run.time_s);
        if (!between) continue;
        echoes_.push_back(
            {run, sweeps_.size() - 1, between->first, between->second, problem_.main_yaw_rad(run.time_s)});
      }
      sweeps_.push_back(echoes_.size());
      const double middle_s = std::clamp(0.5 * (sweep.from_s + sweep.to_s), problem_.knot_times_s().front(),
                                         problem_.knot_times_s().back());
      sweep_middles_.push_back(*problem_.between_knots(middle_s));
    }
  }

  /// One Gauss-Newton step. False: the problem does not determine its unknowns.
  bool step(std::optional<double> gate_m) {
    const std::vector<SlamProblem::Way> ways = problem_.ways(unknowns_);
    std::vector<EchoOnGround> ground;
    pairs_ = {};
    if (gate_m) {
      std::vector<Eigen::Vector2d> places;
      for (const auto& [knot, share] : sweep_middles_) places.emplace_back(knot_at(knot, share).head<2>());
      ground = place_echoes(problem_, mount_, unknowns_, ways, echoes_, sweeps_);
      pairs_ = echo_pairs(echoes_, ground, sweeps_, places, {seed_, *gate_m});
      // In order of the knots that they join.
      std::ranges::sort(pairs_.pairs, {}, [&](const EchoPair& pair) {
        return std::array<std::size_t, 4>{echoes_[pair.a].knot, echoes_[pair.b].knot, pair.a, pair.b};
      });
    }
    return solve(ways, ground);
  }

  const SlamProblem& problem() const { return problem_; }
  const Unknowns& unknowns() const { return unknowns_; }
  const Eigen::MatrixXd& global_covariance() const { return global_covariance_; }
  const EchoPairs& pairs() const { return pairs_; }
  std::size_t echoes() const { return echoes_.size(); }
  std::size_t factor_entries() const { return factor_entries_; }

  Eigen::Vector3d knot_at(std::size_t knot, double share) const {
    return unknowns_.knots[knot] + share * (unknowns_.knots[knot + 1] - unknowns_.knots[knot]);
  }

 private:
  bool solve(const std::vector<SlamProblem::Way>& ways, const std::vector<EchoOnGround>& ground) {
    const auto joined = [&](const EchoPair& pair) {
      return std::pair{static_cast<std::uint32_t>(echoes_[pair.a].knot),
                       static_cast<std::uint32_t>(echoes_[pair.b].knot)};
    };
    std::vector<std::pair<std::uint32_t, std::uint32_t>> shared;
    for (std::uint32_t k = 0; k + 1 < problem_.knots(); ++k) shared.emplace_back(k, k + 1);
    for (std::size_t i = 0; i < pairs_.pairs.size(); ++i) {
      const auto [a, b] = joined(pairs_.pairs[i]);
      if (i > 0 && joined(pairs_.pairs[i - 1]) == std::pair{a, b}) continue;
      for (const std::uint32_t x : {a, a + 1}) {
        for (const std::uint32_t y : {b, b + 1}) shared.emplace_back(x, y);
      }
    }
    NormalEquations equations(problem_.knots(), problem_.globals(), shared);
    for (const SlamProblem::Row& row : problem_.rows(unknowns_, ways)) add_row(row, equations);
    add_pairs(ground, equations);
    const std::optional<NormalEquations::Step> step = equations.solve();
    if (!step) return false;
    for (std::size_t k = 0; k < problem_.knots(); ++k) {
      unknowns_.knots[k] += step->knots.segment<3>(static_cast<Eigen::Index>(3 * k));
    }
    unknowns_.globals += step->globals;
    global_covariance_ = step->global_covariance;
    factor_entries_ = step->factor_entries;
    return true;
  }

  static void add_row(const SlamProblem::Row& row, NormalEquations& equations) {
    const auto a = static_cast<Eigen::Index>(3 * row.knot), globals = equations.corner.cols();
    equations.add_block(row.knot, row.knot, row.by_knot * row.by_knot.transpose());
    equations.add_block(row.knot + 1, row.knot + 1, row.by_next * row.by_next.transpose());
    equations.add_block(row.knot + 1, row.knot, row.by_next * row.by_knot.transpose());
    equations.border.middleRows<3>(a) += row.by_knot * row.by_globals.transpose();
    equations.border.middleRows<3>(a + 3) += row.by_next * row.by_globals.transpose();
    equations.corner += row.by_globals * row.by_globals.transpose();
    equations.gradient.segment<3>(a) += row.residual * row.by_knot;
    equations.gradient.segment<3>(a + 3) += row.residual * row.by_next;
    equations.gradient.tail(globals) += row.residual * row.by_globals;
  }

  /// Sums up the pairs that join the same knots before they are added.
  void add_pairs(const std::vector<EchoOnGround>& ground, NormalEquations& equations) const {
    using Sum = Eigen::Matrix<double, 15, 16>;  // J'J, and J'r as its last column
    const auto& pairs = pairs_.pairs;
    for (std::size_t first = 0, end = 0; first < pairs.size(); first = end) {
      const std::size_t a = echoes_[pairs[first].a].knot, b = echoes_[pairs[first].b].knot;
      Sum sum = Sum::Zero();
      for (end = first; end < pairs.size() && echoes_[pairs[end].a].knot == a && echoes_[pairs[end].b].knot == b;
           ++end) {
        const EchoPair& pair = pairs[end];
        const PairRow row = pair_row(echoes_[pair.a], ground[pair.a], echoes_[pair.b], ground[pair.b], unknowns_, pair);
        Eigen::Matrix<double, 16, 1> wide;
        wide << row.by, row.distance_m;
        sum.noalias() += (pair.weight * row.by) * wide.transpose();
      }
      const std::array<std::size_t, 4> knots = {a, a + 1, b, b + 1};
      for (std::size_t i = 0; i < 4; ++i) {
        const auto row = static_cast<Eigen::Index>(3 * knots[i]), from = static_cast<Eigen::Index>(3 * i);
        for (std::size_t j = 0; j < 4; ++j) {
          // Each block of the lower triangle once; all four where both echoes are of one knot.
          if (knots[i] < knots[j]) continue;
          equations.add_block(knots[i], knots[j], sum.block<3, 3>(from, static_cast<Eigen::Index>(3 * j)));
        }
        equations.border.block<3, 3>(row, global::kWall) += sum.block<3, 3>(from, 12);
        equations.gradient.segment<3>(row) += sum.block<3, 1>(from, 15);
      }
      equations.corner.block<3, 3>(global::kWall, global::kWall) += sum.block<3, 3>(12, 12);
      equations.gradient.segment<3>(equations.border.rows() + Eigen::Index{global::kWall}) += sum.block<3, 1>(12, 15);
    }
  }

  SlamProblem problem_;
  SonarMount mount_;
  std::uint64_t seed_;
  Unknowns unknowns_;
  std::vector<PlacedEcho> echoes_;
  std::vector<std::size_t> sweeps_;  ///< where the echoes of each begin, and the end
  std::vector<std::pair<std::size_t, double>> sweep_middles_;
  EchoPairs pairs_;
  Eigen::MatrixXd global_covariance_;
  std::size_t factor_entries_ = 0;
};

SlamCalibration calibration_of(const Solver& solver) {
  const auto estimate = [&](std::size_t unknown) {
    const auto i = static_cast<Eigen::Index>(unknown);
    return Estimate{solver.unknowns().globals[i], std::sqrt(solver.global_covariance()(i, i))};
  };
  SlamCalibration calibration{estimate(global::kVelocityYaw), estimate(global::kVelocityScale), estimate(global::kWall),
                              estimate(global::kSonarX),      estimate(global::kSonarY),        {}};
  for (std::size_t s = 0; s < solver.problem().headings().size(); ++s) {
    const std::size_t first = global::heading(s);
    calibration.headings.push_back({solver.problem().headings()[s].name, estimate(first), estimate(first + 1),
                                    estimate(first + 2), estimate(first + 3), estimate(first + 4)});
  }
  return calibration;
}

}  // namespace

Result<void> SlamOptions::validate() const {
  if (!std::isfinite(nav_offset_s)) return fail(Error::Code::kBadOption, "nav_offset_s: must be finite");
  if (!(sound_speed_ratio > 0.0) || !std::isfinite(sound_speed_ratio)) {
    return fail(Error::Code::kBadOption, "sound_speed_ratio: must be finite and above 0");
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

Result<Navigation> navigation_of(const NavLog& log, const SlamOptions& options) {
  for (const auto& [name, mount] : options.body_from_source) {
    if (std::ranges::find(log.sources(), name, &NavSource::name) != log.sources().end()) continue;
    std::string known;
    for (const NavSource& source : log.sources()) known += (known.empty() ? "" : ", ") + source.name;
    return fail(Error::Code::kBadOption,
                fmt::format("'{}' has a mount, but is no source of the navigation: {}", name, known));
  }
  const NavSource* fastest = log.best(NavQuantity::kVelocity);
  std::optional<VelocitySource> velocity;
  if (fastest != nullptr) velocity = velocity_source(*fastest, mount_of(options, fastest->name));
  std::vector<HeadingSource> headings;
  for (const NavSource& source : log.sources()) {
    if (source.quantity != NavQuantity::kHeading && source.quantity != NavQuantity::kAttitude) continue;
    if (auto heading = heading_source(source, mount_of(options, source.name))) headings.push_back(*std::move(heading));
  }
  // The one with the most samples first.
  std::ranges::sort(headings, [](const HeadingSource& a, const HeadingSource& b) {
    return std::tuple(b.yaw_rad.size(), a.name) < std::tuple(a.yaw_rad.size(), b.name);
  });
  if (!velocity || headings.empty()) {
    return fail(Error::Code::kUnsupported,
                fmt::format("the navigation has no valid {}", !velocity && headings.empty() ? "velocity and no heading"
                                                              : !velocity                   ? "velocity over ground"
                                                                                            : "heading or attitude"));
  }
  Navigation navigation{*std::move(velocity), std::move(headings), std::nullopt};
  if (const NavSource* depth = log.best(NavQuantity::kDepth)) navigation.depth = number_source(*depth);
  return navigation;
}

/// A stretch of time.
struct Span {
  double from_s, to_s;
};

/// The time that is common to all that is needed.
Result<Span> common_span(const std::vector<double>& beam_times_s, const Navigation& navigation) {
  const Span beams{beam_times_s.front(), beam_times_s.back()};
  Span span = beams;
  const auto cut = [&](const TimeSeries& series, const std::string& what) -> Result<void> {
    if (series.from_s() >= span.to_s || series.to_s() <= span.from_s) {
      return fail(Error::Code::kUnsupported,
                  fmt::format("beams and navigation do not overlap in time: the beams are from {:.3f} to {:.3f} s, the "
                              "{} is from {:.3f} to {:.3f} s",
                              beams.from_s, beams.to_s, what, series.from_s(), series.to_s()));
    }
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
double sweep_duration_s(const std::vector<HeardSweep>& sweeps) {
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

/// A pose for each beam.
Result<Trajectory> trajectory_of(const Solver& solver, const Navigation& navigation, const SlamOptions& options,
                                 const std::vector<double>& beam_times_s) {
  const Eigen::Vector3d velocity_place = mount_of(options, navigation.velocity.name).translation();
  const HeadingSource& main = navigation.headings.front();
  const std::vector<SlamProblem::Way> ways = solver.problem().ways(solver.unknowns());
  std::vector<StampedPose> poses;
  for (const double time_s : beam_times_s) {
    const auto between = solver.problem().between_knots(time_s);
    if (!between || (!poses.empty() && time_s <= poses.back().time_s)) continue;
    const auto [knot, share] = *between;
    const Eigen::Vector3d state = solver.knot_at(knot, share);
    const Eigen::Vector2d place = state.head<2>() + solver.problem().bulge(solver.unknowns(), ways[knot], knot, time_s);
    const double depth_m = navigation.depth ? navigation.depth->at(time_s) : 0.0;
    Pose pose = pose_from_rpy({place.x(), place.y(), -depth_m}, main.roll_rad ? main.roll_rad->at(time_s) : 0.0,
                              main.pitch_rad ? main.pitch_rad->at(time_s) : 0.0, main.yaw_rad.at(time_s) + state.z());
    // The knots are where the velocity is measured.
    const Eigen::Vector3d offset = pose.rotation() * Eigen::Vector3d(velocity_place.x(), velocity_place.y(), 0.0);
    pose.translation().head<2>() -= offset.head<2>();
    poses.push_back({time_s, pose});
  }
  const Eigen::Vector2d origin = poses.front().map_from_body.translation().head<2>();
  for (StampedPose& pose : poses) pose.map_from_body.translation().head<2>() -= origin;
  return Trajectory::make(std::move(poses));
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
  Result<NavLog> log = NavLog::make(state_->sources, NavClock::kUnknown);
  if (!log) return tl::unexpected(log.error());
  Result<Navigation> navigation = navigation_of(*log, options);
  if (!navigation) return tl::unexpected(navigation.error());
  const Result<Span> span = common_span(times_s, *navigation);
  if (!span) return tl::unexpected(span.error());

  std::vector<HeardSweep> sweeps = state_->sweeps;
  SweepAssembler rest = state_->assembler;
  if (const auto sweep = rest.finish()) sweeps.push_back(state_->heard(*sweep));
  if (options.matching == Matching::kPairs && sweeps.size() < 2) {
    return fail(Error::Code::kUnsupported, "there is only one sweep, and nothing to match it with");
  }
  const double step_s = sweep_duration_s(sweeps) / kKnotsOfSweep;
  if (!(step_s > 0.0)) return fail(Error::Code::kUnsupported, "all beams have the same time");
  Result<std::vector<double>> knots = knot_times(*span, step_s, times_s.size());
  if (!knots) return tl::unexpected(knots.error());

  const Pose velocity_from_sonar =
      Pose(Eigen::Translation3d(-mount_of(options, navigation->velocity.name).translation())) * options.body_from_sonar;
  const SonarMount mount{velocity_from_sonar.translation().head<2>(), yaw_of(velocity_from_sonar)};
  Solver solver(SlamProblem(*std::move(knots), navigation->velocity, navigation->headings), mount, sweeps,
                options.seed);
  const auto undetermined = [] {
    return fail(Error::Code::kUnsupported, "the recording does not determine the trajectory");
  };
  SlamReport report;
  if (options.matching == Matching::kPairs) {
    for (std::size_t i = 0; i < kAlone; ++i) {
      if (!solver.step(std::nullopt)) return undetermined();
    }
    for (const double gate_m : kGates_m) {
      if (!solver.step(gate_m)) return undetermined();
    }
  }
  Result<Trajectory> trajectory = trajectory_of(solver, *navigation, options, times_s);
  if (!trajectory) return tl::unexpected(trajectory.error());
  SlamSolution solution{*std::move(trajectory), {}, std::move(report)};
  if (options.matching == Matching::kPairs) solution.calibration = calibration_of(solver);
  SlamReport& r = solution.report;
  r.beams = times_s.size();
  r.sweeps = static_cast<std::size_t>(
      std::ranges::count_if(sweeps, [](const HeardSweep& s) { return s.extent != Sweep::Extent::kCut; }));
  r.echoes = solver.echoes();
  r.knots = solver.problem().knots();
  r.pairs = solver.pairs().pairs.size();
  std::vector<double> distances_m;
  for (const EchoPair& pair : solver.pairs().pairs) distances_m.push_back(std::abs(pair.distance_m));
  if (!distances_m.empty()) r.pair_median_m = median(std::move(distances_m));
  r.loops_found = solver.pairs().loops_found;
  r.loops_kept = solver.pairs().loops_kept;
  r.velocities = navigation->velocity.ahead.size();
  r.velocities_clipped = navigation->velocity.clipped;
  r.longest_gap_s = navigation->velocity.ahead.longest_step_s();
  r.velocity = navigation->velocity.name;
  r.heading = navigation->headings.front().name;
  return solution;
}

}  // namespace pingvox
