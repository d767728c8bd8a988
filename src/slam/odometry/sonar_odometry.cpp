#include "slam/odometry/sonar_odometry.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>

#include "base/median.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "slam/loops/point_field.hpp"

namespace pingvox {
namespace {

/// How a vehicle may go when nothing is known: ahead at one of these speeds, turning if no heading tells it.
constexpr std::array kSpeeds_m_s = {0.0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8};
constexpr std::array kTurns_rad_s = {0.0, 0.06, -0.06, 0.12, -0.12};
/// How far from what is expected a match is looked for: by the change of the velocity from a sweep to the next, and as
/// a share of the reach; by the change of the turn rate, or by the error of the heading.
constexpr double kMaxChange_m_s = 0.25, kMaxMove = 0.5;
constexpr double kMaxTurnChange_rad_s = 2.5 * kDegree_rad, kMaxHeadingError_rad = 4.0 * kDegree_rad;
/// Cells in the reach of the sonar, in each round: coarse ones bear echoes that are not where they should be yet.
constexpr std::array kRoundCells = {25.0, 50.0, 100.0, 100.0};
/// What is farther from the vehicle than this, in reaches, is left out.
constexpr double kFarthest = 3.0;
constexpr double kMinPairScore = 0.35;
constexpr std::size_t kMinEchoes = 20;
/// A peak that is wider than this along some direction is one of a straight wall: it does not tell the way along it.
constexpr double kMaxSpread_cells = 2.3;
/// Where the way is shorter than this share of what the vehicle covered, it turned too much to tell its velocity.
constexpr double kMinWay = 0.3;
/// The fewest sweeps that match, as a share, with a heading and without: a sonar that sees less tells no trajectory.
constexpr double kMinMatched = 0.5, kMinMatchedAlone = 0.9;
/// Standard deviation of the way after one second [m / sqrt(s)]: how unevenly a vehicle moves.
constexpr double kDensity = 0.1;

/// How the vehicle moves in its own frame.
struct Motion {
  Eigen::Vector2d velocity_m_s = Eigen::Vector2d::Zero();
  double turn_rad_s = 0.0;
};

double middle_s(const SweepEchoes& sweep) {
  return 0.5 * (sweep.from_s + sweep.to_s);
}

/// What is known of a vehicle before its sonar tells how it moves.
struct Vehicle {
  Pose2 body_from_sonar;
  const HeadingSource* heading;  ///< nullptr: not known
};

/// The yaw by the heading; where none is known by the turning since some time.
double yaw_at(double time_s, double zero_s, double turn_rad_s, const Vehicle& vehicle) {
  return vehicle.heading != nullptr ? vehicle.heading->yaw_rad.at(time_s) : turn_rad_s * (time_s - zero_s);
}

/// By which the velocity in the frame of the body is to be multiplied for the way between two times.
Eigen::Matrix2d way_by_velocity(double from_s, double to_s, double turn_rad_s, const Vehicle& vehicle) {
  constexpr int kParts = 8;
  const double part_s = (to_s - from_s) / kParts;
  Eigen::Matrix2d way = Eigen::Matrix2d::Zero();
  for (int i = 0; i < kParts; ++i) {
    way += part_s * rotation2(yaw_at(from_s + (i + 0.5) * part_s, from_s, turn_rad_s, vehicle));
  }
  return way;
}

/// The echoes of a sweep within a distance of the vehicle at a time, before or after which it moves the same way. The
/// axes are those of the heading's zero; where no heading is known those of the vehicle.
std::vector<Eigen::Vector2d> place(const SweepEchoes& sweep, double zero_s, double within_m, const Motion& motion,
                                   const Vehicle& vehicle) {
  const Pose2& mount = vehicle.body_from_sonar;
  std::vector<Eigen::Vector2d> points_m;
  for (const EchoRun& run : sweep.runs) {
    const double ray_rad = mount.yaw_rad + run.bearing_rad;
    const Eigen::Vector2d in_body = mount.place_m + run.range_m * Eigen::Vector2d(std::cos(ray_rad), std::sin(ray_rad));
    const Eigen::Vector2d at = way_by_velocity(zero_s, run.time_s, motion.turn_rad_s, vehicle) * motion.velocity_m_s +
                               rotation2(yaw_at(run.time_s, zero_s, motion.turn_rad_s, vehicle)) * in_body;
    if (at.norm() < within_m) points_m.push_back(at);
  }
  return points_m;
}

/// How the vehicle moved between the middles of each sweep and the next one.
using Motions = std::vector<std::optional<Motion>>;

/// The motion at a place among the steps, by the last known one of the first `before` steps and the first known one
/// from `after` on: between them it changes evenly. Zero where none is known.
Motion motion_at(double place, std::size_t before, std::size_t after, const Motions& steps) {
  while (before > 0 && !steps[before - 1]) --before;
  while (after < steps.size() && !steps[after]) ++after;
  const bool has_before = before > 0, has_after = after < steps.size();
  if (!has_before && !has_after) return {};
  const Motion& a = *steps[has_before ? before - 1 : after];
  const Motion& b = *steps[has_after ? after : before - 1];
  const double share = has_before && has_after
                           ? (place - static_cast<double>(before - 1)) / static_cast<double>(after - (before - 1))
                           : 0.0;
  return {a.velocity_m_s + share * (b.velocity_m_s - a.velocity_m_s),
          a.turn_rad_s + share * (b.turn_rad_s - a.turn_rad_s)};
}

/// How the vehicle is taken to move around a step: from the sweep before it to its first one, during its first and its
/// second sweep, and from one to the other.
struct Guess {
  Motion until_first, in_first, in_second, between;
};

struct Match {
  Motion motion;
  double score;
};

/// The motion from sweep k to the next, which is looked for among the echoes of sweep k and the one before: a vehicle
/// that turns against the head sees too little in one sweep.
std::optional<Match> match_with_next(std::size_t k, std::span<const SweepEchoes> sweeps, const Guess& guess,
                                     double cells_of_reach, const Vehicle& vehicle) {
  const SweepEchoes &first = sweeps[k], &second = sweeps[k + 1];
  const double from_s = middle_s(first), to_s = middle_s(second), duration_s = to_s - from_s;
  if (first.runs.size() < kMinEchoes || second.runs.size() < kMinEchoes || !(duration_s > 0.0)) return std::nullopt;
  const double reach_m = reach_of(sweeps.subspan(k, 2)), cell_m = reach_m / cells_of_reach;
  const double within_m = kFarthest * reach_m;
  std::vector<Eigen::Vector2d> around = place(first, from_s, within_m, guess.in_first, vehicle);
  if (k > 0) {
    const std::vector<Eigen::Vector2d> before = place(sweeps[k - 1], from_s, within_m, guess.until_first, vehicle);
    around.insert(around.end(), before.begin(), before.end());
  }
  const std::vector<Eigen::Vector2d> points_m = place(second, to_s, within_m, guess.in_second, vehicle);
  if (around.empty() || points_m.size() < kMinEchoes) return std::nullopt;
  const double most_m = std::min(kMaxChange_m_s * duration_s, kMaxMove * reach_m);
  const bool has_heading = vehicle.heading != nullptr;
  const MatchWindow window{
      static_cast<int>(std::ceil(most_m / cell_m)),
      has_heading ? kMaxHeadingError_rad : std::min(kMaxTurnChange_rad_s * duration_s, std::numbers::pi)};
  const auto [velocity_m_s, expected_rad_s] = guess.between;
  const Pose2 expected{way_by_velocity(from_s, to_s, expected_rad_s, vehicle) * velocity_m_s,
                       has_heading ? 0.0 : expected_rad_s * duration_s};
  if (!(expected.place_m.norm() < within_m)) return std::nullopt;
  const auto found = PointField(around, cell_m, window.cells).match(points_m, expected, window, kMinPairScore);
  if (!found) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> spread(found->covariance.topLeftCorner<2, 2>().eval());
  if (std::sqrt(spread.eigenvalues()[1]) > kMaxSpread_cells * cell_m) return std::nullopt;
  // A heading is known better than the picture tells it.
  const double turn_rad_s = has_heading ? 0.0 : found->pose.yaw_rad / duration_s;
  const Eigen::Matrix2d way = way_by_velocity(from_s, to_s, turn_rad_s, vehicle);
  if (way.determinant() < kMinWay * kMinWay * duration_s * duration_s) return std::nullopt;
  return Match{{way.inverse() * found->pose.place_m, turn_rad_s}, found->score};
}

/// The steps as if the vehicle went ahead at one speed all the time: the one that fits best.
Motions steps_at_one_speed(std::span<const SweepEchoes> sweeps, const Vehicle& vehicle) {
  const std::span<const double> turns_rad_s(kTurns_rad_s.begin(), vehicle.heading != nullptr ? 1 : kTurns_rad_s.size());
  Motions best(sweeps.size() - 1);
  double highest = 0.0;
  for (const double speed_m_s : kSpeeds_m_s) {
    Motions steps(sweeps.size() - 1);
    double sum = 0.0;
    for (std::size_t k = 0; k < steps.size(); ++k) {
      double score = 0.0;
      for (const double turn_rad_s : turns_rad_s) {
        const Motion motion{{speed_m_s, 0.0}, turn_rad_s};
        const auto match = match_with_next(k, sweeps, {motion, motion, motion, motion}, kRoundCells.front(), vehicle);
        if (!match || match->score <= score) continue;
        score = match->score;
        steps[k] = match->motion;
      }
      sum += score;
    }
    if (sum <= highest) continue;
    highest = sum;
    best = std::move(steps);
  }
  return best;
}

/// The steps once more, each where those before and after it lead.
Motions refine(const Motions& steps, std::span<const SweepEchoes> sweeps, double cells_of_reach,
               const Vehicle& vehicle) {
  Motions refined(steps.size());
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const auto at = static_cast<double>(k);
    const Guess guess{motion_at(at - 1.0, k, k, steps), motion_at(at - 0.5, k, k, steps),
                      motion_at(at + 0.5, k + 1, k + 1, steps), motion_at(at, k, k + 1, steps)};
    if (const auto match = match_with_next(k, sweeps, guess, cells_of_reach, vehicle)) refined[k] = match->motion;
  }
  return refined;
}

/// Median time from the middle of a sweep to that of the next. REQUIRES two sweeps.
double sweep_step_s(std::span<const SweepEchoes> sweeps) {
  std::vector<double> steps_s;
  for (std::size_t k = 0; k + 1 < sweeps.size(); ++k) steps_s.push_back(middle_s(sweeps[k + 1]) - middle_s(sweeps[k]));
  return median(std::move(steps_s));
}

/// Whether a sweep did not match between others that did.
bool misses_one_within(const Motions& steps) {
  const auto known = [](const std::optional<Motion>& step) { return step.has_value(); };
  const auto first = std::ranges::find_if(steps, known);
  const auto last = std::ranges::find_if(steps.rbegin(), steps.rend(), known).base();
  return first < last && !std::all_of(first, last, known);
}

std::size_t least_matched(std::size_t steps, bool has_heading) {
  const double share = has_heading ? kMinMatched : kMinMatchedAlone;
  return static_cast<std::size_t>(std::max(1.0, std::ceil(share * static_cast<double>(steps) - 1e-9)));
}

NavSample sample_at(double time_s, const Eigen::Vector3d& value) {
  NavSample sample;
  sample.time_s = time_s;
  sample.value = value;
  return sample;
}

}  // namespace

VelocitySource sonar_velocity(const NavSource& source) {
  std::vector<double> times_s, ahead, left;
  for (const NavSample& sample : source.samples) {
    times_s.push_back(sample.time_s);
    ahead.push_back(sample.value.x());
    left.push_back(sample.value.y());
  }
  TimeSeries density({times_s.front()}, {kDensity});
  return {source.name,
          TimeSeries(times_s, std::move(ahead), kMaxStep_sweeps),
          TimeSeries(times_s, std::move(left), kMaxStep_sweeps),
          std::move(density),
          0,
          true};
}

SonarOdometry sonar_odometry(std::span<const SweepEchoes> sweeps, const Pose2& body_from_sonar,
                             const HeadingSource* heading) {
  SonarOdometry odometry{{std::string(kSonarSource), NavQuantity::kVelocity, {}},
                         {std::string(kSonarSource), NavQuantity::kHeading, {}}};
  if (sweeps.size() < 2) return odometry;
  const Vehicle vehicle{body_from_sonar, heading};
  Motions steps = steps_at_one_speed(sweeps, vehicle);
  for (const double cells : kRoundCells) steps = refine(steps, sweeps, cells, vehicle);

  std::vector<NavSample>&velocities = odometry.velocity.samples, &headings = odometry.heading.samples;
  const double begin_s = sweeps.front().from_s, end_s = sweeps.back().to_s;
  double yaw_rad = 0.0, turn_rad_s = 0.0, since_s = begin_s;
  headings.push_back(sample_at(begin_s, Eigen::Vector3d::Zero()));
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (!steps[k]) continue;
    const double from_s = middle_s(sweeps[k]), to_s = middle_s(sweeps[k + 1]);
    ++odometry.matched;
    turn_rad_s = steps[k]->turn_rad_s;
    yaw_rad += turn_rad_s * (to_s - since_s);
    since_s = to_s;
    headings.push_back(sample_at(to_s, {yaw_rad, 0.0, 0.0}));
    const Eigen::Vector2d& velocity = steps[k]->velocity_m_s;
    velocities.push_back(sample_at(0.5 * (from_s + to_s), {velocity.x(), velocity.y(), 0.0}));
  }
  odometry.is_observable = odometry.matched >= least_matched(steps.size(), heading != nullptr);
  if (heading == nullptr && (odometry.matched < kMatchesAlone || misses_one_within(steps)))
    odometry.is_observable = false;
  if (velocities.empty()) return odometry;
  // The first and the last motion go on to the ends.
  velocities.insert(velocities.begin(), sample_at(begin_s, velocities.front().value));
  velocities.push_back(sample_at(end_s, velocities.back().value));
  headings.push_back(sample_at(end_s, {yaw_rad + turn_rad_s * (end_s - since_s), 0.0, 0.0}));
  return odometry;
}

std::optional<VelocityCheck> check_velocity(const VelocitySource& velocity, std::span<const SweepEchoes> sweeps,
                                            const Pose2& velocity_from_sonar, const HeadingSource& heading) {
  constexpr std::size_t kMinSamples = 5;
  constexpr double kNoise_m_s = 0.05, kShareOfSpeed = 0.35;
  constexpr int kParts = 16;
  const SonarOdometry odometry = sonar_odometry(sweeps, velocity_from_sonar, &heading);
  if (!odometry.is_observable || odometry.matched < kMinSamples) return std::nullopt;
  const double over_s = sweep_step_s(sweeps);
  std::vector<double> differences_m_s, measured_m_s, seen_m_s;
  // The first and the last sample go on to the ends.
  for (std::size_t i = 1; i + 1 < odometry.velocity.samples.size(); ++i) {
    const NavSample& sample = odometry.velocity.samples[i];
    const Eigen::Vector3d& seen = sample.value;
    const double from_s = sample.time_s - 0.5 * over_s, part_s = over_s / kParts;
    if (velocity.ahead.gap_s(from_s, from_s + over_s) > 0.0) continue;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (int part = 0; part < kParts; ++part) {
      const double at_s = from_s + (part + 0.5) * part_s;
      mean += Eigen::Vector2d(velocity.ahead.at(at_s), velocity.left.at(at_s)) / kParts;
    }
    differences_m_s.push_back((seen.head<2>() - mean).norm());
    measured_m_s.push_back(mean.norm());
    seen_m_s.push_back(seen.head<2>().norm());
  }
  if (differences_m_s.size() < kMinSamples) return std::nullopt;
  const std::size_t compared = differences_m_s.size();
  const double difference_m_s = median(std::move(differences_m_s));
  const double speed_m_s = std::max(median(std::move(measured_m_s)), median(std::move(seen_m_s)));
  return VelocityCheck{compared, difference_m_s, over_s, difference_m_s > kNoise_m_s + kShareOfSpeed * speed_m_s};
}

void GrowingOdometry::extend(std::span<const SweepEchoes> sweeps, const Pose2& body_from_sonar,
                             const HeadingSource* heading) {
  // What these say of the first of them is known better from before.
  constexpr std::size_t kLooked = 12;
  const SonarOdometry odometry =
      sonar_odometry(sweeps.last(std::min(kLooked, sweeps.size())), body_from_sonar, heading);
  is_observable_ = odometry.is_observable;
  has_heading_ = heading != nullptr;
  const bool is_first = !has_motion();
  if (odometry.matched == 0 || (is_first && !odometry.is_observable)) return;
  // The first and the last samples go on to the ends.
  const std::span<const NavSample> velocities(odometry.velocity.samples), turned(odometry.heading.samples);
  for (const NavSample& sample : velocities.first(velocities.size() - 1)) {
    if (!is_first && sample.time_s <= velocity_.samples.back().time_s) continue;
    velocity_.samples.push_back(sample);
    if (!is_first || sample.time_s > velocities.front().time_s) ++matched_;
  }
  last_velocity_ = sample_at(sweeps.back().to_s, velocity_.samples.back().value);
  std::vector<double> times_s, yaws_rad;
  for (const NavSample& sample : turned) {
    if (!times_s.empty() && sample.time_s <= times_s.back()) continue;
    times_s.push_back(sample.time_s);
    yaws_rad.push_back(sample.value.x());
  }
  const TimeSeries yaw_rad(times_s, yaws_rad);
  const double off_rad =
      is_first ? 0.0 : heading_.samples.back().value.x() - yaw_rad.at(heading_.samples.back().time_s);
  for (const NavSample& sample : turned.first(turned.size() - 1)) {
    if (!is_first && sample.time_s <= heading_.samples.back().time_s) continue;
    heading_.samples.push_back(sample_at(sample.time_s, {sample.value.x() + off_rad, 0.0, 0.0}));
  }
  last_heading_ = sample_at(turned.back().time_s, {turned.back().value.x() + off_rad, 0.0, 0.0});
}

void GrowingOdometry::forget_before(double time_s) {
  for (NavSource* source : {&velocity_, &heading_}) {
    std::vector<NavSample>& samples = source->samples;
    const auto first = std::ranges::upper_bound(samples, time_s, {}, &NavSample::time_s);
    if (first != samples.begin()) samples.erase(samples.begin(), first - 1);
  }
}

std::size_t GrowingOdometry::min_matched(std::size_t steps) const {
  return least_matched(steps, has_heading_);
}

SonarSources GrowingOdometry::sources() const {
  SonarSources sources{velocity_, std::nullopt};
  sources.velocity.samples.push_back(last_velocity_);
  if (has_heading_) return sources;
  sources.heading = heading_;
  sources.heading->samples.push_back(last_heading_);
  return sources;
}

}  // namespace pingvox
