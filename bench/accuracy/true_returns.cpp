#include "accuracy/true_returns.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pingvox::bench {
namespace {

using Eigen::Vector3d;

// Rays to either side of the axis.
constexpr int kAcross = 3, kUp = 35;

Vector3d direction_of(double bearing_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(bearing_rad), std::cos(elevation_rad) * std::sin(bearing_rad),
          std::sin(elevation_rad)};
}

/// Half angles of an elliptic cone.
struct HalfAngles {
  double width_rad, height_rad;
};

/// First zero of sin(u) / u that has half power (0.707) at half the width.
double null_rad(double half_width_rad) {
  return std::asin(std::min(1.0, std::numbers::pi / 1.391557 * std::sin(half_width_rad)));
}

/// Calls f(range, half the way by which the range changes to the next ray) for each ray of a cone that
/// meets something.
template <class F>
void for_each_return(const World& world, const SonarSimulator::Ping& ping, const HalfAngles& half, double range_m,
                     F&& f) {
  const auto& map_from_sensor = ping.map_from_sensor;
  const double across_step = half.width_rad / kAcross, up_step = half.height_rad / kUp;
  for (int up = -kUp; up <= kUp; ++up) {
    for (int across = -kAcross; across <= kAcross; ++across) {
      if (std::hypot(static_cast<double>(up) / kUp, static_cast<double>(across) / kAcross) > 1.0) continue;
      const double bearing = ping.bearing_rad + across * across_step, elevation = up * up_step;
      const SoundRay ray{map_from_sensor.translation(), map_from_sensor.linear() * direction_of(bearing, elevation)};
      const auto hit = world.first(ray, range_m);
      if (!hit) continue;
      // The surface extends at least half way to the next ray; its range changes if it is slanted.
      const Vector3d sideways = map_from_sensor.linear() * direction_of(bearing + 0.5 * std::numbers::pi, 0.0) *
                                (across_step * std::cos(elevation));
      const Vector3d upwards =
          map_from_sensor.linear() * direction_of(bearing, elevation + 0.5 * std::numbers::pi) * up_step;
      const double slant = hit->range_m / std::max(-hit->normal.dot(ray.direction), 0.01);
      const double change = std::max(std::abs(hit->normal.dot(sideways)), std::abs(hit->normal.dot(upwards)));
      f(hit->range_m, 0.5 * slant * change);
    }
  }
}

TrueReturns returns_of(const World& world, const SonarSimulator::Ping& ping, const SonarOptions& sonar) {
  TrueReturns truth;
  const Vector3d axis = ping.map_from_sensor.linear() * direction_of(ping.bearing_rad, 0.0);
  const auto on_axis = world.first({ping.map_from_sensor.translation(), axis}, sonar.range_m());
  if (on_axis) truth.axis_m = on_axis->range_m;
  const HalfAngles cone{0.5 * sonar.beam_width_rad, 0.5 * sonar.beam_height_rad};
  for_each_return(world, ping, cone, sonar.range_m(), [&](double range_m, double half_m) {
    truth.returns.push_back({range_m - half_m, range_m + half_m});
  });
  const HalfAngles lobe{null_rad(cone.width_rad), null_rad(cone.height_rad)};
  for_each_return(world, ping, lobe, sonar.range_m(),
                  [&](double range_m, double half_m) { truth.lobe.push_back({range_m - half_m, range_m + half_m}); });
  truth.returns = join(std::move(truth.returns));
  truth.lobe = join(std::move(truth.lobe));
  return truth;
}

}  // namespace

std::optional<double> distance_m(double range_m, const std::vector<Span>& spans) {
  std::optional<double> nearest;
  for (const Span& span : spans) {
    const double off = std::max({0.0, span.first_m - range_m, range_m - span.last_m});
    if (!nearest || off < *nearest) nearest = off;
  }
  return nearest;
}

std::vector<Span> join(std::vector<Span> spans) {
  std::ranges::sort(spans, {}, &Span::first_m);
  std::vector<Span> apart;
  for (const Span& span : spans) {
    if (!apart.empty() && span.first_m <= apart.back().last_m) {
      apart.back().last_m = std::max(apart.back().last_m, span.last_m);
    } else {
      apart.push_back(span);
    }
  }
  return apart;
}

std::vector<TrueReturns> true_returns(const Recording& recording) {
  std::vector<TrueReturns> truths;
  truths.reserve(recording.pings.size());
  const bool stands_still = recording.options.motion == Motion::kStill;
  for (std::size_t n = 0; n < recording.pings.size(); ++n) {
    // A still head sees the same in each turn.
    if (stands_still && n >= recording.sonar.beams_per_turn &&
        recording.pings[n - recording.sonar.beams_per_turn].bearing_rad == recording.pings[n].bearing_rad) {
      truths.push_back(truths[n - recording.sonar.beams_per_turn]);
    } else {
      truths.push_back(returns_of(recording.scene.world, recording.pings[n], recording.sonar));
    }
  }
  return truths;
}

}  // namespace pingvox::bench
