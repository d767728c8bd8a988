#include <gtest/gtest.h>

#include <random>
#include <span>
#include <vector>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/scan_update.hpp"
#include "support/differences.hpp"
#include "support/oracle_map.hpp"

using namespace pingvox;
using test::first_difference;
using test::nodes_of;

namespace {

/// A random box, freed as a whole or in part, and some hits.
ScanUpdate random_scan(std::mt19937_64& random, const Lattice& lattice) {
  const int depth = lattice.depth();
  ScanUpdate scan(lattice, LogOdds(-3.0F));
  const WideWord reach = std::min<WideWord>(test::highest_word(depth), 255);
  const auto word = [&] { return static_cast<WideWord>(random()) & reach; };
  const WideKey corner{word(), word(), word()};
  const WideWord edge = 1 + random() % 20;
  const bool frees_all = random() % 2 == 0;
  for (WideWord x = 0; x < edge; ++x) {
    for (WideWord y = 0; y < edge; ++y) {
      for (WideWord z = 0; z < edge; ++z) {
        if (!frees_all && random() % 4 == 0) continue;
        scan.add_miss(WideKey{(corner.x + x) & reach, (corner.y + y) & reach, (corner.z + z) & reach});
      }
    }
  }
  for (std::uint64_t i = random() % 20; i > 0; --i) scan.add_hit(WideKey{word(), word(), word()}, LogOdds(0.85F));
  return scan;
}

TEST(MemoryLimit, IsNeverPassedAndARefusedScanChangesNothing) {
  std::size_t taken = 0, refused = 0;
  for (const int depth : {1, 2, 3, 8, 16, 64, 128}) {
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
      SCOPED_TRACE(testing::Message() << depth << " levels, seed " << seed);
      std::mt19937_64 random(seed);
      const std::size_t limit = 300 + random() % (std::size_t{1} << (9 + seed / 2 % 10));
      OccupancyMap map({.resolution_m = 1.0, .depth = depth, .memory_limit_bytes = limit});
      for (int i = 0; i < 20; ++i) {
        const ScanUpdate scan = random_scan(random, map.lattice());
        const auto before = nodes_of(map);
        const std::size_t bytes_before = map.memory_bytes();
        const auto report = map.apply(scan);
        ASSERT_LE(map.memory_bytes(), limit);
        if (report) {
          ++taken;
          continue;
        }
        ++refused;
        ASSERT_EQ(report.error().code, Error::Code::kLimit);
        ASSERT_EQ(first_difference(nodes_of(map), before), "");
        ASSERT_EQ(map.memory_bytes(), bytes_before);
      }
    }
  }
  EXPECT_GT(taken, 500U);
  EXPECT_GT(refused, 500U);
}

TEST(MemoryLimit, LetsAFullMapTakeInWhatItKnowsAlready) {
  OccupancyMap map({.memory_limit_bytes = 200'000});
  ScanUpdate scan(map.lattice(), LogOdds(-5.0F));
  for (std::uint16_t x = 0; x < 64; ++x) {
    for (std::uint16_t y = 0; y < 64; ++y) {
      for (std::uint16_t z = 0; z < 33; ++z) scan.add_miss(Key{x, y, z});
    }
  }
  ASSERT_TRUE(map.apply(scan));  // becomes a few joined cells
  bool is_full = false;
  for (std::uint16_t i = 0; i < 10'000 && !is_full; ++i) {
    ScanUpdate more(map.lattice());
    more.add_hit(Key{static_cast<std::uint16_t>(i * 4), 40'000, 0}, LogOdds(1.0F));
    is_full = !map.apply(more);
  }
  EXPECT_TRUE(is_full);
  EXPECT_TRUE(map.apply(scan)) << "nothing changes, so nothing is needed";
}

// Kills a brick that is foreseen once for each time that a counter of the batch was full.
TEST(MemoryLimit, LetsABatchTakeInTheSameCellAgainAndAgain) {
  OccupancyMap map({.memory_limit_bytes = 4'000});
  const std::vector<Key> keys(1'000'000, Key{40'000, 40'001, 40'002});
  ASSERT_TRUE(map.update(std::span<const Key>(keys), LogOdds(0.001F)));
  EXPECT_LE(map.memory_bytes(), 4'000U);
}

TEST(MemoryLimit, HoldsForMergesToo) {
  std::size_t taken = 0, refused = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const std::size_t limit = 10'000 + random() % 60'000;
    OccupancyMap map({.memory_limit_bytes = limit}), other;
    (void)map.apply(random_scan(random, map.lattice()));
    ASSERT_TRUE(other.apply(random_scan(random, map.lattice())));
    const auto before = nodes_of(map);
    const auto merged = map.merge(other);
    ASSERT_LE(map.memory_bytes(), limit);
    if (merged) {
      ++taken;
      continue;
    }
    ++refused;
    ASSERT_EQ(merged.error().code, Error::Code::kLimit);
    ASSERT_EQ(first_difference(nodes_of(map), before), "");
  }
  EXPECT_GT(taken, 10U);
  EXPECT_GT(refused, 10U);
}

TEST(MemoryLimit, StorageOfJoinedCellsIsUsedAgain) {
  OccupancyMap map;
  std::size_t most = 0;
  for (int round = 0; round < 50; ++round) {
    ScanUpdate some(map.lattice(), LogOdds(-5.0F)), all(map.lattice(), LogOdds(round % 2 == 0 ? -9.0F : -8.0F));
    for (std::uint16_t x = 0; x < 32; ++x) {
      for (std::uint16_t y = 0; y < 32; ++y) {
        for (std::uint16_t z = 0; z < 32; ++z) {
          if ((x + y + z) % 3 == 0) some.add_hit(Key{x, y, z}, LogOdds(1.0F));
          all.add_miss(Key{x, y, z});
        }
      }
    }
    ASSERT_TRUE(map.apply(some));
    if (round == 0) most = map.memory_bytes();
    ASSERT_EQ(map.memory_bytes(), most);
    ASSERT_TRUE(map.apply(all));
    ASSERT_EQ(map.counts().leaves, 1U);
  }
}

}  // namespace
