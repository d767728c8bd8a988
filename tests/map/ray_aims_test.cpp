#include "map/kernels/ray_aims.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "pingvox/map/ray_dda.hpp"
#include "support/fan.hpp"
#include "support/lanes.hpp"
#include "support/uniform.hpp"

namespace pingvox::detail {
namespace {

constexpr std::uint32_t kSquares = 37;

using test::uniform;

Eigen::Vector3d somewhere(std::mt19937_64& random, double most) {
  return {uniform(random, -most, most), uniform(random, -most, most), uniform(random, -most, most)};
}

struct Found {
  explicit Found(std::size_t count)
      : places(count + kWrittenBeyond), square(count + kWrittenBeyond), aim(count + kWrittenBeyond) {}
  std::vector<std::uint64_t> places;
  std::vector<std::uint32_t> square;
  std::vector<Aim> aim;
};

// Kills a face, row or column that is not the ray's, lanes that mix rays up (all counts up to two vectors' worth), an
// end outside of the window that gets a square.
TEST(RayAims, AreWhereRaysLeaveTheCube) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const RayFan fan = fan_from(somewhere(random, 3.0));
    std::vector<Eigen::Vector3d> ends;
    for (std::uint64_t i = 0; i < seed % 20 + 1; ++i) ends.push_back(somewhere(random, 70.0));
    if (seed % 5 == 0) ends[0] = fan.from;
    const std::span<const Eigen::Vector3d> all = ends;
    for (const Lanes lanes : lanes_here()) {
      SCOPED_TRACE(static_cast<int>(lanes));
      Found found(ends.size());
      found.places.resize(aim_rays(lanes, fan, kSquares, all, {found.places, found.square, found.aim}));
      std::vector<std::uint64_t> places(ends.size() + kWrittenBeyond);
      std::vector<std::uint32_t> outside;
      places.resize(find_cells(Lanes::kOne, fan, all, places, outside));
      ASSERT_EQ(found.places, places);
      for (std::size_t i = 0; i < ends.size(); ++i) {
        if (std::find(outside.begin(), outside.end(), i) != outside.end()) {
          ASSERT_EQ(found.square[i], kNoSquare);
          continue;
        }
        const Eigen::Vector3d way = ends[i] - fan.from;
        int axis = 0;
        const double reach = way.cwiseAbs().maxCoeff(&axis);
        const Aim aim = found.aim[i];
        for (const int number : {kAcross, kUp, kReach}) ASSERT_EQ(aim[number], -aim[number + kNegated]);
        ASSERT_NEAR(aim[kReach], reach * kStepsOfReach, 1.001);
        if (reach == 0.0) continue;
        const double across = way[(axis + 1) % 3] / reach, up = way[(axis + 2) % 3] / reach;
        ASSERT_NEAR(aim[kAcross], across * kStepsOfGain, 1.01);
        ASSERT_NEAR(aim[kUp], up * kStepsOfGain, 1.01);
        ASSERT_EQ(aim[kAcross] > 0, across > 0.0);
        ASSERT_EQ(aim[kUp] < 0, up < 0.0);
        // Single precision may put a ray at the edge of a square into the next one.
        const auto square_of = [&](double gain) { return square_along(static_cast<float>(gain), kSquares); };
        const auto face = static_cast<std::uint32_t>(2 * axis + (way[axis] < 0.0 ? 1 : 0));
        const std::uint32_t row = found.square[i] / kSquares % kSquares, column = found.square[i] % kSquares;
        ASSERT_EQ(found.square[i] / kSquares / kSquares, face);
        ASSERT_TRUE(column == square_of(across - 1e-6) || column == square_of(across + 1e-6));
        ASSERT_TRUE(row == square_of(up - 1e-6) || row == square_of(up + 1e-6));
      }
    }
  }
}

// Kills a cell that a ray crosses and is said not to: every cell of exact walks, asked one by one; and an answer that
// is always yes.
TEST(RayAims, NoCellOfAWalkIsMissed) {
  std::size_t asked = 0, told_apart = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Eigen::Vector3d from = somewhere(random, 3.0);
    if (seed % 3 == 0) from = from.array().round();
    const RayFan fan = fan_from(from);
    const std::array<Eigen::Vector3d, 1> to{from + somewhere(random, seed % 2 == 0 ? 50.0 : 3.0)};
    const std::span<const Eigen::Vector3d> end = to;
    const Eigen::Vector3d way = end[0] - from;
    int axis = 0;
    way.cwiseAbs().maxCoeff(&axis);
    const auto cell_ahead = [&](const Eigen::Vector3d& corner) {
      const double low = way[axis] > 0.0 ? corner[axis] : -corner[axis] - 1.0;
      return CellAhead{static_cast<float>(std::max(0.0, low - 1e-3)), static_cast<float>(low + 1.0 + 1e-3),
                       static_cast<float>(corner[(axis + 1) % 3] + 0.5),
                       static_cast<float>(corner[(axis + 2) % 3] + 0.5), 0.501F};
    };
    const auto may_cross = [&](Lanes lanes, const Eigen::Vector3d& cell) {
      return first_that_may_cross(lanes, fan, cell_ahead(cell - from), end, 1, 0) == 0;
    };
    for (const Lanes lanes : lanes_here()) {
      FaceCrossings crossings(from, end[0]);
      Eigen::Vector3d cell = from.array().floor();
      for (;;) {
        ASSERT_TRUE(may_cross(lanes, cell)) << cell.transpose();
        ++asked;
        const Eigen::Vector3d beside = cell + Eigen::Vector3d::Unit((axis + 1) % 3) * 3.0;
        told_apart += may_cross(lanes, beside) ? 0 : 1;
        if (crossings.left() == 0) break;
        const std::size_t next = crossings.next_axis();
        cell[static_cast<Eigen::Index>(next)] += crossings.is_ahead(next) ? 1.0 : -1.0;
        crossings.cross(next);
      }
      ASSERT_EQ(first_that_may_cross(lanes, fan, cell_ahead(from.array().floor().matrix() - from), end, 1, 1), 1U)
          << "it was left out";
    }
  }
  EXPECT_GT(asked, 5000U);
  EXPECT_GT(told_apart, asked * 9 / 10);
}

}  // namespace
}  // namespace pingvox::detail
