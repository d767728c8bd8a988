#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/sonar/beam.hpp"

/// A room of 6 m by 4 m with its middle at the origin, and a square block in one corner of it or none, as a map and as
/// a sonar hears it.
namespace pingvox::test {

struct Room {
  static constexpr double kHalfX_m = 3.0, kHalfY_m = 2.0, kBlock_m = 1.0;
  bool has_block = true;

  struct State {
    double x = 0.0, y = 0.0, yaw = 0.0;
  };

  bool is_wall(double x, double y) const {
    return std::abs(x) >= kHalfX_m || std::abs(y) >= kHalfY_m ||
           (has_block && x >= kHalfX_m - kBlock_m && y >= kHalfY_m - kBlock_m);
  }

  /// Cells of 5 cm: walls 10 cm thick are occupied, the room is free.
  OccupancyMap map() const {
    OccupancyMap map;
    auto editor = map.edit();
    for (double x = -3.075; x < 3.1; x += 0.05) {
      for (double y = -2.075; y < 2.1; y += 0.05) {
        const auto key = map.lattice().key_of(Eigen::Vector3d(x, y, 0.01));
        editor.update(*key, LogOdds(is_wall(x, y) ? 2.0F : -2.0F));
      }
    }
    editor.synchronize();
    return map;
  }

  double range_m(double x, double y, double yaw) const {
    double range = 0.0;
    while (!is_wall(x + range * std::cos(yaw), y + range * std::sin(yaw))) range += 0.001;
    return range;
  }

  /// The beam number `i` of a head that turns in ten seconds, 100 beams a turn: the wall is seven bins long.
  Beam beam(int i, const State& state) const {
    constexpr double kBin_m = 0.02;
    Beam beam{0.1 * i, wrap_bearing(2.0 * std::numbers::pi * i / 100.0), kBin_m, std::vector<std::uint8_t>(400, 5)};
    const auto bin = static_cast<int>(range_m(state.x, state.y, state.yaw + beam.bearing_rad) / kBin_m);
    for (int b = std::max(0, bin - 3); b <= bin + 3 && b < 400; ++b)
      beam.intensities[static_cast<std::size_t>(b)] = 200;
    return beam;
  }
};

}  // namespace pingvox::test
