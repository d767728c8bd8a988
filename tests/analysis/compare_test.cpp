#include "pingvox/analysis/compare.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <utility>

namespace pingvox {
namespace {

MapOptions at_depth(int depth) {
  MapOptions options;
  options.resolution_m = 1.0;
  options.depth = depth;
  return options;
}

/// What compare_maps must say, from plain lists of cells.
MapComparison oracle(const std::map<WideKey, float>& a, const std::map<WideKey, float>& b, Sameness sameness) {
  MapComparison out;
  for (const auto& [key, belief] : a) {
    const auto other = b.find(key);
    if (other == b.end()) {
      ++out.only_a;
      continue;
    }
    const bool same = sameness == Sameness::kLogOdds ? belief == other->second
                                                     : classify(LogOdds(belief)) == classify(LogOdds(other->second));
    ++(same ? out.same : out.different);
    out.max_log_odds_difference =
        std::max(out.max_log_odds_difference, std::abs(double{belief} - double{other->second}));
  }
  for (const auto& entry : b) out.only_b += a.contains(entry.first) ? 0 : 1;
  return out;
}

/// Sets random cubes in a map and in its list of cells.
void scribble(std::mt19937_64& random, OccupancyMap& map, std::map<WideKey, float>& cells) {
  const int depth = map.lattice().depth();
  const int small = std::min(depth, 4);  // cubes and coordinates stay where lists of cells are short
  Editor editor = map.edit();
  for (int i = 0; i < 30; ++i) {
    const int up = static_cast<int>(random() % 3) % (small + 1);
    const WideWord edge = WideWord{1} << up;
    const auto coordinate = [&] { return static_cast<WideWord>(random() % (1U << small)) / edge * edge; };
    const WideKey lowest{coordinate(), coordinate(), coordinate()};
    const float belief = static_cast<float>(static_cast<int>(random() % 4)) - 1.5F;
    editor.set(lowest, depth - up, LogOdds(belief));
    for (WideWord x = 0; x < edge; ++x) {
      for (WideWord y = 0; y < edge; ++y) {
        for (WideWord z = 0; z < edge; ++z) cells[{lowest.x + x, lowest.y + y, lowest.z + z}] = belief;
      }
    }
  }
}

TEST(CompareMaps, CountsLikeListsOfCellsWhateverWasPruned) {
  std::size_t compared = 0;
  for (const int depth : {1, 2, 3, 5, 16, 33, 128}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE(depth);
      SCOPED_TRACE(seed);
      std::mt19937_64 random(seed);
      OccupancyMap a(at_depth(depth)), b(at_depth(depth));
      std::map<WideKey, float> cells_a, cells_b;
      scribble(random, a, cells_a);
      scribble(random, b, cells_b);
      for (const Sameness sameness : {Sameness::kLogOdds, Sameness::kOccupancy}) {
        const auto result = compare_maps(a, b, sameness);
        ASSERT_TRUE(result);
        const MapComparison expected = oracle(cells_a, cells_b, sameness);
        EXPECT_EQ(result->same, expected.same);
        EXPECT_EQ(result->different, expected.different);
        EXPECT_EQ(result->only_a, expected.only_a);
        EXPECT_EQ(result->only_b, expected.only_b);
        EXPECT_EQ(result->max_log_odds_difference, expected.max_log_odds_difference);
        EXPECT_EQ(result->equal(), cells_a == cells_b || (result->different + result->only_a + result->only_b == 0));
        compared += result->cells();
      }
    }
  }
  EXPECT_GT(compared, 50'000U);
}

// Kills a map that is classified by the thresholds of the other.
TEST(CompareMaps, ClassifiesEachMapByItsOwnThresholds) {
  MapOptions undecided = at_depth(16);
  undecided.thresholds = {.lower = LogOdds(-1.0F), .upper = LogOdds(1.0F)};
  OccupancyMap one(at_depth(16)), two(undecided);
  for (const float belief : {-2.0F, -0.5F, 0.5F, 2.0F}) {
    const WideKey key{static_cast<WideWord>(10.0F + 2.0F * belief), 0, 0};
    one.edit().set(key, 16, LogOdds(belief));
    two.edit().set(key, 16, LogOdds(belief));
  }
  for (const auto& result :
       {compare_maps(one, two, Sameness::kOccupancy), compare_maps(two, one, Sameness::kOccupancy)}) {
    ASSERT_TRUE(result);
    EXPECT_EQ(result->same, 2U);
    EXPECT_EQ(result->different, 2U);
  }
}

TEST(CompareMaps, AMapEqualsItsCopy) {
  std::mt19937_64 random(7);
  OccupancyMap map(at_depth(16));
  std::map<WideKey, float> cells;
  scribble(random, map, cells);
  const auto result = compare_maps(map, OccupancyMap(map), Sameness::kLogOdds);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->equal());
  EXPECT_EQ(result->cells(), cells.size());
}

TEST(CompareMaps, TwoEmptyMapsAreTheSame) {
  const auto result = compare_maps(OccupancyMap(at_depth(16)), OccupancyMap(at_depth(16)), Sameness::kLogOdds);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->equal());
  EXPECT_EQ(result->cells(), 0U);
}

TEST(CompareMaps, ManyCellsSaturateInsteadOfWrapping) {
  OccupancyMap a(at_depth(40)), b(at_depth(40));
  a.edit().set(WideKey{}, 0, LogOdds(1.0F));
  b.edit().set(WideKey{}, 1, LogOdds(1.0F));
  const auto result = compare_maps(a, b, Sameness::kLogOdds);
  ASSERT_TRUE(result);
  constexpr auto kMax = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(result->same, kMax);
  EXPECT_EQ(result->only_a, kMax);
  EXPECT_EQ(result->cells(), kMax);
}

TEST(CompareMaps, RefusesMapsOfDifferentCells) {
  const auto result = compare_maps(OccupancyMap(at_depth(16)), OccupancyMap(at_depth(15)), Sameness::kLogOdds);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Error::Code::kBadOption);
  EXPECT_NE(result.error().message.find("15 levels"), std::string::npos) << result.error().message;
}

}  // namespace
}  // namespace pingvox
