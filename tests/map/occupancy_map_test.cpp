#include <gtest/gtest.h>

#include <array>
#include <random>

#include "support/random_operations.hpp"
#include "support/rounds.hpp"

using namespace pingvox;

namespace {

constexpr std::array kDepths{1, 2, 3, 8, 16, 17, 32, 33, 64, 65, 128};

class OccupancyMapAtDepth : public testing::TestWithParam<int> {};

TEST_P(OccupancyMapAtDepth, AnswersLikeTheOracleAfterRandomOperations) {
  std::size_t compared = 0, joined = 0;
  const std::size_t seeds = test::rounds(GetParam() <= 3 ? 60 : (GetParam() <= 17 ? 8 : 4));
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE(seed);
    test::RandomOperations operations(GetParam(), seed);
    for (int i = 0; i < 40; ++i) {
      SCOPED_TRACE(i);
      operations.step();
      if (i % 2 == 1) operations.check();
      if (HasFailure()) return;
    }
    compared += operations.nodes_compared();
    joined += operations.joined_leaves();
  }
  EXPECT_GT(compared, test::rounds(GetParam() == 1 ? 5'000 : 100'000));
  EXPECT_GT(joined, test::rounds(50));
}

// Kills a class of a cell that is another one than its belief's: in a brick, in a larger leaf, where nothing is known,
// between the thresholds and on them.
TEST_P(OccupancyMapAtDepth, ClassifiesTheBeliefThatItHolds) {
  const int depth = GetParam();
  const LogOdds lower(-0.5F), upper(1.0F);
  OccupancyMap map({.depth = depth, .thresholds = {lower, upper}});
  std::mt19937_64 random(7);
  const WideWord cells = depth >= 4 ? 16 : WideWord{1} << depth;  // around the centre, where octants of the root meet
  const WideWord lowest = (WideWord{1} << (depth - 1)) - cells / 2;
  const auto any_key = [&] {
    return WideKey{lowest + random() % cells, lowest + random() % cells, lowest + random() % cells};
  };
  std::array<std::size_t, 3> seen{};
  for (int round = 0; round < 200; ++round) {
    const WideKey key = any_key();
    const std::array beliefs{LogOdds(-2.0F), lower, LogOdds(0.0F), upper, LogOdds(3.0F)};
    map.edit().set(key, depth - (depth > 3 ? static_cast<int>(random() % 3) : 0), beliefs[random() % beliefs.size()]);
    for (int i = 0; i < 50; ++i) {
      const WideKey asked = any_key();
      const auto belief = map.at(asked);
      const Occupancy expected = belief ? classify(*belief, map.options().thresholds) : Occupancy::kUnknown;
      ASSERT_EQ(map.classify(asked), expected);
      with_key_word(depth, [&]<KeyWord W>() { ASSERT_EQ(map.classify(asked.as<W>()), expected); });
      ++seen[static_cast<std::size_t>(expected)];
    }
  }
  for (const std::size_t times : seen) EXPECT_GT(times, 200U);
}

INSTANTIATE_TEST_SUITE_P(AllKeyWidths, OccupancyMapAtDepth, testing::ValuesIn(kDepths));

}  // namespace
