#include "map/key_batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "pingvox/map/occupancy_map.hpp"
#include "support/differences.hpp"

namespace pingvox::detail {
namespace {

using Place = std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>;

/// Of the keys of a width that fit into a batch, or a little less.
template <KeyWord W>
std::uint64_t middle_of_range() {
  return std::min<std::uint64_t>((std::uint64_t{1} << 20) - 1, std::numeric_limits<W>::max()) / 2;
}

/// Keys in a cube of `edge` cells, in no order; some of them again and again, some far away.
template <KeyWord W>
std::vector<BasicKey<W>> random_keys(std::mt19937_64& random, std::size_t count, std::uint64_t edge) {
  std::vector<BasicKey<W>> keys;
  const std::uint64_t most = 2 * middle_of_range<W>() + 1;
  const auto word = [&](std::uint64_t among) {
    return static_cast<W>((middle_of_range<W>() + random() % among) & most);
  };
  while (keys.size() < count) {
    const std::uint64_t kind = random() % 1000;
    const BasicKey<W> key =
        kind == 0 ? BasicKey<W>{word(most), word(most), word(most)} : BasicKey<W>{word(edge), word(edge), word(edge)};
    const std::uint64_t times = kind == 1 ? 1 + random() % 700 : (kind == 2 ? 512 : 1);  // a counter has a byte
    keys.insert(keys.end(), times, key);
  }
  keys.resize(count);
  return keys;
}

std::map<Place, std::uint64_t> take_all(KeyBatch& batch) {
  std::map<Place, std::uint64_t> times;
  batch.take([&](const BasicKey<std::uint64_t>& lowest, const KeyBatch::Cells& cells) {
    EXPECT_EQ((lowest.x | lowest.y | lowest.z) & 3, 0U);
    EXPECT_EQ(cells.more & ~cells.once, 0U);
    for (std::uint64_t left = cells.once; left != 0; left &= left - 1) {
      const auto cell = static_cast<std::uint64_t>(std::countr_zero(left));
      const BasicKey<std::uint64_t> at = key_of_code(cell);
      times[{lowest.x + at.x, lowest.y + at.y, lowest.z + at.z}] +=
          ((cells.more >> cell) & 1) != 0 ? cells.times[cell] : 1;
    }
  });
  return times;
}

// Kills a key that is counted in another cell, or not where its counter is full, it lies outside of the window or fills
// no whole block; counts that are left for the next batch; a byte taken for another one.
TEST(KeyBatch, TellsHowOftenEachCellIsNamed) {
  KeyBatch batch;
  std::size_t often = 0, outside = 0, cells = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const std::size_t count = seed % 4 == 0 ? 1000 : KeyBatch::kWorthAWindow + random() % 20'000;
    const std::uint64_t edge = seed % 3 == 0 ? 400 : 5 + random() % 100;
    const auto expect_counts = [&]<KeyWord W>() {
      const std::vector<BasicKey<W>> keys = random_keys<W>(random, count, edge);
      std::map<Place, std::uint64_t> expected;
      for (const BasicKey<W>& key : keys) ++expected[{key.x, key.y, key.z}];
      batch.gather(std::span<const BasicKey<W>>(keys));
      ASSERT_EQ(take_all(batch), expected);
      const std::uint64_t middle = middle_of_range<W>();
      for (const auto& [place, times] : expected) {
        often += times > 255 ? 1 : 0;
        outside += count > KeyBatch::kWorthAWindow && std::get<0>(place) + 1000 < middle ? 1 : 0;
      }
      cells += expected.size();
    };
    expect_counts.operator()<std::uint8_t>();
    expect_counts.operator()<std::uint16_t>();
    expect_counts.operator()<std::uint32_t>();
  }
  EXPECT_GT(often, 100U);
  EXPECT_GT(outside, 100U);
  EXPECT_GT(cells, 100'000U);
}

// Kills evidence that is added once for a cell that is named twice, or in another order than one by one.
TEST(KeyBatch, MakesTheMapOfSingleUpdates) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    OccupancyMap at_once({.resolution_m = 0.1}), one_by_one({.resolution_m = 0.1});
    for (const LogOdds evidence : {LogOdds(0.01F), LogOdds(-0.7F), LogOdds(0.85F)}) {
      const std::vector<Key> keys = random_keys<std::uint16_t>(random, 40'000, 20 + 30 * seed);
      ASSERT_TRUE(at_once.update(std::span<const Key>(keys), evidence));
      Editor editor = one_by_one.edit();
      for (const Key& key : keys) editor.update(key, evidence);
    }
    ASSERT_EQ(test::first_difference(test::nodes_of(at_once), test::nodes_of(one_by_one)), "");
  }
}

}  // namespace
}  // namespace pingvox::detail
