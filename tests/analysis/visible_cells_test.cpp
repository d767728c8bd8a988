// What could be seen in a room where that can be told by hand.
#include "pingvox/analysis/visible_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;

/// A room of 10 m x 10 m x 5 m of water around the origin, in cells of 0.1 m, with four walls and no floor; and a
/// pillar of 1 m x 1 m from x = 2 m on.
OccupancyMap room() {
  OccupancyMap map(MapOptions{.resolution_m = 0.1});
  Editor editor = map.edit();
  for (int z = -25; z < 25; ++z) {
    for (int y = -51; y <= 50; ++y) {
      for (int x = -51; x <= 50; ++x) {
        const bool is_wall = x == -51 || x == 50 || y == -51 || y == 50;
        const bool is_pillar = x >= 20 && x < 30 && y >= -5 && y < 5;
        const Vector3d middle_m = 0.1 * (Vector3d(x, y, z).array() + 0.5);
        editor.set(*map.lattice().key_of(middle_m), map.lattice().depth(),
                   LogOdds(is_wall || is_pillar ? 2.0F : -2.0F));
      }
    }
  }
  editor.synchronize();
  return map;
}

const Pose kOrigin{Eigen::Translation3d(0.0, 0.0, 0.0)};

class InARoom : public testing::Test {
 protected:
  OccupancyMap seen(const std::vector<Pose>& poses, const ViewOptions& options = {}) const {
    const auto visible = visible_cells(room_, room_, poses, options);
    EXPECT_TRUE(visible) << visible.error().message;
    return *visible;
  }

  OccupancyMap room_ = room();
};

TEST_F(InARoom, TheWallBehindAPillarIsHidden) {
  const OccupancyMap visible = seen({kOrigin});
  // The pillar's front from 2 m on is 1 m wide: its shadow on the wall at 5 m is 2.5 m wide.
  for (double y_m = -4.95; y_m < 5.0; y_m += 0.1) {
    SCOPED_TRACE(y_m);
    if (std::abs(std::abs(y_m) - 1.25) < 0.1) continue;  // the shadow's edge
    EXPECT_EQ(visible.at(Vector3d(5.05, y_m, 0.05)).has_value(), std::abs(y_m) > 1.25);
  }
  EXPECT_TRUE(visible.at(Vector3d(2.05, 0.05, 0.05)));   // the pillar's front
  EXPECT_FALSE(visible.at(Vector3d(2.95, 0.05, 0.05)));  // and its back
  EXPECT_FALSE(visible.at(Vector3d(2.55, 0.05, 0.05)));  // nothing looks into it
  EXPECT_FALSE(visible.at(Vector3d(5.05, 5.05, 0.05)));  // nor round the corner of two walls
  EXPECT_FALSE(visible.at(Vector3d(1.05, 1.05, 0.05))) << "water is nothing to find";
}

TEST_F(InARoom, FromAPlaceBesideThePillarTheWallBehindItIsSeen) {
  const Pose beside{Eigen::Translation3d(2.5, 3.0, 0.0)};
  EXPECT_TRUE(seen({kOrigin, beside}).at(Vector3d(5.05, 0.05, 0.05)));
}

// Kills views that are taken for the one before them: near it, or at its place and turned.
TEST_F(InARoom, SeveralViewsSeeWhatEachOfThemSees) {
  const ViewOptions narrow{.max_range_m = 6.0, .height_rad = 4.0 * kDegree_rad};
  const std::vector<Pose> poses = {kOrigin, Pose(Eigen::Translation3d(0.0, 0.0, 1.0)),
                                   pose_from_rpy({0.0, 0.0, 1.0}, 30.0 * kDegree_rad, 0.0, 0.0),
                                   pose_from_rpy({0.0, 0.2, 1.0}, 30.0 * kDegree_rad, 0.0, 0.0)};
  const OccupancyMap all = seen(poses, narrow);
  std::size_t more = 0;
  for (const Pose& pose : poses) {
    const OccupancyMap one = seen({pose}, narrow);
    EXPECT_FALSE(one.empty());
    for (double z_m = -2.45; z_m < 2.5; z_m += 0.1) {
      for (double y_m = -4.95; y_m < 5.0; y_m += 0.1) {
        const Vector3d cell_m(-5.05, y_m, z_m);
        EXPECT_TRUE(!one.at(cell_m) || all.at(cell_m)) << cell_m.transpose();
        more += all.at(cell_m) && !one.at(cell_m) ? 1U : 0U;
      }
    }
  }
  EXPECT_GT(more, 100U);
}

TEST_F(InARoom, OnlyWhatIsInTheBeamIsSeen) {
  const OccupancyMap visible = seen({kOrigin});
  const double edge_m = 5.0 * std::tan(17.5 * kDegree_rad);  // 1.58 m up the wall at 5 m
  EXPECT_TRUE(visible.at(Vector3d(-5.05, 0.05, edge_m - 0.1)));
  EXPECT_FALSE(visible.at(Vector3d(-5.05, 0.05, edge_m + 0.1)));
  EXPECT_TRUE(seen({kOrigin}, {.height_rad = 50.0 * kDegree_rad}).at(Vector3d(-5.05, 0.05, edge_m + 0.1)));
  // Rolled by 90 degrees it turns in the plane of x and z.
  const Pose rolled = pose_from_rpy(Vector3d::Zero(), 90.0 * kDegree_rad, 0.0, 0.0);
  EXPECT_TRUE(seen({rolled}).at(Vector3d(-5.05, 0.05, edge_m + 0.1)));
  EXPECT_FALSE(seen({rolled}).at(Vector3d(-5.05, 2.05, 0.05)));
}

TEST_F(InARoom, OnlyWhatIsInRangeIsSeen) {
  const OccupancyMap visible = seen({kOrigin}, {.min_range_m = 2.1, .max_range_m = 6.0});
  EXPECT_FALSE(visible.at(Vector3d(2.05, 0.05, 0.05)));  // the pillar, 2 m off
  EXPECT_TRUE(visible.at(Vector3d(5.05, 3.05, 0.05)));   // 5.9 m
  EXPECT_FALSE(visible.at(Vector3d(5.05, 3.55, 0.05)));  // 6.1 m
}

TEST_F(InARoom, NothingIsSeenFromWithinAWallOrWithoutAPose) {
  EXPECT_TRUE(seen({Pose(Eigen::Translation3d(2.55, 0.05, 0.0))}).empty());
  EXPECT_TRUE(seen({}).empty());
}

TEST_F(InARoom, OfOneLayerWhatOtherLayersHideIsHidden) {
  OccupancyMap layer(room_.options());
  for (const double y_m : {0.05, 3.05}) {
    layer.edit().set(*layer.lattice().key_of({5.05, y_m, 1.05}), layer.lattice().depth(), LogOdds(2.0F));
  }
  const std::vector<Pose> poses = {kOrigin};
  const auto visible = visible_cells(layer, room_, poses, {});
  ASSERT_TRUE(visible);
  EXPECT_TRUE(visible->at(Vector3d(5.05, 3.05, 1.05)));
  EXPECT_FALSE(visible->at(Vector3d(5.05, 0.05, 1.05)));  // behind the pillar
  EXPECT_EQ(visible->counts().occupied_cells, 1U);
}

TEST(VisibleCells, RefusesOptionsAndLatticesThatDoNotFit) {
  const OccupancyMap map(MapOptions{.resolution_m = 0.1}), other(MapOptions{.resolution_m = 0.2});
  const std::vector<Pose> poses = {kOrigin};
  EXPECT_FALSE(visible_cells(map, other, poses, {}));
  EXPECT_FALSE(visible_cells(map, map, poses, {.min_range_m = 2.0, .max_range_m = 1.0}));
  EXPECT_FALSE(visible_cells(map, map, poses, {.height_rad = 0.0}));
}

}  // namespace
}  // namespace pingvox
