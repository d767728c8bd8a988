#include "pingvox/sim/scene.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/sim/sonar.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

struct Named {
  std::string name;
  Scene scene;
};

TriangleMesh cube_at(const Vector3d& centre_m) {
  World world;
  world.add(Cuboid{Pose(Eigen::Translation3d(centre_m)), {1.0, 2.0, 0.5}});
  return world.mesh(0.01);
}

std::vector<Named> all_scenes() {
  std::vector<Named> scenes = {{"tank", tank_scene({})},
                               {"large tank", tank_scene({.side_m = 30.0})},
                               {"harbour", harbour_scene({})},
                               {"long harbour", harbour_scene({.length_m = 60.0, .piles = 6, .hull_length_m = 20.0})},
                               {"marina", marina_scene({})},
                               {"seabed", seabed_scene({})},
                               {"steep seabed", seabed_scene({.slope = 0.1, .ripples = 2.0, .boulders = 300})},
                               {"cave", cave_scene({})},
                               {"long cave", cave_scene({.length_m = 60.0, .bumps = 0.3})},
                               {"mesh", *mesh_scene(cube_at({20.0, 3.0, 1.0}))}};
  return scenes;
}

TEST(Scenes, TheirWaysHitNothingAndStayInTheWater) {
  std::size_t ways = 0;
  for (const auto& [name, scene] : all_scenes()) {
    for (const Motion motion : {Motion::kStill, Motion::kLine, Motion::kLawnMower, Motion::kLoop, Motion::kByHand}) {
      SCOPED_TRACE(name + ", way " + std::to_string(static_cast<int>(motion)));
      const Route* route = scene.route(motion);
      ASSERT_EQ(route == nullptr, motion == Motion::kStill);
      if (!route && name == "mesh") continue;
      const Trajectory way = !route ? Trajectory::still(Pose::Identity())
                             : motion == Motion::kByHand
                                 ? drive_by_hand(*route, {.speed_m_s = 0.5}, 3)
                                 : follow_route(*route, length_m(*route) / 0.5, {.speed_m_s = 0.5});
      for (std::size_t n = 0; n < way.poses().size(); ++n) {
        const Vector3d at = way.poses()[n].map_from_body.translation();
        ASSERT_TRUE(scene.water_m.contains(at)) << at.transpose();
        // Half a metre of room all around.
        for (int i = 0; i < 26; ++i) {
          const double bearing = i * 0.77;
          const double elevation = std::asin((i - 12.5) / 13.0);
          const Vector3d direction(std::cos(elevation) * std::cos(bearing), std::cos(elevation) * std::sin(bearing),
                                   std::sin(elevation));
          ASSERT_FALSE(scene.world.first({at, direction}, name == "tank" ? 0.2 : 0.4)) << at.transpose();
        }
        if (n == 0) continue;
        const Vector3d before = way.poses()[n - 1].map_from_body.translation();
        if (before == at) continue;
        ASSERT_FALSE(scene.world.first({before, (at - before).normalized()}, (at - before).norm()));
      }
      ++ways;
    }
  }
  EXPECT_EQ(ways, 10U * 5U - 1U);
}

TEST(Scenes, HaveSomethingToHearFromTheirMiddle) {
  for (const auto& [name, scene] : all_scenes()) {
    if (name == "mesh") continue;
    SonarOptions options;
    options.bin_length_m = scene.sonar_range_m / 399.0;
    int heard = 0;
    for (int n = 0; n < 72; ++n) {
      heard += true_range(scene.world, Pose::Identity(), n * 5.0 * kDegree_rad, options).cone_m ? 1 : 0;
    }
    EXPECT_GT(heard, 72 / 3) << name;
    EXPECT_GE(scene.world.bounds().volume(), 10.0) << name;
  }
}

TEST(Scenes, TheMarinaIsAsLargeAndItsLoopAsLongAsTheRecordedOne) {
  const Scene marina = marina_scene({});
  EXPECT_NEAR(marina.world.bounds().sizes().x(), 400.0, 1.0);
  EXPECT_NEAR(marina.world.bounds().sizes().y(), 300.0, 1.0);
  EXPECT_NEAR(length_m(marina.loop), 600.0, 30.0);
  // A shore without gaps: away from all quays, sound comes to one wherever it goes.
  for (int n = 0; n < 360; ++n) {
    const double bearing = n * std::numbers::pi / 180.0;
    ASSERT_TRUE(marina.world.first({Vector3d::Zero(), {std::cos(bearing), std::sin(bearing), 0.0}}, 500.0)) << n;
  }
}

TEST(Scenes, AreTheSameWhenMadeAgain) {
  const auto once = all_scenes();
  const auto again = all_scenes();
  for (std::size_t n = 0; n < once.size(); ++n) {
    EXPECT_EQ(once[n].scene.world.mesh(0.01).vertices_m, again[n].scene.world.mesh(0.01).vertices_m) << once[n].name;
  }
}

/// The limits of a field are those of its comment.
template <class Options, class Field>
void expect_within(Field Options::* field, Field low, std::type_identity_t<Field> high) {
  const auto is_valid = [&](Field value) {
    Options options;
    options.*field = value;
    return options.validate().has_value();
  };
  const auto margin = static_cast<Field>(std::is_integral_v<Field> ? 1.0 : 1e-9);
  EXPECT_TRUE(is_valid(low)) << low;
  EXPECT_TRUE(is_valid(high)) << high;
  EXPECT_FALSE(is_valid(high + margin)) << high;
  // 0 - 1 is a large number.
  EXPECT_FALSE(is_valid(low - margin)) << low;
}

TEST(Scenes, TakeWhatTheirOptionsSay) {
  EXPECT_TRUE((HarbourOptions{.length_m = 200.0}.validate()));
  EXPECT_FALSE((HarbourOptions{.length_m = 200.1}.validate()));
  EXPECT_TRUE((HarbourOptions{.length_m = 16.0, .hull_length_m = 7.0}.validate()));
  EXPECT_FALSE((HarbourOptions{.length_m = 15.9, .hull_length_m = 7.0}.validate()));
  expect_within(&HarbourOptions::width_m, 12.0, 200.0);
  expect_within(&HarbourOptions::water_above_m, 0.5, 50.0);
  expect_within(&HarbourOptions::water_below_m, 0.5, 50.0);
  expect_within(&HarbourOptions::piles, std::size_t{0}, 6);
  expect_within(&MarinaOptions::water_above_m, 0.5, 50.0);
  expect_within(&MarinaOptions::water_below_m, 0.5, 50.0);
  expect_within(&SeabedOptions::side_m, 20.0, 200.0);
  expect_within(&SeabedOptions::depth_m, 1.5, 50.0);
  expect_within(&SeabedOptions::slope, -0.1, 0.1);
  expect_within(&SeabedOptions::ripples, 0.0, 2.0);
  expect_within(&SeabedOptions::boulders, std::size_t{0}, 1000);
  expect_within(&CaveOptions::length_m, 10.0, 500.0);
  expect_within(&CaveOptions::radius_m, 1.5, 50.0);
  expect_within(&CaveOptions::bumps, 0.0, 0.3);
}

TEST(Scenes, RefuseWhatCannotBeBuilt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT((HarbourOptions{.length_m = nan, .width_m = 1.0, .piles = 7, .pile_radius_m = 0.0, .hull_beam_m = 9.0})
                  .validate()
                  .error()
                  .message,
              AllOf(HasSubstr("length_m"), HasSubstr("width_m"), HasSubstr("piles"), HasSubstr("pile_radius_m"),
                    HasSubstr("hull_beam_m")));
  EXPECT_THAT((MarinaOptions{.water_above_m = 0.0, .water_below_m = nan}).validate().error().message,
              AllOf(HasSubstr("water_above_m"), HasSubstr("water_below_m")));
  EXPECT_THAT((SeabedOptions{.side_m = 3.0, .depth_m = 0.1, .slope = 1.0, .ripples = nan, .boulders = 2000})
                  .validate()
                  .error()
                  .message,
              AllOf(HasSubstr("side_m"), HasSubstr("depth_m"), HasSubstr("slope"), HasSubstr("ripples"),
                    HasSubstr("boulders")));
  EXPECT_THAT((CaveOptions{.length_m = 1.0, .radius_m = 0.1, .bumps = 2.0}).validate().error().message,
              AllOf(HasSubstr("length_m"), HasSubstr("radius_m"), HasSubstr("bumps")));
  EXPECT_FALSE(mesh_scene({}));
  TriangleMesh huge = cube_at({0.0, 0.0, 0.0});
  huge.vertices_m.front().x() = 1e300;
  EXPECT_FALSE(mesh_scene(huge));
}

}  // namespace
}  // namespace pingvox
