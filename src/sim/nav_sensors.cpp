#include "pingvox/sim/nav_sensors.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/option_errors.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/random.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;

constexpr double kOutlier_m_s = 1.0;
constexpr double kLost_s = 5.0;
constexpr double kWalk_s = 600.0;  ///< after which the bias of a gyro has changed by its deviation
/// Between the two poses that a velocity is the difference of.
constexpr double kStep_s = 0.1;

/// To a multiple of 1 / `steps`: what a device resolves. The last bit of cos(), which differs between machines, does
/// not change it.
double round_to(double value, double steps) {
  return std::round(value * steps) / steps;
}

Vector3d round_to(const Vector3d& value, double steps) {
  return value.unaryExpr([steps](double number) { return round_to(number, steps); });
}

constexpr double kTimeSteps = 1e4, kVelocitySteps = 1e3, kAngleSteps = 1e5, kDepthSteps = 1e3;

Vector3d normal(Random& random, double deviation) {
  // In separate statements, as the order of evaluation of arguments is unspecified.
  const double x = deviation * random.normal();
  const double y = deviation * random.normal();
  const double z = deviation * random.normal();
  return {x, y, z};
}

/// Pose and speeds at one time, in the body frame.
struct Moving {
  Pose map_from_body;
  Vector3d velocity_m_s, turn_rate_rad_s;
};

/// nullopt: outside of the trajectory.
std::optional<Moving> moving_at(const Trajectory& trajectory, double time_s) {
  const std::optional<Pose> now = trajectory.at(time_s);
  if (!now) return std::nullopt;
  // At the ends and beside a gap, on one side only.
  std::optional<Pose> before = trajectory.at(time_s - 0.5 * kStep_s);
  std::optional<Pose> after = trajectory.at(time_s + 0.5 * kStep_s);
  const double step_s = before && after ? kStep_s : 0.5 * kStep_s;
  if (!before && !after) return Moving{*now, Vector3d::Zero(), Vector3d::Zero()};
  if (!before) before = now;
  if (!after) after = now;
  const Vector3d way = now->linear().transpose() * (after->translation() - before->translation());
  const Eigen::AngleAxisd turn(before->linear().transpose() * after->linear());
  return Moving{*now, way / step_s, turn.angle() * turn.axis() / step_s};
}

/// Calls `measure(time, what moves)` at a steady rate.
template <class Measure>
void sample(const Trajectory& trajectory, double from_s, double to_s, double per_s, const Measure& measure) {
  for (std::size_t n = 0;; ++n) {
    const double time_s = from_s + static_cast<double>(n) / per_s;
    if (time_s > to_s) return;
    if (const auto moving = moving_at(trajectory, time_s)) measure(time_s, *moving);
  }
}

NavSample sample_at(double time_s, const Vector3d& value, const Vector3d& deviation) {
  return {.time_s = round_to(time_s, kTimeSteps), .value = value, .deviation = deviation};
}

NavSource simulate_dvl(const Trajectory& trajectory, double from_s, double to_s, const NavSensorOptions& o,
                       const NavSensorErrors& errors, Random random) {
  NavSource dvl{"DVL", NavQuantity::kVelocity, {}};
  const Eigen::Matrix3d dvl_from_body = Eigen::AngleAxisd(-errors.dvl_yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
  const double pings_lost = std::max(1.0, kLost_s * o.dvl_per_s);
  bool is_lost = false;
  sample(trajectory, from_s, to_s, o.dvl_per_s, [&](double time_s, const Moving& moving) {
    const double chance = random.uniform() * pings_lost;
    is_lost = is_lost ? chance >= 1.0 : chance * (1.0 - o.dvl_lost) < o.dvl_lost;
    const bool is_outlier = random.uniform() < o.dvl_outliers;
    Vector3d velocity = dvl_from_body * moving.velocity_m_s / (1.0 + errors.dvl_scale);
    velocity += normal(random, o.dvl_noise_m_s);
    const Vector3d wrong = normal(random, kOutlier_m_s);
    if (is_outlier) velocity += wrong;
    if (is_lost) velocity.setZero();
    dvl.samples.push_back(
        sample_at(time_s + o.delay_s, round_to(velocity, kVelocitySteps), Vector3d::Constant(o.dvl_noise_m_s)));
    dvl.samples.back().valid = !is_lost;
  });
  return dvl;
}

NavSource simulate_attitude(const Trajectory& trajectory, double from_s, double to_s, const NavSensorOptions& o,
                            const NavSensorErrors& e, Random random) {
  NavSource attitude{"IMU", NavQuantity::kAttitude, {}};
  const Vector3d deviation(o.attitude_noise_rad, o.attitude_noise_rad, std::numeric_limits<double>::quiet_NaN());
  sample(trajectory, from_s, to_s, o.attitude_per_s, [&](double time_s, const Moving& moving) {
    Vector3d rpy = rpy_of(moving.map_from_body.linear());
    const double yaw = rpy.z();
    const double compass = e.constant_rad + e.sin1_rad * std::sin(yaw) + e.cos1_rad * std::cos(yaw) +
                           e.sin2_rad * std::sin(2.0 * yaw) + e.cos2_rad * std::cos(2.0 * yaw);
    rpy.z() += compass;
    rpy += normal(random, o.attitude_noise_rad);
    rpy.z() = std::remainder(rpy.z(), 2.0 * std::numbers::pi);
    attitude.samples.push_back(sample_at(time_s + o.delay_s, round_to(rpy, kAngleSteps), deviation));
  });
  return attitude;
}

NavSource simulate_gyros(const Trajectory& trajectory, double from_s, double to_s, const NavSensorOptions& o,
                         NavSensorErrors& errors, Random random) {
  NavSource gyros{"IMU", NavQuantity::kTurnRate, {}};
  Vector3d bias = normal(random, o.gyro_drift_rad_s);
  errors.gyro_bias_start_rad_s = bias.z();
  const double walk = o.gyro_drift_rad_s * std::sqrt(1.0 / (o.attitude_per_s * kWalk_s));
  sample(trajectory, from_s, to_s, o.attitude_per_s, [&](double time_s, const Moving& moving) {
    errors.gyro_bias_end_rad_s = bias.z();
    const Vector3d noise = normal(random, o.gyro_noise_rad_s);
    gyros.samples.push_back(sample_at(time_s + o.delay_s,
                                      round_to(Vector3d(moving.turn_rate_rad_s + bias + noise), kAngleSteps),
                                      Vector3d::Constant(o.gyro_noise_rad_s)));
    bias += normal(random, walk);
  });
  return gyros;
}

NavSource simulate_depth(const Trajectory& trajectory, double from_s, double to_s, const NavSensorOptions& o,
                         Random random) {
  NavSource depth{"depth", NavQuantity::kDepth, {}};
  sample(trajectory, from_s, to_s, o.depth_per_s, [&](double time_s, const Moving& moving) {
    const double depth_m = -moving.map_from_body.translation().z() + o.depth_noise_m * random.normal();
    depth.samples.push_back(sample_at(
        time_s + o.delay_s, {round_to(depth_m, kDepthSteps), 0.0, 0.0},
        {o.depth_noise_m, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()}));
  });
  return depth;
}

}  // namespace

OptionErrors NavSensorOptions::errors() const {
  using enum Limits::Ends;
  OptionErrors errors;
  constexpr Limits kRates{0.0, 100.0, kLowOut};
  errors.require("dvl_per_s", dvl_per_s, kRates);
  errors.require("dvl_noise_m_s", dvl_noise_m_s, {0.0, 10.0});
  errors.require("dvl_outliers", dvl_outliers, {0.0, 1.0});
  errors.require("dvl_lost", dvl_lost, {0.0, 1.0, kHighOut});
  errors.require("dvl_yaw_rad", dvl_yaw_rad, {0.0, 1.0});
  errors.require("dvl_scale", dvl_scale, {0.0, 0.1});
  errors.require("attitude_per_s", attitude_per_s, kRates);
  errors.require("attitude_noise_rad", attitude_noise_rad, {0.0, 1.0});
  errors.require("compass_deviation_rad", compass_deviation_rad, {0.0, 0.3});
  errors.require("gyro_noise_rad_s", gyro_noise_rad_s, {0.0, 1.0});
  errors.require("gyro_drift_rad_s", gyro_drift_rad_s, {0.0, 1.0});
  errors.require("depth_per_s", depth_per_s, kRates);
  errors.require("depth_noise_m", depth_noise_m, {0.0, 10.0});
  errors.require("delay_s", delay_s, {-3600.0, 3600.0});
  return errors;
}

Result<void> NavSensorOptions::validate() const {
  return errors().result("navigation");
}

SimulatedNav simulate_nav(const Trajectory& map_from_body, double from_s, double to_s,
                          const NavSensorOptions& options) {
  assert(options.validate() && from_s <= to_s && to_s - from_s <= 100'000.0);
  // A seed of its own for each sensor, so that the options of one do not change the noise of another.
  Random seeds(options.seed ^ 0x6e61760000000000U);
  Random constants(seeds.bits());
  const Random dvl(seeds.bits()), attitude(seeds.bits()), gyros(seeds.bits()), depth(seeds.bits());

  NavSensorErrors errors;
  errors.dvl_yaw_rad = options.dvl_yaw_rad * constants.normal();
  // No more than three deviations: a scale stays above 0.
  errors.dvl_scale = options.dvl_scale * std::clamp(constants.normal(), -3.0, 3.0);
  const double least = options.compass_deviation_rad / 3.0;
  errors.sin1_rad = options.compass_deviation_rad * constants.normal();
  errors.cos1_rad = options.compass_deviation_rad * constants.normal();
  errors.sin2_rad = least * constants.normal();
  errors.cos2_rad = least * constants.normal();
  errors.constant_rad = least * constants.normal();

  std::vector<NavSource> sources;
  sources.push_back(simulate_dvl(map_from_body, from_s, to_s, options, errors, dvl));
  sources.push_back(simulate_attitude(map_from_body, from_s, to_s, options, errors, attitude));
  sources.push_back(simulate_gyros(map_from_body, from_s, to_s, options, errors, gyros));
  sources.push_back(simulate_depth(map_from_body, from_s, to_s, options, depth));
  auto log = NavLog::make(std::move(sources), NavClock::kUnknown);
  assert(log);
  return {*std::move(log), errors};
}

}  // namespace pingvox
