#include "pingvox/sim/vehicle.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "base/option_errors.hpp"
#include "pingvox/geometry/random.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;

/// A route's curve as closely spaced points with their distance from the start.
struct Curve {
  std::vector<Vector3d> points_m;
  std::vector<double> lengths_m;
};

/// The curve's point at a length of it within its own, and the direction there.
struct Place {
  Vector3d point_m;
  double yaw_rad;
};
Place place_at(const Curve& curve, double along_m) {
  const auto behind = std::upper_bound(curve.lengths_m.begin() + 1, curve.lengths_m.end() - 1, along_m);
  const auto i = static_cast<std::size_t>(std::distance(curve.lengths_m.begin(), behind));
  const Vector3d step = curve.points_m[i] - curve.points_m[i - 1];
  const double share = (along_m - curve.lengths_m[i - 1]) / step.norm();
  return {curve.points_m[i - 1] + share * step, std::atan2(step.y(), step.x())};
}

/// Through all waypoints, as a centripetal Catmull-Rom curve (Yuksel, Schaefer, Keyser 2011): no loops, and close to
/// the straight line where legs of different lengths meet.
Curve curve_of(const Route& route) {
  constexpr int kPerLeg = 32;
  const auto& w = route.waypoints_m;
  const bool is_round = route.end == Route::End::kStarts;
  const auto count = static_cast<std::ptrdiff_t>(w.size());
  const auto waypoint = [&](std::ptrdiff_t i) -> Vector3d {
    if (is_round) return w[static_cast<std::size_t>((i + count) % count)];
    // The curve is extrapolated straight before the first and after the last waypoint.
    if (i < 0) return 2.0 * w[0] - w[1];
    if (i >= count) return 2.0 * w[w.size() - 1] - w[w.size() - 2];
    return w[static_cast<std::size_t>(i)];
  };
  Curve curve{{w.front()}, {0.0}};
  for (std::ptrdiff_t leg = 0; leg < (is_round ? count : count - 1); ++leg) {
    const std::array<Vector3d, 4> p = {waypoint(leg - 1), waypoint(leg), waypoint(leg + 1), waypoint(leg + 2)};
    std::array<double, 4> knot{};
    for (std::size_t i = 1; i < 4; ++i) knot[i] = knot[i - 1] + std::sqrt((p[i] - p[i - 1]).norm());
    for (int step = 1; step <= kPerLeg; ++step) {
      const double t = knot[1] + (knot[2] - knot[1]) * step / kPerLeg;
      // Barry and Goldman 1988: repeated linear interpolation.
      std::array<Vector3d, 4> q = p;
      for (std::size_t level = 1; level < 4; ++level) {
        for (std::size_t i = 0; i + level < 4; ++i) {
          // The last level spans the leg itself.
          const double from = level == 3 ? knot[1] : knot[i];
          const double to = level == 3 ? knot[2] : knot[i + level];
          q[i] = ((to - t) * q[i] + (t - from) * q[i + 1]) / (to - from);
        }
      }
      curve.lengths_m.push_back(curve.lengths_m.back() + (q[0] - curve.points_m.back()).norm());
      curve.points_m.push_back(q[0]);
    }
  }
  return curve;
}

/// A smooth random number about 0: white noise through two low passes.
class Sway {
 public:
  Sway(double deviation, double slowness_s, std::uint64_t seed)
      : deviation_(deviation), slowness_s_(slowness_s), random_(seed) {}

  double after(double step_s) {
    const double share = std::min(step_s / slowness_s_, 1.0);
    // Two low passes in a row leave a quarter of the noise's variance, times the share.
    const double noise = 2.0 * deviation_ / std::sqrt(share) * std::clamp(random_.normal(), -3.0, 3.0);
    first_ += share * (noise - first_);
    value_ += share * (first_ - value_);
    return std::clamp(value_, -3.0 * deviation_, 3.0 * deviation_);
  }

 private:
  double deviation_, slowness_s_;
  Random random_;
  double first_ = 0.0, value_ = 0.0;
};

/// Command of a driver for some seconds: a fraction of the usual speed (0 to hover), and a heading relative to the
/// path.
struct Wish {
  double until_s = 0.0;
  double share = 1.0;
  double turn_rad = 0.0;
};

Wish next_wish(const Wish& before, double time_s, Random& random) {
  constexpr double kStops = 0.15;
  const auto within = [&random](double low, double high) { return low + (high - low) * random.uniform(); };
  if (before.share > 0.0 && random.uniform() < kStops) {
    const double seconds = within(5.0, 25.0);
    const double angle = within(0.5, 2.0) * (random.uniform() < 0.5 ? -1.0 : 1.0);
    return {time_s + seconds, 0.0, random.uniform() < 0.5 ? angle : 0.0};
  }
  const double seconds = within(5.0, 20.0);
  return {time_s + seconds, within(0.5, 1.5), 0.0};
}

Eigen::Matrix3d rotate(double yaw_rad) {
  return Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace

OptionErrors TravelOptions::errors() const {
  using enum Limits::Ends;
  OptionErrors errors;
  errors.require("speed_m_s", speed_m_s, {0.0, 100.0, kLowOut});
  errors.require("pose_every_s", pose_every_s, {0.0, 3600.0, kLowOut});
  return errors;
}

Result<void> TravelOptions::validate() const {
  return errors().result("vehicle");
}

double length_m(const Route& route) {
  return curve_of(route).lengths_m.back();
}

Trajectory follow_route(const Route& route, double duration_s, const TravelOptions& options) {
  assert(options.validate() && route.waypoints_m.size() >= 2);
  const Curve curve = curve_of(route);
  const double whole = curve.lengths_m.back();
  std::vector<StampedPose> poses;
  for (std::size_t n = 0; poses.empty() || poses.back().time_s < duration_s; ++n) {
    const double time = static_cast<double>(n) * options.pose_every_s;
    const double gone = time * options.speed_m_s;
    const double along = route.end == Route::End::kStarts ? std::fmod(gone, whole) : std::min(gone, whole);
    const Place place = place_at(curve, along);
    StampedPose pose{.time_s = time, .map_from_body = Pose::Identity()};
    pose.map_from_body.translation() = place.point_m;
    pose.map_from_body.linear() = rotate(place.yaw_rad);
    poses.push_back(pose);
  }
  auto trajectory = Trajectory::make(std::move(poses));
  assert(trajectory);
  return *std::move(trajectory);
}

Trajectory drive_by_hand(const Route& route, const TravelOptions& options, std::uint64_t seed) {
  assert(options.validate() && route.waypoints_m.size() >= 2);
  constexpr double kSpeedLag_s = 1.5, kTurnLag_s = 0.8;
  constexpr double kTurn_rad_s = 0.8;  ///< no faster
  constexpr double kSway_m = 0.1, kHeave_m = 0.05, kYaw_rad = 0.06, kTilt_rad = 0.015;
  const Curve curve = curve_of(route);
  const double whole = curve.lengths_m.back();
  const double step_s = options.pose_every_s;
  Random random(seed ^ 0x68616e64U);
  Sway ahead(kSway_m, 4.0, random.bits()), left(kSway_m, 4.0, random.bits()), up(kHeave_m, 4.0, random.bits());
  Sway yaw(kYaw_rad, 3.0, random.bits()), roll(kTilt_rad, 1.0, random.bits()), pitch(kTilt_rad, 1.0, random.bits());

  std::vector<StampedPose> poses;
  Wish wish;
  double along = 0.0;
  double speed = 0.0;
  double heading = place_at(curve, 0.0).yaw_rad;
  for (std::size_t n = 0; along < whole; ++n) {
    const double time = static_cast<double>(n) * step_s;
    if (time >= wish.until_s) wish = next_wish(wish, time, random);
    speed += std::min(step_s / kSpeedLag_s, 1.0) * (wish.share * options.speed_m_s - speed);
    along += speed * step_s;
    const Place place = place_at(curve, std::min(along, whole));
    const double wanted = std::remainder(place.yaw_rad + wish.turn_rad - heading, 2.0 * std::numbers::pi);
    const double limit = kTurn_rad_s * step_s;
    heading += std::clamp(std::min(step_s / kTurnLag_s, 1.0) * wanted, -limit, limit);

    StampedPose pose{.time_s = time, .map_from_body = Pose::Identity()};
    pose.map_from_body.linear() = (Eigen::AngleAxisd(heading + yaw.after(step_s), Vector3d::UnitZ()) *
                                   Eigen::AngleAxisd(pitch.after(step_s), Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(roll.after(step_s), Vector3d::UnitX()))
                                      .toRotationMatrix();
    // In separate statements, as the order of evaluation of arguments is unspecified.
    const double x = ahead.after(step_s);
    const double y = left.after(step_s);
    const double z = up.after(step_s);
    pose.map_from_body.translation() = place.point_m + Vector3d(x, y, z);
    poses.push_back(pose);
  }
  auto trajectory = Trajectory::make(std::move(poses));
  assert(trajectory);
  return *std::move(trajectory);
}

OptionErrors DriftOptions::errors() const {
  OptionErrors errors;
  errors.require("position_m", position_m, {0.0, 1000.0});
  errors.require("heading_rad", heading_rad, {0.0, 10.0});
  return errors;
}

Result<void> DriftOptions::validate() const {
  return errors().result("drift");
}

Trajectory add_drift(const Trajectory& truth, const DriftOptions& options) {
  assert(options.validate());
  const std::vector<StampedPose>& all = truth.poses();
  if (all.size() < 2) return truth;
  Random random(options.seed);
  std::vector<StampedPose> poses;
  double heading_error = 0.0;
  Vector3d position = all.front().map_from_body.translation();
  for (std::size_t n = 0; n < all.size(); ++n) {
    const Pose& now = all[n].map_from_body;
    if (n > 0) {
      const double share = std::sqrt((all[n].time_s - all[n - 1].time_s) / 60.0);
      const Vector3d step = now.translation() - all[n - 1].map_from_body.translation();
      position += rotate(heading_error) * step;
      // In separate statements, as the order of evaluation of arguments is unspecified.
      const double x = random.normal();
      const double y = random.normal();
      position += share * options.position_m * Vector3d(x, y, 0.0);
      heading_error += share * options.heading_rad * random.normal();
    }
    StampedPose pose{.time_s = all[n].time_s, .map_from_body = Pose::Identity()};
    pose.map_from_body.translation() = Vector3d(position.x(), position.y(), now.translation().z());
    pose.map_from_body.linear() = rotate(heading_error) * now.linear();
    poses.push_back(pose);
  }
  auto trajectory = Trajectory::make(std::move(poses));
  assert(trajectory);
  return *std::move(trajectory);
}

}  // namespace pingvox
