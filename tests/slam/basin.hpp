#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "pingvox/nav/nav_log.hpp"
#include "pingvox/sonar/beam.hpp"
#include "tests/slam/walls.hpp"
#include "tests/support/uniform.hpp"

/// A basin with a pier, walls drawn as lines, and a vehicle that goes round it with wrong compass and turned DVL.
namespace pingvox::test {

struct Basin {
  static constexpr double kLap_s = 400.0;
  double duration_s = 800.0;
  double compass_cos = 0.06;         ///< deviation of the compass [rad]
  double velocity_yaw_rad = 0.05;    ///< by which the DVL is turned against the vehicle
  double velocity_noise_m_s = 0.05;  ///< of each ping
  double sonar_yaw_rad = 0.7;        ///< mount

  struct State {
    Eigen::Vector2d place;
    double yaw_rad;
  };
  /// A figure of eight, twice. On a circle a turned DVL looks like a sonar that is mounted farther ahead.
  static State at(double time_s) {
    const double phase = 2.0 * std::numbers::pi * time_s / kLap_s;
    const Eigen::Vector2d along(-20.0 * std::sin(phase), 20.0 * std::cos(2.0 * phase));
    return {{20.0 * std::cos(phase), 10.0 * std::sin(2.0 * phase)}, std::atan2(along.y(), along.x())};
  }
  static Eigen::Vector2d velocity_at(double time_s) {
    constexpr double kStep_s = 1e-3;
    return (at(time_s + kStep_s).place - at(time_s - kStep_s).place) / (2.0 * kStep_s);
  }

  static double range_m(const Eigen::Vector2d& from, double yaw_rad) {
    constexpr std::array<Wall, 9> kWalls = {{{-32, -22, 34, -24},
                                             {34, -24, 31, 20},
                                             {31, 20, 5, 24},
                                             {5, 24, 4, 30},
                                             {4, 30, -30, 26},
                                             {-30, 26, -32, -22},
                                             {-6, 14, 5, 15},
                                             {5, 15, 4, 13},
                                             {4, 13, -6, 14}}};
    return range_to_walls_m(kWalls, from, yaw_rad);
  }

  /// 100 beams a turn, a turn in ten seconds: each wall as seven bins around it.
  std::vector<Beam> beams() const {
    std::vector<Beam> beams;
    for (int i = 0; 0.1 * i < duration_s; ++i) {
      Beam beam{0.1 * i, wrap_bearing(2.0 * std::numbers::pi * i / 100.0), 0.1, std::vector<std::uint8_t>(500, 0)};
      const State state = at(beam.time_s);
      const double range = range_m(state.place, state.yaw_rad + sonar_yaw_rad + beam.bearing_rad);
      const auto bin = static_cast<int>(range / 0.1);
      for (int b = std::max(0, bin - 3); b <= bin + 3 && b < 500; ++b) {
        beam.intensities[static_cast<std::size_t>(b)] = 255;
      }
      beams.push_back(std::move(beam));
    }
    return beams;
  }

  std::vector<NavSource> sources(std::uint64_t seed = 1) const {
    std::mt19937_64 random(seed);
    const double edge = velocity_noise_m_s * std::sqrt(3.0);
    NavSource velocity{"dvl", NavQuantity::kVelocity, {}}, compass{"compass", NavQuantity::kHeading, {}},
        depth{"bar", NavQuantity::kDepth, {}};
    for (int i = 0; 0.5 * i <= duration_s; ++i) {
      NavSample sample;
      sample.time_s = 0.5 * i;
      const State state = at(sample.time_s);
      const double yaw_rad = state.yaw_rad + velocity_yaw_rad, c = std::cos(yaw_rad), s = std::sin(yaw_rad);
      const Eigen::Vector2d v = velocity_at(sample.time_s);
      sample.value = {c * v.x() + s * v.y() + uniform(random, -edge, edge),
                      -s * v.x() + c * v.y() + uniform(random, -edge, edge), 0.0};
      velocity.samples.push_back(sample);
      sample.value = {2.0, 0.0, 0.0};
      depth.samples.push_back(sample);
    }
    for (int i = 0; 0.2 * i <= duration_s; ++i) {
      NavSample sample;
      sample.time_s = 0.2 * i;
      const double yaw_rad = at(sample.time_s).yaw_rad;
      sample.value.x() = yaw_rad + compass_cos * std::cos(yaw_rad);
      compass.samples.push_back(sample);
    }
    return {velocity, compass, depth};
  }
};

}  // namespace pingvox::test
