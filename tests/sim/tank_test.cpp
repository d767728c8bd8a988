#include "pingvox/sim/tank.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "bench/tank_range.hpp"
#include "pingvox/sim/scene.hpp"

namespace pingvox {
namespace {

using bench::true_range_m;
using testing::AllOf;
using testing::HasSubstr;

TEST(TrueRange, IsTheWallsDistanceOverTheCosine) {
  TankOptions tank{.side_m = 4.0, .sensor_x_m = 0.5, .sensor_y_m = -0.25, .sensor_yaw_rad = 0.0};
  tank.floater_radius_m = 0.0;
  EXPECT_NEAR(true_range_m(tank, 0.0), 1.5, 1e-12);
  EXPECT_NEAR(true_range_m(tank, std::numbers::pi / 2), 2.25, 1e-12) << "left";
  EXPECT_NEAR(true_range_m(tank, std::numbers::pi), 2.5, 1e-12);
  EXPECT_NEAR(true_range_m(tank, -std::numbers::pi / 2), 1.75, 1e-12) << "right";
  EXPECT_NEAR(true_range_m(tank, std::numbers::pi / 6), 1.5 / std::cos(std::numbers::pi / 6), 1e-12);
  EXPECT_NEAR(true_range_m(tank, std::atan2(2.25, 1.5)), std::hypot(2.25, 1.5), 1e-9) << "the corner";
  tank.sensor_yaw_rad = 0.2;
  EXPECT_NEAR(true_range_m(tank, -0.2), 1.5, 1e-12) << "a sensor turned to the left sees the front wall to its right";
}

TEST(TrueRange, IsTheFloatersNearSideWhereItStandsInTheWay) {
  TankOptions tank{.side_m = 4.0, .sensor_x_m = 0.0, .sensor_y_m = 0.0, .sensor_yaw_rad = 0.1};
  tank.floater_bearing_rad = 1.0;
  tank.floater_range_m = 1.2;
  tank.floater_radius_m = 0.3;
  EXPECT_NEAR(true_range_m(tank, 1.0), 0.9, 1e-12);
  const double edge = std::asin(0.3 / 1.2);
  EXPECT_NEAR(true_range_m(tank, 1.0 + edge - 1e-9), std::sqrt(1.2 * 1.2 - 0.3 * 0.3), 1e-3) << "the tangent";
  EXPECT_GT(true_range_m(tank, 1.0 + edge + 1e-6), 1.9);
  EXPECT_GT(true_range_m(tank, 1.0 + std::numbers::pi), 1.9) << "a floater behind is not in the way";
}

TEST(TrueRange, IsWhatTheTanksWorldSays) {
  std::size_t on_floater = 0;
  for (const double yaw_rad : {0.05, -1.3, 3.0}) {
    const TankOptions tank{.sensor_yaw_rad = yaw_rad};
    const World world = tank_scene(tank).world;
    for (int n = 0; n < 1000; ++n) {
      const double bearing = 2.0 * std::numbers::pi * n / 1000.0;
      const auto hit = world.first({{0.0, 0.0, 0.0}, {std::cos(bearing), std::sin(bearing), 0.0}}, 100.0);
      ASSERT_TRUE(hit) << bearing;
      EXPECT_NEAR(hit->range_m, true_range_m(tank, bearing), 1e-9) << bearing;
      on_floater += hit->surface == 4 ? 1U : 0U;
    }
  }
  EXPECT_GT(on_floater, 3U * 20U);
}

TEST(TankOptions, NameEveryBrokenField) {
  EXPECT_TRUE(TankOptions{}.validate());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const TankOptions broken{
      .side_m = nan, .depth_m = 0.0, .sensor_yaw_rad = nan, .floater_range_m = 0.01, .floater_radius_m = -1.0};
  EXPECT_THAT(broken.validate().error().message,
              AllOf(HasSubstr("side_m"), HasSubstr("depth_m"), HasSubstr("sensor_x_m"), HasSubstr("sensor_y_m"),
                    HasSubstr("sensor_yaw_rad"), HasSubstr("floater_radius_m")));
}

}  // namespace
}  // namespace pingvox
