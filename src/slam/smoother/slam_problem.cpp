#include "slam/smoother/slam_problem.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "slam/odometry/heading_deviation.hpp"

namespace pingvox {
namespace {

/// Standard deviations of the priors.
constexpr double kFirstPosition_m = 1e-3;
constexpr double kVelocityYaw_rad = 10.0 * kDegree_rad, kVelocityScale = 0.005, kWall = 0.5, kLever_m = 0.3;
constexpr double kConstant_rad = 3.0 * kDegree_rad, kHarmonic_rad = 5.0 * kDegree_rad;
/// A source whose headings differ more than this from the main one's says where it turned, not where north is.
constexpr double kRelative_rad = 20.0 * kDegree_rad;
/// Of a heading at a knot, and of its change over one second; the change where the source is silent.
constexpr double kHeading_rad = 2.0 * kDegree_rad, kTurnIn1s_rad = 0.3 * kDegree_rad,
                 kTurnInGap_rad = 20.0 * kDegree_rad;
/// Of the velocity where its source is silent: from knot to knot, and of a motion that is the same for all of a gap.
constexpr double kVelocityInGap_m_s = 0.3, kSteadyInGap_m_s = 0.1;
/// Longest step of the integration.
constexpr double kStep_s = 0.25;
constexpr double kMaxSteps = 64.0;

/// Priors on sensors that nobody calibrated.
SlamCalibration usual_calibration() {
  SlamCalibration usual;
  usual.velocity_yaw_rad.deviation = kVelocityYaw_rad;
  usual.velocity_scale.deviation = kVelocityScale;
  usual.wall_in_echo.deviation = kWall;
  usual.sonar_x_m.deviation = kLever_m;
  usual.sonar_y_m.deviation = kLever_m;
  return usual;
}

HeadingCalibration usual_heading() {
  HeadingCalibration usual;
  usual.constant_rad.deviation = kConstant_rad;
  for (Estimate* harmonic : {&usual.sin1_rad, &usual.cos1_rad, &usual.sin2_rad, &usual.cos2_rad}) {
    harmonic->deviation = kHarmonic_rad;
  }
  return usual;
}

/// The mean of angles on the circle.
double mean_angle(const HeadingSource& source, const HeadingSource& main) {
  double sine = 0.0, cosine = 0.0;
  const auto& times_s = source.yaw_rad.times_s();
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (times_s[i] < main.yaw_rad.from_s() || times_s[i] > main.yaw_rad.to_s()) continue;
    const double difference_rad = source.yaw_rad.values()[i] - main.yaw_rad.at(times_s[i]);
    sine += std::sin(difference_rad);
    cosine += std::cos(difference_rad);
  }
  return std::atan2(sine, cosine);
}

}  // namespace

SlamProblem::SlamProblem(std::vector<double> knot_times_s, VelocitySource velocity, std::vector<HeadingSource> headings,
                         const std::optional<SlamCalibration>& calibration)
    : knot_times_s_(std::move(knot_times_s)),
      velocity_(std::move(velocity)),
      headings_(std::move(headings)),
      calibration_(calibration.value_or(usual_calibration())) {
  assert(knot_times_s_.size() >= 2 && !headings_.empty());
  if (velocity_.by_sonar) calibration_.velocity_yaw_rad = calibration_.velocity_scale = {0.0, kHeld};
  for (const HeadingSource& source : headings_) {
    const bool is_of_velocity = source.name == velocity_.name && source.by_sonar == velocity_.by_sonar;
    HeadingPrior prior{usual_heading(), is_of_velocity};
    if (const HeadingCalibration* known = calibration_.heading(source.name)) {
      prior.deviation = *known;
    } else if (const double mean_rad = mean_angle(source, headings_.front()); std::abs(mean_rad) > kRelative_rad) {
      prior.deviation.constant_rad = {mean_rad, std::numbers::pi};
    }
    if (source.drifts) {
      HeadingCalibration& h = prior.deviation;
      h.sin1_rad = h.cos1_rad = h.sin2_rad = h.cos2_rad = {0.0, kHeld};
    }
    heading_priors_.push_back(std::move(prior));
  }
  const std::vector<double>& measured_s = velocity_.ahead.times_s();
  for (std::size_t k = 0; k + 1 < knots(); ++k) {
    const double from_s = knot_times_s_[k], to_s = knot_times_s_[k + 1];
    std::vector<double> times_s = {from_s};
    const auto fill_to = [&](double end_s) {
      const double begin_s = times_s.back();
      const double steps = std::min(std::ceil((end_s - begin_s) / kStep_s), kMaxSteps);
      for (double i = 1.0; i < steps; i += 1.0) times_s.push_back(begin_s + (end_s - begin_s) * i / steps);
      times_s.push_back(end_s);
    };
    for (auto next = std::ranges::upper_bound(measured_s, from_s); next != measured_s.end() && *next < to_s; ++next) {
      fill_to(*next);
    }
    fill_to(to_s);
    std::vector<Node> nodes;
    for (const double time_s : times_s) {
      nodes.push_back({time_s,
                       (time_s - from_s) / (to_s - from_s),
                       main_yaw_rad(time_s),
                       {velocity_.ahead.at(time_s), velocity_.left.at(time_s)}});
    }
    nodes_.push_back(std::move(nodes));
  }
  steady_m2_.assign(nodes_.size(), 0.0);
  for (const TimeSpan& gap : velocity_.ahead.gaps(knot_times_s_.front(), knot_times_s_.back())) {
    const double variance_m2 = steady_variance_m2(gap);
    const auto after = std::ranges::upper_bound(knot_times_s_, gap.from_s);
    auto k = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - knot_times_s_.begin() - 1, 0));
    for (; k < nodes_.size() && knot_times_s_[k] < gap.to_s; ++k) {
      const double share = gap.within(knot_times_s_[k], knot_times_s_[k + 1]) / (gap.to_s - gap.from_s);
      steady_m2_[k] += variance_m2 * share;
    }
  }
}

double SlamProblem::steady_variance_m2(const TimeSpan& gap) const {
  constexpr double kSteps = 1000.0;
  const double step_s = (gap.to_s - gap.from_s) / kSteps;
  Eigen::Vector2d way_s = Eigen::Vector2d::Zero();
  double farthest_s = 0.0;
  for (double i = 0.5; i < kSteps; i += 1.0) {
    const double yaw_rad = main_yaw_rad(gap.from_s + i * step_s);
    way_s += step_s * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
    farthest_s = std::max(farthest_s, way_s.norm());
  }
  return std::pow(kSteadyInGap_m_s * farthest_s, 2);
}

std::optional<std::pair<std::size_t, double>> SlamProblem::between_knots(double time_s) const {
  if (time_s < knot_times_s_.front() || time_s > knot_times_s_.back()) return std::nullopt;
  const auto after = std::ranges::upper_bound(knot_times_s_, time_s);
  const std::size_t next = std::min(static_cast<std::size_t>(after - knot_times_s_.begin()), knots() - 1);
  return std::pair{next - 1, (time_s - knot_times_s_[next - 1]) / (knot_times_s_[next] - knot_times_s_[next - 1])};
}

std::vector<Estimate> SlamProblem::global_priors() const {
  const SlamCalibration& c = calibration_;
  std::vector<Estimate> priors = {c.velocity_yaw_rad, c.velocity_scale, c.wall_in_echo, c.sonar_x_m, c.sonar_y_m};
  for (const HeadingPrior& prior : heading_priors_) {
    const HeadingCalibration& h = prior.deviation;
    priors.insert(priors.end(), {h.constant_rad, h.sin1_rad, h.cos1_rad, h.sin2_rad, h.cos2_rad});
  }
  return priors;
}

Unknowns SlamProblem::dead_reckoning() const {
  Unknowns unknowns{std::vector<Eigen::Vector3d>(knots(), Eigen::Vector3d::Zero()),
                    Eigen::VectorXd::Zero(static_cast<Eigen::Index>(globals()))};
  const std::vector<Estimate> priors = global_priors();
  for (std::size_t i = 0; i < priors.size(); ++i) {
    unknowns.globals[static_cast<Eigen::Index>(i)] = priors[i].value;
  }
  const HeadingPrior& main = heading_priors_.front();
  const double turned_rad = main.turns_with_velocity ? unknowns.globals[global::kVelocityYaw] : 0.0;
  for (std::size_t k = 0; k < knots(); ++k) {
    const double measured_rad = main_yaw_rad(knot_times_s_[k]);
    unknowns.knots[k].z() = yaw_of_heading(main.deviation, measured_rad - turned_rad) - measured_rad;
  }
  const std::vector<Way> moved = ways(unknowns);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    unknowns.knots[k + 1].head<2>() = unknowns.knots[k].head<2>() + moved[k].moved;
  }
  return unknowns;
}

namespace {

/// Velocity in the world, at a node of an interval.
struct WorldVelocity {
  double yaw_rad, error_rad, next_error_rad, scale;

  WorldVelocity(const Unknowns& unknowns, std::size_t knot)
      : yaw_rad(unknowns.globals[global::kVelocityYaw]),
        error_rad(unknowns.knots[knot].z()),
        next_error_rad(unknowns.knots[knot + 1].z()),
        scale(1.0 + unknowns.globals[global::kVelocityScale]) {}

  template <class Node>
  Eigen::Vector2d at(const Node& node) const {
    const double error = error_rad + node.share * (next_error_rad - error_rad);
    return scale * (rotation2(node.main_yaw_rad + error + yaw_rad) * node.velocity);
  }
};

}  // namespace

std::vector<SlamProblem::Way> SlamProblem::ways(const Unknowns& unknowns) const {
  std::vector<Way> ways(nodes_.size());
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const WorldVelocity velocity(unknowns, k);
    Way& way = ways[k];
    Eigen::Vector2d last = velocity.at(nodes_[k].front());
    for (std::size_t i = 1; i < nodes_[k].size(); ++i) {
      const Node &a = nodes_[k][i - 1], &b = nodes_[k][i];
      const Eigen::Vector2d next = velocity.at(b);
      const double half_s = 0.5 * (b.time_s - a.time_s);
      way.moved += half_s * (last + next);
      way.weighted += half_s * (a.share * last + b.share * next);
      way.measured += half_s * (a.velocity + b.velocity);
      last = next;
    }
    const double from_s = knot_times_s_[k], to_s = knot_times_s_[k + 1];
    way.measured /= to_s - from_s;
    const double density = velocity_.density.at(0.5 * (from_s + to_s));
    const double gap_m = kVelocityInGap_m_s * velocity_.ahead.gap_s(from_s, to_s);
    const double noise_m2 = density * density * (to_s - from_s);
    way.deviation_m = std::sqrt(noise_m2 + gap_m * gap_m);
    way.with_steady_m = std::sqrt(noise_m2 + std::max(gap_m * gap_m, steady_m2_[k]));
  }
  return ways;
}

double SlamProblem::gap_deviation_m(double longer_than_s) const {
  double variance_m2 = 0.0;
  for (const TimeSpan& gap : velocity_.ahead.gaps(knot_times_s_.front(), knot_times_s_.back())) {
    if (gap.to_s - gap.from_s > longer_than_s) variance_m2 += steady_variance_m2(gap);
  }
  return std::sqrt(variance_m2);
}

Eigen::Vector2d SlamProblem::bulge(const Unknowns& unknowns, const Way& way, std::size_t knot, double time_s) const {
  const WorldVelocity velocity(unknowns, knot);
  Eigen::Vector2d moved = Eigen::Vector2d::Zero();
  const std::vector<Node>& nodes = nodes_[knot];
  double share = 1.0;
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const Node &a = nodes[i - 1], &b = nodes[i];
    const Eigen::Vector2d before = velocity.at(a), after = velocity.at(b);
    const double step_s = b.time_s - a.time_s;
    if (time_s >= b.time_s) {
      moved += 0.5 * step_s * (before + after);
      continue;
    }
    const double part = step_s > 0.0 ? (time_s - a.time_s) / step_s : 0.0;
    moved += step_s * part * (before + 0.5 * part * (after - before));
    share = a.share + part * (b.share - a.share);
    break;
  }
  return moved - share * way.moved;
}

SlamProblem::Row SlamProblem::row(std::size_t knot, double residual) const {
  Row row;
  row.knot = knot;
  row.residual = residual;
  row.by_globals = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(globals()));
  return row;
}

SlamProblem::HeadingResidual SlamProblem::heading_residual(const Unknowns& unknowns, std::size_t source,
                                                           std::size_t knot) const {
  const double time_s = knot_times_s_[knot];
  const double yaw_rad = main_yaw_rad(time_s) + unknowns.knots[knot].z();
  const auto first = static_cast<Eigen::Index>(global::heading(source));
  const double s1 = std::sin(yaw_rad), c1 = std::cos(yaw_rad), s2 = std::sin(2.0 * yaw_rad),
               c2 = std::cos(2.0 * yaw_rad);
  const auto& g = unknowns.globals;
  const double deviation = g[first] + g[first + 1] * s1 + g[first + 2] * c1 + g[first + 3] * s2 + g[first + 4] * c2;
  const double slope = g[first + 1] * c1 - g[first + 2] * s1 + 2.0 * g[first + 3] * c2 - 2.0 * g[first + 4] * s2;
  const double with_velocity = heading_priors_[source].turns_with_velocity ? g[global::kVelocityYaw] : 0.0;
  return {wrap_angle(headings_[source].yaw_rad.at(time_s) - yaw_rad - with_velocity - deviation),
          -1.0 - slope,
          {-1.0, -s1, -c1, -s2, -c2}};
}

std::vector<SlamProblem::Row> SlamProblem::rows(const Unknowns& unknowns, const std::vector<Way>& ways) const {
  std::vector<Row> rows;
  // Motion: the deviation is of the way as measured. As corrected, a smaller scale would make noise seem smaller.
  const double scale = 1.0 + unknowns.globals[global::kVelocityScale];
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const Way& way = ways[k];
    const double weight = 1.0 / (scale * way.deviation_m);
    const Eigen::Vector2d off = unknowns.knots[k + 1].head<2>() - unknowns.knots[k].head<2>() - way.moved;
    const Eigen::Vector2d by_angle = quarter_turn(way.moved), by_next = quarter_turn(way.weighted);
    for (int axis = 0; axis < 2; ++axis) {
      Row r = row(k, weight * off[axis]);
      r.by_knot[axis] = -weight;
      r.by_next[axis] = weight;
      r.by_knot[2] = -weight * (by_angle - by_next)[axis];
      r.by_next[2] = -weight * by_next[axis];
      r.by_globals[global::kVelocityYaw] = -weight * by_angle[axis];
      r.by_globals[global::kVelocityScale] = -weight * (way.moved + off)[axis] / scale;
      rows.push_back(std::move(r));
    }
  }
  // Headings, and the changes of the main one.
  for (std::size_t s = 0; s < headings_.size(); ++s) {
    const auto first = static_cast<Eigen::Index>(global::heading(s));
    const std::size_t absolute = !headings_[s].drifts ? knots() : has_prior_ ? 0 : 1;
    for (std::size_t k = 0; k < absolute; ++k) {
      const double time_s = knot_times_s_[k];
      if (headings_[s].yaw_rad.gap_s(time_s, std::nextafter(time_s, time_s + 1.0)) > 0.0) continue;
      const HeadingResidual heading = heading_residual(unknowns, s, k);
      const bool is_last = k + 1 == knots();
      Row r = row(is_last ? k - 1 : k, heading.residual_rad / kHeading_rad);
      (is_last ? r.by_next : r.by_knot)[2] = heading.by_error / kHeading_rad;
      for (std::size_t i = 0; i < global::kOfHeading; ++i) {
        r.by_globals[first + static_cast<Eigen::Index>(i)] = heading.by_source[i] / kHeading_rad;
      }
      if (heading_priors_[s].turns_with_velocity) r.by_globals[global::kVelocityYaw] = -1.0 / kHeading_rad;
      rows.push_back(std::move(r));
    }
  }
  const auto first = static_cast<Eigen::Index>(global::heading(0));
  for (std::size_t k = 0; k + 1 < knots(); ++k) {
    const double from_s = knot_times_s_[k], to_s = knot_times_s_[k + 1];
    const double gap_s = headings_.front().yaw_rad.gap_s(from_s, to_s);
    const double weight =
        1.0 / std::sqrt(kTurnIn1s_rad * kTurnIn1s_rad * (to_s - from_s) + kTurnInGap_rad * kTurnInGap_rad * gap_s);
    const HeadingResidual a = heading_residual(unknowns, 0, k), b = heading_residual(unknowns, 0, k + 1);
    Row r = row(k, weight * wrap_angle(b.residual_rad - a.residual_rad));
    r.by_knot[2] = -weight * a.by_error;
    r.by_next[2] = weight * b.by_error;
    for (std::size_t i = 0; i < global::kOfHeading; ++i) {
      r.by_globals[first + static_cast<Eigen::Index>(i)] = weight * (b.by_source[i] - a.by_source[i]);
    }
    rows.push_back(std::move(r));
  }
  if (has_prior_) return rows;
  // The priors.
  for (int axis = 0; axis < 2; ++axis) {
    Row r = row(0, unknowns.knots.front()[axis] / kFirstPosition_m);
    r.by_knot[axis] = 1.0 / kFirstPosition_m;
    rows.push_back(std::move(r));
  }
  const std::vector<Estimate> priors = global_priors();
  for (std::size_t g = 0; g < priors.size(); ++g) {
    const auto i = static_cast<Eigen::Index>(g);
    Row r = row(0, (unknowns.globals[i] - priors[g].value) / priors[g].deviation);
    r.by_globals[i] = 1.0 / priors[g].deviation;
    rows.push_back(std::move(r));
  }
  return rows;
}

}  // namespace pingvox
