#include <gtest/gtest.h>

#include "support/map_duel.hpp"

using namespace pingvox;

namespace {

constexpr std::array kDepths{1, 2, 3, 8, 16, 17, 32, 33, 64, 65, 128};

class OccupancyMapAtDepth : public testing::TestWithParam<int> {};

TEST_P(OccupancyMapAtDepth, AnswersLikeTheOracleAfterRandomOperations) {
  std::size_t compared = 0, joined = 0;
  const std::uint64_t seeds = GetParam() <= 3 ? 60 : (GetParam() <= 17 ? 8 : 4);
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE(seed);
    test::Duel duel(GetParam(), seed);
    for (int i = 0; i < 40; ++i) {
      SCOPED_TRACE(i);
      duel.step();
      if (i % 2 == 1) duel.check();
      if (HasFailure()) return;
    }
    compared += duel.nodes_compared();
    joined += duel.joined_leaves();
  }
  EXPECT_GT(compared, GetParam() == 1 ? 5'000U : 100'000U);
  EXPECT_GT(joined, 50U);
}

INSTANTIATE_TEST_SUITE_P(AllKeyWidths, OccupancyMapAtDepth, testing::ValuesIn(kDepths));

}  // namespace
