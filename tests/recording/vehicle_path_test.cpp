#include "pingvox/recording/vehicle_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "nav/internal/nav_frames.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"

namespace pingvox::test {
namespace {

NavSource source(const std::string& name, NavQuantity quantity, const std::string& frame) {
  NavSource source;
  source.name = name;
  source.quantity = quantity;
  source.frame = frame;
  return source;
}

void add(NavSource& to, double time_s, const Eigen::Vector3d& value) {
  NavSample sample;
  sample.time_s = time_s;
  sample.value = value;
  to.samples.push_back(sample);
}

NavFiles files_of(std::vector<NavSource> sources) {
  return {*NavLog::make(std::move(sources), NavClock::kUnknown), 0, {}, {}, {}, {}};
}

/// A device that drives a quarter of a circle of 10 m from where it began, looking along y, and a compass that is
/// `north_rad` ahead of it.
NavFiles reckoned(double north_rad, double wander_rad = 0.0) {
  NavSource position = source("dvl", NavQuantity::kPosition, std::string(kStartFrame));
  NavSource attitude = source("dvl", NavQuantity::kAttitude, std::string(kStartFrame));
  NavSource compass = source("compass", NavQuantity::kHeading, "");
  for (int n = 0; n <= 90; ++n) {
    const double turned = n * kDegree_rad, yaw = 0.5 * std::numbers::pi + turned;
    add(position, n, {10.0 * (std::cos(turned) - 1.0), 10.0 * std::sin(turned), 0.0});
    add(attitude, n, {0.0, 0.0, yaw});
    add(compass, n, {std::remainder(yaw + north_rad + wander_rad * n, 2.0 * std::numbers::pi), 0.0, 0.0});
  }
  return files_of({position, attitude, compass});
}

TEST(VehiclePath, OfDeadReckoningIsTurnedToTheNorthByACompass) {
  for (const double north_rad : {0.0, 0.4, 1.6, 3.1, -2.0}) {
    const auto path = path_of(reckoned(north_rad), "dive", 0.0);
    ASSERT_TRUE(path) << path.error().message;
    EXPECT_EQ(path->axes, MapAxes::kEastNorth);
    EXPECT_EQ(path->nav->north_by, "compass");
    const auto last = path->trajectory.at(90.0);
    ASSERT_TRUE(last);
    const Eigen::Vector2d there = Eigen::Rotation2Dd(north_rad) * Eigen::Vector2d(-10.0, 10.0);
    EXPECT_NEAR(last->translation().x(), there.x(), 1e-6) << north_rad;
    EXPECT_NEAR(last->translation().y(), there.y(), 1e-6) << north_rad;
    EXPECT_NEAR(std::remainder(rpy_of(last->rotation()).z() - std::numbers::pi - north_rad, 2.0 * std::numbers::pi),
                0.0, 1e-9);
  }
}

// Kills a map that is turned by a compass that has nothing to do with how the vehicle turned.
TEST(VehiclePath, OfDeadReckoningStaysWhereTheHeadingsDisagree) {
  const auto path = path_of(reckoned(0.5, 0.1), "dive", 0.0);
  ASSERT_TRUE(path) << path.error().message;
  EXPECT_EQ(path->axes, MapAxes::kRightAhead);
  EXPECT_EQ(path->nav->north_by, "");
  EXPECT_NEAR(path->trajectory.at(90.0)->translation().x(), -10.0, 1e-9);
}

TEST(VehiclePath, KnowsWhetherAPositionHasANorth) {
  const auto axes_in = [](const std::string& frame) {
    NavSource position = source("p", NavQuantity::kPosition, frame);
    NavSource attitude = source("p", NavQuantity::kAttitude, frame);
    for (int n = 0; n < 20; ++n) {
      add(position, n, {0.1 * n, 0.0, 0.0});
      add(attitude, n, {0.0, 0.0, 0.01 * n});
    }
    return path_of(files_of({position, attitude}), "dive", 0.0)->axes;
  };
  EXPECT_EQ(axes_in(""), MapAxes::kEastNorth);
  EXPECT_EQ(axes_in("world_ned"), MapAxes::kEastNorth);
  EXPECT_EQ(axes_in("map_enu"), MapAxes::kEastNorth);
  EXPECT_EQ(axes_in("odom"), MapAxes::kUnknown);
  EXPECT_EQ(axes_in(std::string(kStartFrame)), MapAxes::kRightAhead);
  EXPECT_EQ(still_path().axes, MapAxes::kUnknown);
}

}  // namespace
}  // namespace pingvox::test
