// Sweeps that left the problem, by place.

#include "slam/smoother/held_sweeps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace pingvox::test {
namespace {

// Kills squares that are left out or looked at as a whole, and an order by squares.
TEST(HeldSweeps, NearAreAllWithinTheReachInOrder) {
  HeldSweeps held(1);
  std::vector<std::size_t> expected;
  const Eigen::Vector2d place(-12.0, 20.0);
  for (std::size_t number = 0; number < 200; ++number) {
    const auto n = static_cast<double>(number);
    const Eigen::Vector2d at(150.0 * std::sin(0.37 * n), 150.0 * std::cos(0.21 * n));
    held.add({{number, at, true}, {}});
    if ((at - place).norm() <= 60.0) expected.push_back(number);
  }
  std::vector<std::size_t> near;
  for (const auto& sweep : held.near(place, 60.0)) near.push_back(sweep->place.number);
  EXPECT_GT(near.size(), 5U);
  EXPECT_EQ(near, expected);
  for (const double far : {1e300, std::nan("")}) {
    EXPECT_TRUE(held.near({far, 0.0}, 60.0).empty());
    EXPECT_TRUE(held.near({0.0, far}, 60.0).empty());
  }
}

}  // namespace
}  // namespace pingvox::test
