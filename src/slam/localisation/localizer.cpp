#include "pingvox/slam/localizer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/option_errors.hpp"
#include "base/without_exceptions.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "pingvox/geometry/random.hpp"
#include "slam/localisation/beam_likelihood.hpp"
#include "slam/localisation/particles.hpp"
#include "slam/localisation/pose_search.hpp"
#include "sonar/internal/echo_stream.hpp"

namespace pingvox {
namespace {

/// Up to a beam short of it counts: heads jitter.
constexpr double kTurn = 1.98 * std::numbers::pi;
constexpr std::size_t kMaxTurnBeams = 2000;  ///< of a head that stands still
constexpr std::size_t kMaxSearchBeams = 400;
/// Averages of the echoes' likelihood are over this many echoes, about.
constexpr double kShortTerm = 40.0, kLongTerm = 600.0;
/// The vehicle is lost when the short-term likelihood falls under this part of the long-term one. Augmented Monte
/// Carlo localisation (Thrun et al. 2005, table 8.3) with poses that fit instead of random ones.
constexpr double kLostShare = 0.55;
/// Least mean likelihood of echoes at a pose that is believed. In a small
/// room it is 0.3 at poses that are wrong.
constexpr double kMinFit = 0.45, kSureFit = 0.6;
constexpr double kSure_m = 0.3, kSure_rad = 5.0 * kDegree_rad;
/// Spread of the particles around what a search found.
constexpr double kSeed_m = 0.05, kSeed_rad = 1.5 * kDegree_rad;

/// Where the body was when a beam was heard.
struct Placed {
  Pose2 odometry;
  Eigen::Matrix3d level_from_body = Eigen::Matrix3d::Identity();
  double turned_rad = 0.0;  ///< by the head so far
};

struct TurnBeam {
  HeardBeam beam;  ///< in the odometry's frame
  double turned_rad = 0.0;
};

}  // namespace

Result<void> BeamLikelihood::validate() const {
  OptionErrors errors;
  errors.require_within("range_deviation_m", range_deviation_m, 1e-3, 10.0);
  errors.require_within("bearing_deviation_rad", bearing_deviation_rad, 0.0, 1.0);
  errors.require_within("stray", stray, 1e-6, 1.0);
  errors.require_within("unknown", unknown, 1e-6, 1.0);
  errors.require_within("behind", behind, 1e-6, 1.0);
  errors.require_within("silent_wall", silent_wall, 1e-6, 1.0);
  errors.require_within("beam_weight", beam_weight, 0.0, 1.0);
  return errors.result("beam likelihood");
}

Result<void> MotionNoise::validate() const {
  OptionErrors errors;
  errors.require_within("position_m_per_sqrt_s", position_m_per_sqrt_s, 0.0, 100.0);
  errors.require_within("position_m_per_sqrt_m", position_m_per_sqrt_m, 0.0, 100.0);
  errors.require_within("yaw_rad_per_sqrt_s", yaw_rad_per_sqrt_s, 0.0, 2.0 * std::numbers::pi);
  errors.require_within("yaw_rad_per_sqrt_rad", yaw_rad_per_sqrt_rad, 0.0, 2.0 * std::numbers::pi);
  return errors.result("motion noise");
}

Result<void> LocalizerOptions::validate() const {
  OptionErrors errors;
  errors.require_within("min_particles", static_cast<double>(min_particles), 10.0, 1e6);
  errors.require_within("max_particles", static_cast<double>(max_particles), static_cast<double>(min_particles), 1e6);
  errors.require(sound_speed_ratio > 0.0 && std::isfinite(sound_speed_ratio), "sound_speed_ratio", "finite and above 0",
                 sound_speed_ratio);
  if (!body_from_sonar.matrix().allFinite()) errors.add("body_from_sonar must be finite");
  errors.add(beam.validate());
  errors.add(noise.validate());
  if (const auto valid = without.validate(); !valid) errors.add("without odometry: " + valid.error().message);
  errors.add(filter.validate());
  errors.add(echo.validate());
  return errors.result("localizer");
}

struct Localizer::State {
  State(DistanceField the_field, const LocalizerOptions& the_options)
      : field(std::move(the_field)),
        options(the_options),
        random(options.seed),
        stream(options.filter, options.echo, EchoStream::Wait::kForNeighbours) {}

  DistanceField field;
  LocalizerOptions options;
  Random random;
  EchoStream stream;

  // The motion.
  std::optional<double> time_s;    ///< of the last beam
  std::optional<Pose> next, last;  ///< odometry: for the next beam, and the last that was used
  PlaneFrame odometry{Pose2{}};    ///< all motion so far
  Pose2 odometry_pose;             ///< the same
  Eigen::Matrix3d level_from_body = Eigen::Matrix3d::Identity();
  double height_m = 0.0;

  // The head.
  std::optional<double> bearing_rad;
  double turned_rad = 0.0;  ///< sum of its steps, whichever way
  std::uint64_t beams = 0;
  std::map<std::uint64_t, Placed> waiting;  ///< beams whose echo is not known yet, by number
  std::deque<TurnBeam> turn;                ///< the last turn of the head

  // The filter. No particles: not found yet.
  Particles particles;
  std::vector<PoseHypothesis> groups;  ///< as of the last quarter of a turn
  Pose2 anchor;                        ///< near the most likely one
  double grouped_rad = 0.0;
  double since_rad = 0.0;  ///< turned_rad when what is believed began
  double searched_rad = 0.0;
  std::optional<double> lost_rad;  ///< turned_rad when it was found to be wrong
  double short_term = 0.5, long_term = 0.5;
  double fit = 0.0;  ///< of the last turn at the most likely pose
  /// Whether another turn of the head, searched for itself, led to the same pose, and the pose has fitted since.
  bool is_confirmed = false;
  std::optional<double> doubted_rad;  ///< turned_rad when it no longer did

  void move(double step_s);
  void take(const EchoStream::BeamWithEcho& heard);
  void weigh(const HeardBeam& beam);
  void resample(const std::vector<double>& weights);
  void look_after();
  void group();
  void search();
  void confirm();
  std::vector<ScoredPose> candidates(const std::vector<HeardBeam>& beams_now) const;
  void adopt(const std::vector<ScoredPose>& found, const std::vector<HeardBeam>& beams_now);
  std::vector<HeardBeam> turn_beams() const;
  void seed(const std::vector<ScoredPose>& found);
  PoseHypothesis around_anchor() const;
};

/// Moves the particles with the odometry, and apart.
void Localizer::State::move(double step_s) {
  const MotionNoise& noise = next ? options.noise : options.without;
  Pose2 step;
  if (next) {
    const Pose2 now = pose2_of(*next);
    if (last) {
      step = PlaneFrame(pose2_of(*last)).inverse() * now;
      step.yaw_rad = wrap_angle(step.yaw_rad);
    }
    level_from_body = Eigen::AngleAxisd(-now.yaw_rad, Eigen::Vector3d::UnitZ()) * next->rotation();
    height_m = next->translation().z();
    last = std::exchange(next, std::nullopt);
  }
  odometry_pose = odometry * step;
  odometry = PlaneFrame(odometry_pose);
  anchor = PlaneFrame(anchor) * step;
  const double position_m =
      std::sqrt(std::pow(noise.position_m_per_sqrt_s, 2) * step_s +
                std::pow(noise.position_m_per_sqrt_m, 2) * std::hypot(step.place_m.x(), step.place_m.y()));
  const double yaw_rad = std::sqrt(std::pow(noise.yaw_rad_per_sqrt_s, 2) * step_s +
                                   std::pow(noise.yaw_rad_per_sqrt_rad, 2) * std::abs(step.yaw_rad));
  for (Pose2& pose : particles.poses) {
    pose = PlaneFrame(pose) * step;
    pose.place_m.x() += position_m * random.normal();
    pose.place_m.y() += position_m * random.normal();
    pose.yaw_rad += yaw_rad * random.normal();
  }
}

/// Takes a beam whose echo is known.
void Localizer::State::take(const EchoStream::BeamWithEcho& heard) {
  const auto place = waiting.find(heard.number);
  assert(place != waiting.end());
  const Placed placed = place->second;
  waiting.erase(place);

  const Eigen::Vector3d sonar = placed.level_from_body * options.body_from_sonar.translation();
  const Eigen::Vector3d ahead(std::cos(heard.beam.bearing_rad), std::sin(heard.beam.bearing_rad), 0.0);
  const Eigen::Vector3d direction = placed.level_from_body * (options.body_from_sonar.rotation() * ahead);
  const double level = direction.head<2>().norm();
  constexpr double kMinLevel = 0.1;  // a beam that goes up or down meets no wall
  if (!(level > kMinLevel)) return;
  const double end_m = static_cast<double>(heard.beam.intensities.size()) * heard.beam.bin_length_m;
  const double range_m = heard.echo ? heard.echo->range_m : std::min(end_m, options.echo.max_range_m);
  const HeardBeam beam{heard.beam.time_s, sonar.head<2>(), direction.head<2>() / level,
                       range_m * level * options.sound_speed_ratio, heard.echo.has_value()};
  const HeardBeam in_odometry = transform(PlaneFrame(placed.odometry), beam);
  turn.push_back({in_odometry, placed.turned_rad});
  while (!turn.empty() &&
         (turn.size() > kMaxTurnBeams || turn.front().turned_rad < turned_rad - 2.0 * std::numbers::pi)) {
    turn.pop_front();
  }
  if (!particles.poses.empty()) weigh(transform(odometry.inverse(), in_odometry));
}

void Localizer::State::weigh(const HeardBeam& beam) {
  const BeamJudge judge(beam, field, options.beam);
  const std::vector<double> before = particles.weights();
  double likelihood = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double log = judge.log_likelihood(PlaneFrame(particles.poses[i]));
    if (beam.has_echo) likelihood += before[i] * std::exp(log);
    particles.log_weights[i] += options.beam.beam_weight * log;
  }
  if (beam.has_echo) {
    short_term += (likelihood - short_term) / kShortTerm;
    if (!lost_rad) long_term += (likelihood - long_term) / kLongTerm;
  }
  const std::vector<double> weights = particles.weights();
  double squares = 0.0;
  for (const double weight : weights) squares += weight * weight;
  if (1.0 / squares < 0.5 * static_cast<double>(weights.size())) resample(weights);
}

void Localizer::State::resample(const std::vector<double>& weights) {
  const double offset = random.uniform();
  const double asked = kld_particles(particles.poses, draw_particles(weights, weights.size(), offset));
  const double count =
      std::clamp(asked, static_cast<double>(options.min_particles), static_cast<double>(options.max_particles));
  Particles chosen;
  for (const std::size_t i : draw_particles(weights, static_cast<std::size_t>(count), offset)) {
    chosen.poses.push_back(particles.poses[i]);
  }
  chosen.log_weights.assign(chosen.poses.size(), 0.0);
  particles = std::move(chosen);
}

/// What is done from time to time: groups of particles, and a search when the vehicle is lost.
void Localizer::State::look_after() {
  if (particles.poses.empty()) {
    if (turned_rad - searched_rad >= kTurn) search();
    return;
  }
  if (short_term >= std::max(kLostShare * long_term, kMinFit)) {
    lost_rad.reset();
  } else if (!lost_rad) {
    lost_rad = turned_rad;
  }
  if (lost_rad && turned_rad - *lost_rad >= kTurn && turned_rad - searched_rad >= kTurn) {
    search();
  } else if (turned_rad - grouped_rad >= 0.5 * std::numbers::pi) {
    group();
    // Once the turn that the search used, or that did not fit, is behind.
    const bool is_one = !groups.empty() && groups.front().weight >= kSureWeight;
    const bool is_next_turn = turned_rad - std::max(searched_rad, doubted_rad.value_or(0.0)) >= kTurn;
    if (!is_confirmed && is_next_turn && (doubted_rad || (is_one && !lost_rad))) confirm();
  }
}

std::vector<HeardBeam> Localizer::State::turn_beams() const {
  std::vector<HeardBeam> beams_now;
  const PlaneFrame now_from_odometry = odometry.inverse();
  const std::size_t count = std::min(turn.size(), kMaxSearchBeams);
  for (std::size_t i = 0; i < count; ++i) {
    beams_now.push_back(transform(now_from_odometry, turn[i * turn.size() / count].beam));
  }
  return beams_now;
}

void Localizer::State::group() {
  grouped_rad = turned_rad;
  groups = groups_of(particles);
  if (groups.empty()) return;
  anchor = pose_of(groups.front());
  const double before = std::exchange(fit, fit_of(turn_beams(), field, options.beam, anchor).value_or(0.0));
  if (before < kSureFit || fit >= kSureFit) return;
  is_confirmed = false;
  doubted_rad = turned_rad;
}

/// All poses of the map and those that are believed, by the last turn of the head: the most likely first.
std::vector<ScoredPose> Localizer::State::candidates(const std::vector<HeardBeam>& beams_now) const {
  std::vector<ScoredPose> found = search_poses(field, beams_now, options.beam);
  std::vector<BeamJudge> judges;
  for (const HeardBeam& beam : beams_now) judges.emplace_back(beam, field, options.beam);
  for (const PoseHypothesis& believed : groups) {
    found.push_back(refine_pose(judges, options.beam, pose_of(believed), 0.1, 2.0 * kDegree_rad));
  }
  return without_neighbours(std::move(found), 0.3, 10.0 * kDegree_rad, kMaxHypotheses);
}

/// Begins with what the last turn of the head says.
void Localizer::State::search() {
  const std::vector<HeardBeam> beams_now = turn_beams();
  adopt(candidates(beams_now), beams_now);
}

/// Asks another turn of the head, by itself: what looks like the right place in one by chance does not in the next.
void Localizer::State::confirm() {
  const std::vector<HeardBeam> beams_now = turn_beams();
  const std::vector<ScoredPose> found = candidates(beams_now);
  if (found.empty()) return;
  const Pose2& best = found.front().pose;
  doubted_rad.reset();
  if (!is_near(best, anchor, kHypothesis_m, kHypothesis_rad)) return adopt(found, beams_now);
  is_confirmed = is_distinct(found);
  // Boulders look alike: what is here may be there, too.
  if (!is_confirmed) doubted_rad = turned_rad;
}

void Localizer::State::adopt(const std::vector<ScoredPose>& found, const std::vector<HeardBeam>& beams_now) {
  searched_rad = turned_rad;
  is_confirmed = false;
  doubted_rad.reset();
  if (found.empty()) return;
  seed(found);
  const double best_fit = fit_of(beams_now, field, options.beam, found.front().pose).value_or(0.0);
  short_term = long_term = best_fit;
  since_rad = turn.empty() ? turned_rad : turn.front().turned_rad;
  lost_rad.reset();
  if (best_fit < kMinFit) lost_rad = turned_rad;
  group();
}

/// Particles around poses, as many around each as it is likely.
void Localizer::State::seed(const std::vector<ScoredPose>& found) {
  Particles all;
  const std::size_t count = std::clamp<std::size_t>(300 * found.size(), options.min_particles, options.max_particles);
  std::vector<double> weights;
  for (const ScoredPose& pose : found) {
    weights.push_back(std::exp(pose.log_likelihood - found.front().log_likelihood));
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  for (const std::size_t i : draw_particles(weights, count, random.uniform())) {
    const Pose2& pose = found[i].pose;
    all.poses.push_back({{pose.place_m.x() + kSeed_m * random.normal(), pose.place_m.y() + kSeed_m * random.normal()},
                         pose.yaw_rad + kSeed_rad * random.normal()});
  }
  all.log_weights.assign(all.poses.size(), 0.0);
  particles = std::move(all);
}

PoseHypothesis Localizer::State::around_anchor() const {
  return mean_near(particles, anchor, 2.0 * kHypothesis_m, 2.0 * kHypothesis_rad);
}

Localizer::Localizer(DistanceField field, const LocalizerOptions& options)
    : state_(std::make_unique<State>(std::move(field), options)) {
  assert(options.validate());
}
Localizer::~Localizer() = default;
Localizer::Localizer(Localizer&&) noexcept = default;
Localizer& Localizer::operator=(Localizer&&) noexcept = default;

void Localizer::start(double x_m, double y_m, double yaw_rad, double deviation_m, double deviation_rad) {
  State& s = *state_;
  s.particles = {};
  for (std::size_t i = 0; i < s.options.max_particles; ++i) {
    s.particles.poses.push_back({{x_m + deviation_m * s.random.normal(), y_m + deviation_m * s.random.normal()},
                                 yaw_rad + deviation_rad * s.random.normal()});
  }
  s.particles.log_weights.assign(s.particles.poses.size(), 0.0);
  s.anchor = {{x_m, y_m}, yaw_rad};
  s.since_rad = s.turned_rad;
  s.is_confirmed = true;
  s.doubted_rad.reset();
  s.lost_rad.reset();
  s.short_term = s.long_term = 0.5;
  s.group();
}

void Localizer::add(const StampedPose& odometry_from_body) {
  state_->next = odometry_from_body.map_from_body;
}

Result<void> Localizer::add(Beam beam) {
  return detail::without_exceptions([&]() -> Result<void> {
    State& s = *state_;
    if (s.time_s && !(beam.time_s >= *s.time_s)) {
      return fail(Error::Code::kCorrupt,
                  fmt::format("the times of the beams do not rise: beam {} is at {:.3f} s, the one "
                              "before it at {:.3f} s",
                              s.beams, beam.time_s, *s.time_s));
    }
    s.move(s.time_s ? beam.time_s - *s.time_s : 0.0);
    s.time_s = beam.time_s;
    if (s.bearing_rad) s.turned_rad += std::abs(wrap_angle(beam.bearing_rad - *s.bearing_rad));
    s.bearing_rad = beam.bearing_rad;
    s.waiting.emplace(s.beams++, Placed{s.odometry_pose, s.level_from_body, s.turned_rad});
    for (const EchoStream::BeamWithEcho& heard : s.stream.add(std::move(beam))) s.take(heard);
    s.look_after();
    return {};
  });
}

void Localizer::finish() {
  State& s = *state_;
  for (const EchoStream::BeamWithEcho& heard : s.stream.finish()) s.take(heard);
  if (s.particles.poses.empty()) {
    s.search();
  } else {
    s.group();
  }
}

std::optional<Localizer::Located> Localizer::pose() const {
  const State& s = *state_;
  if (s.particles.poses.empty() || !s.time_s) return std::nullopt;
  PoseHypothesis mean = s.around_anchor();
  if (!(mean.weight > 0.0)) mean = {s.anchor.place_m.x(), s.anchor.place_m.y(), s.anchor.yaw_rad, 0.0, 0.0, 0.0};
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(mean.x_m, mean.y_m, s.height_m);
  pose.linear() = Eigen::AngleAxisd(mean.yaw_rad, Eigen::Vector3d::UnitZ()) * s.level_from_body;
  return Located{*s.time_s, pose, mean.deviation_m, mean.deviation_rad};
}

bool Localizer::is_sure() const {
  const State& s = *state_;
  if (s.groups.empty() || !s.is_confirmed || s.lost_rad || s.turned_rad - s.since_rad < kTurn || s.fit < kSureFit)
    return false;
  if (s.groups.front().weight < kSureWeight) return false;
  const PoseHypothesis now = s.around_anchor();
  return now.weight >= kSureWeight && now.deviation_m <= kSure_m && now.deviation_rad <= kSure_rad;
}

std::vector<PoseHypothesis> Localizer::hypotheses() const {
  return groups_of(state_->particles);
}

std::size_t Localizer::particles() const {
  return state_->particles.poses.size();
}

}  // namespace pingvox
