#include "slam/smoother/steady_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pingvox/geometry/pose2.hpp"

namespace pingvox {
namespace {

constexpr double kMinChange = 5e-4, kMaxChange = 1.0, kFactor = 1.5;
constexpr double kFirst_m_s = 1.0;      ///< deviation of the first velocity
constexpr double kRounding_m_s = 1e-4;  ///< of a difference, for equations that can be solved
/// A change that was measured counts a quarter, and a greater one less, from so many standard deviations on.
constexpr double kSteady = 1.5;

/// Log-likelihood of measured velocities, by a Kalman filter of a random walk.
double log_likelihood(const TimeSeries& measured, const TimeSeries& density, double change) {
  const std::vector<double>& times_s = measured.times_s();
  const double usual_s = (measured.to_s() - measured.from_s()) / static_cast<double>(measured.size() - 1);
  double velocity = measured.values().front(), variance = kFirst_m_s * kFirst_m_s, log = 0.0;
  for (std::size_t i = 1; i < measured.size(); ++i) {
    variance += change * change * (times_s[i] - times_s[i - 1]);
    const double noise = density.values()[i] * density.values()[i] / usual_s;
    const double off = measured.values()[i] - velocity;
    log -= 0.5 * (std::log(variance + noise) + off * off / (variance + noise));
    const double gain = variance / (variance + noise);
    velocity += gain * off;
    variance *= 1.0 - gain;
  }
  return log;
}

}  // namespace

double velocity_change(const VelocitySource& velocity) {
  double best = kMaxChange, best_log = -std::numeric_limits<double>::infinity();
  for (double change = kMinChange; change <= kMaxChange; change *= kFactor) {
    const double log = log_likelihood(velocity.ahead, velocity.density, change) +
                       log_likelihood(velocity.left, velocity.density, change);
    if (log <= best_log) continue;
    best = change;
    best_log = log;
  }
  return best;
}

void add_steady_motion(const SlamProblem& problem, const Unknowns& unknowns, const std::vector<SlamProblem::Way>& ways,
                       double change, NormalEquations& equations) {
  const std::vector<double>& times_s = problem.knot_times_s();
  const auto globals = static_cast<Eigen::Index>(problem.globals());
  for (std::size_t k = 0; k + 2 < problem.knots(); ++k) {
    const auto first = static_cast<Eigen::Index>(3 * k);
    Eigen::Vector2d off = ways[k + 1].measured - ways[k].measured;
    Eigen::Matrix<double, 2, 9> by_knots = Eigen::Matrix<double, 2, 9>::Zero();
    Eigen::Matrix2Xd by_globals = Eigen::Matrix2Xd::Zero(2, globals);
    for (std::size_t i = 0; i < 2; ++i) {
      const std::size_t from = k + i, to = from + 1;
      const SlamProblem::Way& way = ways[from];
      const double yaw_rad = problem.main_yaw_rad(0.5 * (times_s[from] + times_s[to])) + unknowns.at(from, 0.5).z() +
                             unknowns.globals[global::kVelocityYaw];
      const double scale = 1.0 + unknowns.globals[global::kVelocityScale];
      const Eigen::Matrix2d source_from_map =
          (i == 0 ? -1.0 : 1.0) / (scale * (times_s[to] - times_s[from])) * rotation2(-yaw_rad);
      const Eigen::Vector2d missed = (unknowns.knots[to] - unknowns.knots[from]).head<2>() - way.moved;
      off += source_from_map * missed;
      const Eigen::Vector2d by_angle = quarter_turn(way.moved), by_next = quarter_turn(way.weighted),
                            by_frame = quarter_turn(missed);
      const auto at = static_cast<Eigen::Index>(3 * i);
      by_knots.block<2, 2>(0, at) -= source_from_map;
      by_knots.block<2, 2>(0, at + 3) += source_from_map;
      by_knots.col(at + 2) -= source_from_map * (by_angle - by_next + 0.5 * by_frame);
      by_knots.col(at + 5) -= source_from_map * (by_next + 0.5 * by_frame);
      by_globals.col(global::kVelocityYaw) -= source_from_map * (by_angle + by_frame);
      by_globals.col(global::kVelocityScale) -= source_from_map * (way.moved + missed) / scale;
    }
    // Between the means over two intervals that follow each other lie two thirds of their length.
    const double between_s = 0.5 * (times_s[k + 2] - times_s[k]) * 2.0 / 3.0;
    const double variance = change * change * between_s + kRounding_m_s * kRounding_m_s;
    // A vehicle that starts or stops does so at once. Told by what was measured alone, so that each step minimises the
    // same sum.
    const double density = problem.velocity().density.at(times_s[k + 1]);
    const double noise =
        density * density * (1.0 / (times_s[k + 1] - times_s[k]) + 1.0 / (times_s[k + 2] - times_s[k + 1]));
    const double square = 0.5 * (ways[k + 1].measured - ways[k].measured).squaredNorm() / (variance + noise);
    const double share = kSteady * kSteady / (kSteady * kSteady + square);
    const double weight = share * share / variance;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        equations.add_block(k + a, k + b,
                            weight * by_knots.middleCols<3>(static_cast<Eigen::Index>(3 * a)).transpose() *
                                by_knots.middleCols<3>(static_cast<Eigen::Index>(3 * b)));
      }
    }
    equations.border.middleRows<9>(first) += weight * by_knots.transpose() * by_globals;
    equations.corner += weight * by_globals.transpose() * by_globals;
    equations.gradient.segment<9>(first) += weight * by_knots.transpose() * off;
    equations.gradient.tail(globals) += weight * by_globals.transpose() * off;
  }
}

}  // namespace pingvox
