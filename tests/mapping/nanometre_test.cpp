#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "pingvox/mapping/beam_model.hpp"
#include "support/rounds.hpp"
#include "tests/support/scan_cells.hpp"
#include "tests/support/uniform.hpp"

namespace pingvox {
namespace {

using test::uniform;

constexpr double kNanometre = 1e-9;

/// A beam with an echo.
struct Ping {
  Beam beam;
  Echo echo;
  double free_m() const { return static_cast<double>(echo.first) * beam.bin_length_m; }
};

/// What a head hears in a turn, at ranges of about so many cells.
std::vector<Ping> turn(std::mt19937_64& random, double resolution_m, std::size_t beams, std::size_t range) {
  std::vector<Ping> pings(beams);
  for (std::size_t i = 0; i < pings.size(); ++i) {
    Ping& ping = pings[i];
    ping.beam.bearing_rad =
        2.0 * std::numbers::pi * (static_cast<double>(i) + uniform(random, 0, 1)) / static_cast<double>(beams);
    ping.beam.bin_length_m = resolution_m * uniform(random, 0.2, 0.3);
    ping.echo.first = 4 * range + random() % range;
    ping.echo.range_m = ping.free_m() + resolution_m * uniform(random, 0.1, 3.0);
    ping.echo.intensity = 200;
  }
  return pings;
}

std::map<WideKey, bool> cells_of(const std::vector<Ping>& pings, const Lattice& lattice, const Pose& map_from_sensor,
                                 const BeamModelOptions& model) {
  ScanUpdate scan(lattice);
  for (const Ping& ping : pings) trace_beam(map_from_sensor, ping.beam, ping.echo, model, scan);
  return test::cells_of(scan);
}

/// A sphere's sector as a beam fills it.
struct Wedge {
  double bearing_rad, half_width_rad, half_height_rad, range_m;

  /// How far a point of the sensor frame lies outside [m], at most; negative: inside.
  double outside_m(const Eigen::Vector3d& point_m) const {
    const double level_m = std::hypot(point_m.x(), point_m.y());
    const double off_bearing =
        std::abs(std::remainder(std::atan2(point_m.y(), point_m.x()) - bearing_rad, 2.0 * std::numbers::pi));
    const double off_level = std::abs(std::atan2(point_m.z(), level_m));
    const double beside_m = std::sin(std::min(off_bearing - half_width_rad, std::numbers::pi / 2)) * level_m;
    const double above_m = std::sin(off_level - half_height_rad) * point_m.norm();
    return std::max({point_m.norm() - range_m, beside_m, above_m});
  }
};

/// Whether the border of what any beam freed or hit goes through a cell, or all but.
bool is_at_a_border(const std::vector<Ping>& pings, const Eigen::Vector3d& middle_m, const Pose& map_from_sensor,
                    double resolution_m, const BeamModelOptions& model) {
  const double width = model.shape == BeamShape::kRay ? 0.0 : model.width_rad / 2,
               height = model.shape == BeamShape::kCone ? model.height_rad / 2 : 0.0;
  const double reach_m = 0.5 * std::sqrt(3.0) * resolution_m;
  return std::any_of(pings.begin(), pings.end(), [&](const Ping& ping) {
    const Eigen::Vector3d sensor_m = map_from_sensor.inverse() * middle_m;
    const Wedge all{ping.beam.bearing_rad, width, height, ping.echo.range_m};
    const Wedge freed{ping.beam.bearing_rad, width * model.free_share, height * model.free_share, ping.free_m()};
    // Nearer than this a cell spans all angles. Wedges are cut into pieces, which bulge by some thousandths.
    if (sensor_m.norm() < 3.0 * reach_m) return true;
    const auto is_near = [&](double outside_m) {
      return std::abs(outside_m) < reach_m * 1.01 + 0.002 * sensor_m.norm();
    };
    return is_near(all.outside_m(sensor_m)) || is_near(freed.outside_m(sensor_m));
  });
}

class Nanometre : public testing::TestWithParam<std::pair<BeamShape, Tracing>> {};

// Kills a sensor that stands in one cell for its key and in the neighbour for its beams: on multiples of the resolution
// dividing by it rounds to another side than multiplying by its inverse.
TEST_P(Nanometre, AStepFromTheCornerOfACellChangesOnlyCellsAtTheBordersOfBeams) {
  BeamModelOptions model;
  model.shape = GetParam().first;
  model.tracing = GetParam().second;
  // Where rays begin in a corner, a step decides which cells around it they pass.
  const bool is_of_rays = model.shape == BeamShape::kRay || model.tracing == Tracing::kBundle;
  const double most = is_of_rays ? 0.01 : 0.005;
  std::size_t changed = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(12); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const double resolution_m = std::array{0.05, 0.1, 0.0125, 0.02, 0.3, 0.07}[seed % 6];
    const Lattice lattice(resolution_m);
    // As a person types it: 3 cells of 0.05 m are 0.15, not the double 3 * 0.05.
    const auto multiple = [&] {
      return std::round((static_cast<double>(random() % 401) - 200.0) * resolution_m * 1e6) / 1e6;
    };
    // Turned at random: a flat beam in the plane of faces has no other side to go to.
    Pose pose = pose_from_rpy({multiple(), multiple(), multiple()}, uniform(random, -3, 3), uniform(random, -1.5, 1.5),
                              uniform(random, -3, 3));
    const std::vector<Ping> pings =
        model.shape == BeamShape::kCone ? turn(random, resolution_m, 8, 50) : turn(random, resolution_m, 40, 100);
    const std::map<WideKey, bool> before = cells_of(pings, lattice, pose, model);
    all += before.size();
    for (int side = 0; side < 6; ++side) {
      Pose moved = pose;
      moved.translation()[side / 2] += side % 2 == 0 ? kNanometre : -kNanometre;
      const std::map<WideKey, bool> after = cells_of(pings, lattice, moved, model);
      std::size_t different = 0, off_border = 0;
      const auto judge = [&](const WideKey& key) {
        ++different;
        off_border += !is_at_a_border(pings, lattice.centre_of(key), pose, resolution_m, model);
      };
      for (const auto& [key, is_hit] : before) {
        const auto other = after.find(key);
        if (other == after.end() || other->second != is_hit) judge(key);
      }
      for (const auto& [key, is_hit] : after) {
        if (!before.contains(key)) judge(key);
      }
      EXPECT_LE(static_cast<double>(different), most * static_cast<double>(before.size())) << "side " << side;
      EXPECT_EQ(off_border, 0U) << "side " << side;
      changed += different;
    }
  }
  EXPECT_GT(all, test::rounds(50'000));
  RecordProperty("cells", static_cast<int>(all));
  RecordProperty("changed", static_cast<int>(changed));
}

INSTANTIATE_TEST_SUITE_P(Beams, Nanometre,
                         testing::Values(std::pair(BeamShape::kRay, Tracing::kGeometry),
                                         std::pair(BeamShape::kFan, Tracing::kGeometry),
                                         std::pair(BeamShape::kCone, Tracing::kGeometry),
                                         std::pair(BeamShape::kCone, Tracing::kBundle)),
                         [](const auto& param) -> std::string {
                           if (param.param.first == BeamShape::kRay) return "ray";
                           if (param.param.first == BeamShape::kFan) return "fan";
                           return param.param.second == Tracing::kGeometry ? "cone" : "bundle";
                         });

}  // namespace
}  // namespace pingvox
