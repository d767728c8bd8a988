// Sweeps that left the problem, by place.

#include "slam/smoother/fixed_sweeps.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <set>
#include <span>
#include <vector>

namespace pingvox::test {
namespace {

// Kills squares that are left out or looked at as a whole, and an order by squares.
TEST(FixedSweeps, NearAreAllWithinTheReachInOrder) {
  FixedSweeps fixed(1);
  std::vector<std::size_t> expected;
  const Eigen::Vector2d place(-12.0, 20.0);
  for (std::size_t number = 0; number < 200; ++number) {
    const auto n = static_cast<double>(number);
    const Eigen::Vector2d at(150.0 * std::sin(0.37 * n), 150.0 * std::cos(0.21 * n));
    fixed.add({{number, at, true}, {}});
    if ((at - place).norm() <= 60.0) expected.push_back(number);
  }
  std::vector<std::size_t> near;
  for (const auto& sweep : fixed.near(place, 60.0)) near.push_back(sweep->place.number);
  EXPECT_GT(near.size(), 5U);
  EXPECT_EQ(near, expected);
  for (const double far : {1e300, std::nan("")}) {
    EXPECT_TRUE(fixed.near({far, 0.0}, 60.0).empty());
    EXPECT_TRUE(fixed.near({0.0, far}, 60.0).empty());
  }
}

// Kills squares around a place that are not looked at, and partners out of reach.
TEST(FixedSweeps, PartnersAreTheLastOnesAndThoseNearInPlace) {
  constexpr std::size_t kSweeps = 60;
  constexpr double kApart_m = 8.0, kReach_m = 34.9;
  FixedSweeps held(1);
  const auto place_of = [](std::size_t number) {
    const double way_m = kApart_m * static_cast<double>(number) - 200.0;
    return Eigen::Vector2d(way_m * std::cos(0.4), way_m * std::sin(0.4));
  };
  for (std::size_t number = 0; number < kSweeps; ++number) held.add({{number, place_of(number), true}, {}});
  for (double along_m = -250.0; along_m < 300.0; along_m += 3.0) {
    for (const double beside_m : {-20.0, 0.0, 33.0}) {
      const Eigen::Vector2d at = Eigen::Rotation2Dd(0.4) * Eigen::Vector2d(along_m, beside_m);
      std::set<std::size_t> expected;
      for (std::size_t number = 0; number < kSweeps; ++number) {
        const bool is_last = kSweeps - number <= kFarthestNear;
        if (is_last || (at - place_of(number)).norm() <= kReach_m) expected.insert(number);
      }
      const SweepPlace window{kSweeps + kFar, at, true};
      std::vector<std::size_t> found;
      for (const auto& sweep : held.partners(std::span(&window, 1), kReach_m)) found.push_back(sweep->place.number);
      EXPECT_EQ(found, std::vector(expected.begin(), expected.end())) << along_m << ", " << beside_m;
    }
  }
}

}  // namespace
}  // namespace pingvox::test
