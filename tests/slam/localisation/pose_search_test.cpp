#include "slam/localisation/pose_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace pingvox {
namespace {

// Kills a place that is believed although another one, as among boulders, fits about as well.
TEST(PoseSearch, APlaceIsDistinctWhereNoOtherIsMoreThanAFifthAsLikely) {
  const double fifth = std::log(5.0);
  const ScoredPose best{{{1.0, 2.0}, 0.0}, -3.0};
  const ScoredPose beside{{{1.2, 2.1}, 0.1}, -3.1};
  const auto elsewhere = [](double log_likelihood) { return ScoredPose{{{9.0, 2.0}, 0.0}, log_likelihood}; };
  const ScoredPose turned{{{1.0, 2.0}, 3.0}, -3.5};
  EXPECT_TRUE(is_distinct(std::vector{best}));
  EXPECT_TRUE(is_distinct(std::vector{best, beside, elsewhere(-3.01 - fifth)}));
  EXPECT_FALSE(is_distinct(std::vector{best, beside, elsewhere(-2.99 - fifth)}));
  EXPECT_FALSE(is_distinct(std::vector{best, turned}));
}

}  // namespace
}  // namespace pingvox
