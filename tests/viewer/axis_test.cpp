#include "viewer/axis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace pingvox {
namespace {

std::vector<std::string> texts_of(const std::vector<Tick>& ticks) {
  std::vector<std::string> texts;
  for (const Tick& tick : ticks) texts.push_back(tick.text);
  return texts;
}

TEST(Ticks, AreRoundNumbersWithinTheAxis) {
  using Texts = std::vector<std::string>;
  EXPECT_EQ(texts_of(ticks_of({-0.31, 1.04}, 8)), (Texts{"-0.2", "0", "0.2", "0.4", "0.6", "0.8", "1"}));
  EXPECT_EQ(texts_of(ticks_of({10.0, 0.0}, 3)), (Texts{"0", "5", "10"}));
  EXPECT_EQ(texts_of(ticks_of({1.0, 1000.0, Spacing::kLogarithmic}, 8)), (Texts{"1", "10", "100", "1000"}));
  EXPECT_EQ(texts_of(ticks_of({0.5, 20.0, Spacing::kLogarithmic}, 9)), (Texts{"0.5", "1", "2", "5", "10", "20"}));
  // Far from 0, neighbours still differ.
  EXPECT_EQ(texts_of(ticks_of({4600000.1, 4600001.1}, 2)), (Texts{"4600000.5", "4600001"}));
  const std::vector<Tick> falling = ticks_of({10.0, 0.0}, 3);
  EXPECT_DOUBLE_EQ(falling.front().share, 1.0);
  EXPECT_DOUBLE_EQ(falling.back().share, 0.0);
}

TEST(Ticks, AreNoneWhereNumbersCannotBeTold) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] :
       {std::pair{0.0, inf}, std::pair{-inf, inf}, std::pair{1.0, 1.0}, std::pair{1e300, 1e300},
        std::pair{-1.7e308, 1.7e308}, std::pair{1.0, std::nextafter(1.0, 2.0)}}) {
    EXPECT_LE(ticks_of({from, to}, 8).size(), 9U);
  }
  EXPECT_TRUE(ticks_of({0.0, inf}, 8).empty());
  EXPECT_TRUE(ticks_of({1.0, 1.0}, 8).empty());
}

}  // namespace
}  // namespace pingvox
