#include "web/live_cells.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "pingvox/map/scan_update.hpp"
#include "web/following_client.hpp"
#include "web/page_columns.hpp"

namespace pingvox::web {
namespace {

using test::FollowingClient;
using test::read_cells;

/// Marks cells in a cube around the origin, or, now and then, far from it.
ScanUpdate random_scan(const OccupancyMap& map, std::mt19937_64& random) {
  ScanUpdate scan(map.lattice());
  const auto middle = static_cast<std::uint32_t>(1) << (map.lattice().depth() - 1);
  const auto place = [&] { return static_cast<std::uint32_t>(middle - 20 + random() % 40); };
  const LogOdds hit = LogOdds::from_probability(0.55 + 0.01 * static_cast<double>(random() % 40));
  const bool clears = random() % 4 == 0;
  for (int i = 0; i < 60; ++i) {
    const BasicKey<std::uint32_t> key{place(), place(), place()};
    random() % (clears ? 10 : 2) == 0 ? scan.add_hit(key, hit) : scan.add_miss(key);
  }
  if (clears) {  // a whole cube, which becomes a leaf
    for (std::uint32_t cell = 0; cell < 4096; ++cell) {
      scan.add_miss(BasicKey<std::uint32_t>{middle + cell % 16, middle + cell / 16 % 16, middle + cell / 256});
    }
  }
  return scan;
}

MapOptions random_options(std::mt19937_64& random) {
  MapOptions options{.resolution_m = 0.1, .depth = random() % 2 == 0 ? 16 : 7};
  options.parents = random() % 2 == 0 ? Parents::kMax : Parents::kMean;
  return options;
}

TEST(LiveCells, FollowedAtAnyTimesAreThoseOfTheMap) {
  std::size_t compared = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    OccupancyMap map(random_options(random));
    LiveCells live(map);
    ChangedPages pages;
    FollowingClient often, seldom;
    often.take(live.all());
    for (int i = 0; i < 40; ++i) {
      const ScanUpdate scan = random_scan(map, random);
      pages.add(scan);
      ASSERT_TRUE(map.apply(scan));
      if (random() % 20 == 0) {  // another map takes its place
        map = OccupancyMap(map.options());
        ASSERT_TRUE(map.apply(random_scan(map, random)));
        pages.add_all();
      }
      if (random() % 3 == 0) continue;
      const Result<CellChanges> changes = changed_cells(map, pages.take());
      ASSERT_TRUE(changes);
      live.apply(*changes);
      often.take(live.since(often.version()));
      if (random() % 6 == 0) seldom.take(live.since(seldom.version()));
      const auto wanted = read_cells(*cells_bytes(map)).probability;
      EXPECT_EQ(often.cells(), wanted);
      EXPECT_EQ(live.cells(), wanted.size());
      compared += wanted.size();
    }
    const Result<CellChanges> last = changed_cells(map, pages.take());
    ASSERT_TRUE(last);
    live.apply(*last);
    seldom.take(live.since(seldom.version()));
    FollowingClient fresh;
    fresh.take(live.all());
    const auto wanted = read_cells(*cells_bytes(map)).probability;
    EXPECT_EQ(seldom.cells(), wanted);
    EXPECT_EQ(fresh.cells(), wanted);
  }
  EXPECT_GT(compared, 10'000U);
}

TEST(LiveCells, SendsWhatHasChangedAlone) {
  OccupancyMap map({.resolution_m = 0.1});
  LiveCells live(map);
  ChangedPages pages;
  const auto hit = [&](std::uint16_t x) {
    ScanUpdate scan(map.lattice());
    scan.add_hit(Key{x, 32768, 32768}, LogOdds::from_probability(0.7));
    pages.add(scan);
    ASSERT_TRUE(map.apply(scan));
    live.apply(*changed_cells(map, pages.take()));
  };
  hit(32768);
  FollowingClient client;
  client.take(live.since(0));
  const std::uint32_t before = live.version();
  hit(33000);
  EXPECT_GT(live.version(), before);
  client.take(live.since(client.version()));
  EXPECT_EQ(client.bricks_taken(), 1U);
  EXPECT_EQ(client.cells().size(), 2U);
  client.take(live.since(client.version()));
  EXPECT_EQ(client.bricks_taken(), 0U);

  // A scan that changes nothing that is seen is no version.
  for (int i = 0; i < 20; ++i) hit(33000);
  const std::uint32_t clamped = live.version();
  hit(33000);
  EXPECT_EQ(live.version(), clamped);
  client.take(live.since(clamped + 100));
  EXPECT_EQ(client.cells().size(), 2U) << "of a version that there is not: all";
}

TEST(LiveCells, LeafLargerThanAPageIsSent) {
  OccupancyMap map({.resolution_m = 0.1, .depth = 8});
  map.edit().set(BasicKey<std::uint16_t>{128, 128, 128}, 3, LogOdds::from_probability(0.9));
  LiveCells live(map);
  live.apply(*changed_cells(map, {.all = true, .lowest = {}}));
  FollowingClient client;
  client.take(live.all());
  EXPECT_EQ(client.cells(), read_cells(*cells_bytes(map)).probability);
  EXPECT_EQ(client.cells().size(), 32768U);
}

}  // namespace
}  // namespace pingvox::web
