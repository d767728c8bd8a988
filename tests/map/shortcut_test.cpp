#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <span>
#include <vector>

#include "map/map_access.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/scan_update.hpp"
#include "support/oracle_map.hpp"

using namespace pingvox;
using detail::BrickTree;
using detail::Entry;
using detail::MapAccess;
using detail::Shortcut;

namespace {

/// Cells near a corner that moves now and then: of the lattice's middle, where eight nodes have only the root in
/// common, of its borders, and anywhere.
class Region {
 public:
  Region(int depth, std::mt19937_64& random) : random_(random), highest_(test::highest_word(depth)) { move(); }

  void move() {
    for (WideWord& word : corner_) {
      const std::array<WideWord, 4> places{highest_ / 2 + 1, 0, highest_, any()};
      word = places[random_() % 3 == 0 ? random_() % 4 : 0];
    }
    reach_ = (WideWord{1} << (random_() % 10)) - 1;
  }
  /// Mostly within reach of the corner, to both sides of it.
  WideKey key() {
    const WideWord reach = random_() % 16 == 0 ? 4 * reach_ + 3 : reach_;
    return {near(corner_[0], reach), near(corner_[1], reach), near(corner_[2], reach)};
  }
  WideKey any_key() { return {any(), any(), any()}; }

 private:
  WideWord any() { return (WideWord{random_()} << 64 | random_()) & highest_; }
  WideWord near(WideWord word, WideWord reach) {
    const WideWord off = random_() & reach;
    return (random_() % 2 == 0 ? word + off : word - off) & highest_;
  }

  std::mt19937_64& random_;
  WideWord highest_, reach_ = 0;
  std::array<WideWord, 3> corner_{};
};

/// A map under random changes; look-ups are compared with `node_at`, which goes down from the root.
class LookUps {
 public:
  LookUps(int depth, std::uint64_t seed) : random_(seed), region_(depth, random_), map_(options(depth)) {
    MapAccess::set_early_drop(map_, random_() % 2 == 0 ? EarlyDrop::kOn : EarlyDrop::kOff);
  }

  void step() {
    if (random_() % 4 == 0) region_.move();
    switch (random_() % 10) {
      case 0:
      case 1:
      case 2:
        return edit();
      case 3:
        return fill_cube();
      case 4:
        return random_() % 4 == 0 ? scan_cube() : scan();
      case 5:
        return batch();
      case 6:
        return merge();
      case 7:
        return copy();
      case 8:
        return reload();
      default:
        if (random_() % 4 == 0) return map_.clear();
        return move();
    }
  }

  /// Between changes.
  void check() {
    const BrickTree& tree = MapAccess::tree(map_);
    const std::optional<Shortcut> best = shortcut_of(tree);
    ASSERT_EQ(tree.shortcut.has_value(), best.has_value());
    if (best) {
      ASSERT_EQ(tree.shortcut->level, best->level);
      ASSERT_EQ(tree.shortcut->lowest, best->lowest);
      for (std::size_t i = 0; i < 8; ++i) {
        ASSERT_EQ(tree.shortcut->node[i].link, best->node[i].link);
        if (best->node[i].is_leaf()) {
          ASSERT_EQ(tree.shortcut->node[i], best->node[i]);
        }
      }
      ++shortcuts_;
    }
    ASSERT_NO_FATAL_FAILURE(look_up(60));
  }

  std::size_t shortcuts() const { return shortcuts_; }
  std::size_t known() const { return known_; }
  std::size_t refused() const { return refused_; }

 private:
  MapOptions options(int depth) {
    MapOptions options{.depth = depth};
    options.parents = random_() % 2 == 0 ? Parents::kMax : Parents::kMean;
    if (random_() % 4 == 0) options.memory_limit_bytes = std::size_t{1} << (10 + random_() % 10);
    return options;
  }

  template <KeyWord W>
  void look_up(const BasicKey<W>& key, const std::optional<NodeView>& node) {
    const auto belief = map_.at(key);
    ASSERT_EQ(belief.has_value(), node.has_value());
    if (node) {
      ASSERT_EQ(*belief, node->belief());
    }
    ASSERT_EQ(map_.classify(key), node ? classify(node->belief(), map_.options().thresholds) : Occupancy::kUnknown);
  }

  void look_up(int times) {
    for (int i = 0; i < times; ++i) {
      const WideKey key = i % 8 == 0 ? region_.any_key() : region_.key();
      const auto node = map_.node_at(key, map_.lattice().depth());
      known_ += node.has_value() ? 1 : 0;
      ASSERT_NO_FATAL_FAILURE(look_up(key, node));
      with_key_word(map_.lattice().depth(), [&]<KeyWord W>() { look_up(key.as<W>(), node); });
      if (testing::Test::HasFatalFailure()) return;
    }
  }

  LogOdds evidence() { return LogOdds(random_() % 2 == 0 ? 4.0F : random_() % 2 == 0 ? -4.0F : -0.4F); }

  // Leaves of any size: what hung below them is freed, and soon used again.
  void edit() {
    Editor editor = map_.edit(static_cast<Pruning>(random_() % 3));
    for (std::uint64_t i = 1 + random_() % 30; i > 0; --i) {
      if (random_() % 8 == 0) {
        const int up = static_cast<int>(random_() % (random_() % 8 == 0 ? 200 : 12));
        editor.set(region_.key(), std::max(0, map_.lattice().depth() - up), evidence());
      } else {
        editor.update(region_.key(), evidence());
      }
      ASSERT_NO_FATAL_FAILURE(look_up(6));
      if (random_() % 8 == 0) editor.synchronize();
    }
  }

  // Until its nodes are one leaf, cell by cell.
  void fill_cube() {
    const WideWord inside = (WideWord{1} << (2 + random_() % 3)) - 1;
    const WideKey some = region_.key();
    Editor editor = map_.edit(static_cast<Pruning>(random_() % 3));
    for_each_in_cube(some, inside, [&](const WideKey& key) { editor.update(key, LogOdds(4.0F)); });
    look_up(20);
  }

  /// Calls f(key) for the cells of the cube of inside + 1 cells along each axis that holds a key.
  template <class F>
  void for_each_in_cube(const WideKey& some, WideWord inside, F&& f) const {
    const WideWord used = test::highest_word(map_.lattice().depth());
    for (WideWord i = 0; i <= inside; ++i) {
      for (WideWord j = 0; j <= inside; ++j) {
        for (WideWord k = 0; k <= inside; ++k) {
          f(WideKey{((some.x & ~inside) + i) & used, ((some.y & ~inside) + j) & used, ((some.z & ~inside) + k) & used});
        }
      }
    }
  }

  void scan() {
    ScanUpdate scan(map_.lattice(), LogOdds(-4.0F));
    for (std::uint64_t i = random_() % 200; i > 0; --i) {
      scan.add_miss(region_.key());
      scan.add_hit(region_.key(), LogOdds(0.8F));
    }
    refused_ += map_.apply(scan) ? 0 : 1;
  }

  // Pages become leaves, and these others, at once.
  void scan_cube() {
    const WideKey some = region_.key();
    for (const LogOdds miss : {LogOdds(-0.5F), LogOdds(-0.25F)}) {
      ScanUpdate scan(map_.lattice(), miss);
      for_each_in_cube(some, 31, [&](const WideKey& key) { scan.add_miss(key); });
      refused_ += map_.apply(scan) ? 0 : 1;
      ASSERT_NO_FATAL_FAILURE(check());
    }
  }

  void batch() {
    std::vector<WideKey> keys;
    for (std::uint64_t i = random_() % 200; i > 0; --i) keys.push_back(region_.key());
    refused_ += map_.update(std::span<const WideKey>(keys), evidence()) ? 0 : 1;
  }

  void merge() {
    OccupancyMap other(map_.options());
    std::swap(map_, other);
    fill_cube();
    region_.move();
    edit();
    std::swap(map_, other);
    refused_ += map_.merge(other) ? 0 : 1;
  }

  void copy() {
    OccupancyMap copied(map_);
    std::swap(copied, map_);
    copied.clear();
    ASSERT_NO_FATAL_FAILURE(check());
    edit();
    copied = map_;
    map_.clear();
    ASSERT_NO_FATAL_FAILURE(check());
    map_ = copied;
  }

  void move() {
    OccupancyMap moved(std::move(map_));
    map_ = std::move(moved);
  }

  // As readers do, who know nothing of shortcuts.
  void reload() {
    refused_ += map_.apply(ScanUpdate(map_.lattice())) ? 0 : 1;  // either way it is pruned
    OccupancyMap loaded(map_.options());
    {
      Editor editor = loaded.edit();
      for_each_leaf(map_, {}, [&](const Leaf& leaf) { editor.set(leaf.key, leaf.depth, leaf.belief); });
    }
    map_ = std::move(loaded);
  }

  std::mt19937_64 random_;
  Region region_;
  OccupancyMap map_;
  std::size_t shortcuts_ = 0, known_ = 0, refused_ = 0;
};

TEST(Shortcut, IsNeverOfAnotherTreeThanTheOneLookedUp) {
  std::size_t shortcuts = 0, known = 0, refused = 0;
  for (const int depth : {1, 2, 3, 4, 5, 16, 20, 32, 63, 64, 65, 100, 128}) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      SCOPED_TRACE(testing::Message() << depth << " levels, seed " << seed);
      LookUps look_ups(depth, seed);
      for (int step = 0; step < 30; ++step) {
        ASSERT_NO_FATAL_FAILURE(look_ups.step());
        ASSERT_NO_FATAL_FAILURE(look_ups.check());
      }
      shortcuts += look_ups.shortcuts();
      known += look_ups.known();
      refused += look_ups.refused();
    }
  }
  EXPECT_GT(shortcuts, 1'000U);
  EXPECT_GT(known, 100'000U);
  EXPECT_GT(refused, 50U);
}

OccupancyMap map_of(int depth, std::span<const WideKey> keys) {
  OccupancyMap map({.depth = depth});
  EXPECT_TRUE(map.update(keys, LogOdds(0.8F)));
  return map;
}

TEST(Shortcut, LeadsToEightNodesThatAreNoWiderThanTheMap) {
  constexpr WideWord kMiddle = 32768;
  const std::vector<WideKey> around_the_middle{{kMiddle - 60, kMiddle - 60, kMiddle - 60},
                                               {kMiddle + 60, kMiddle + 60, kMiddle + 60}};
  const OccupancyMap middle = map_of(16, around_the_middle);
  ASSERT_TRUE(MapAccess::tree(middle).shortcut);
  EXPECT_EQ(MapAccess::tree(middle).shortcut->level, 6);
  EXPECT_EQ(MapAccess::tree(middle).shortcut->lowest, (BasicKey<std::uint64_t>{511, 511, 511}));

  const std::vector<WideKey> at_the_border{{65535, 0, 127}, {65520, 15, 128}};
  const OccupancyMap border = map_of(16, at_the_border);
  ASSERT_TRUE(MapAccess::tree(border).shortcut);
  EXPECT_EQ(MapAccess::tree(border).shortcut->level, 4);
  EXPECT_EQ(MapAccess::tree(border).shortcut->lowest, (BasicKey<std::uint64_t>{4095, 0, 7}));
  EXPECT_EQ(border.at(WideKey{65535, 0, 127}), LogOdds(0.8F));
  EXPECT_EQ(border.at(WideKey{0, 0, 127}), std::nullopt);

  const std::vector<WideKey> far_apart{{0, 0, 0}, {65535, 65535, 65535}};
  const OccupancyMap whole = map_of(16, far_apart);
  ASSERT_TRUE(MapAccess::tree(whole).shortcut);
  EXPECT_EQ(MapAccess::tree(whole).shortcut->level, 15);
}

TEST(Shortcut, IsNoneWhereItLeadsNowhere) {
  EXPECT_FALSE(MapAccess::tree(OccupancyMap({.depth = 16})).shortcut);
  OccupancyMap one_leaf({.depth = 16});
  one_leaf.edit().set(WideKey{}, 0, LogOdds(1.0F));
  EXPECT_FALSE(MapAccess::tree(one_leaf).shortcut);
  const std::vector<WideKey> keys{{0, 0, 0}};
  for (const int depth : {1, 2, 3, 4, 65, 128}) EXPECT_FALSE(MapAccess::tree(map_of(depth, keys)).shortcut);
  for (const int depth : {5, 64}) EXPECT_TRUE(MapAccess::tree(map_of(depth, keys)).shortcut);

  // What may be left where memory ran out between making a group and what it is for.
  BrickTree tree(16);
  tree.root = {tree.groups.allocate({}), 0.0F};
  EXPECT_FALSE(shortcut_of(tree));
  detail::Group group;
  group.child[7] = tree.root;
  tree.root = {tree.groups.allocate(group), 0.0F};
  ASSERT_TRUE(shortcut_of(tree));
  EXPECT_EQ(shortcut_of(tree)->level, 15);
}

TEST(Shortcut, StaysWhileOnlyWhatIsBelowChanges) {
  OccupancyMap map({.depth = 16});
  {
    Editor editor = map.edit();
    editor.update(Key{32700, 32700, 32700}, LogOdds(0.8F));
    editor.update(Key{32800, 32800, 32800}, LogOdds(0.8F));
    EXPECT_FALSE(MapAccess::tree(map).shortcut);  // no parent has its value yet
  }
  Editor editor = map.edit(Pruning::kEachUpdate);
  ASSERT_TRUE(MapAccess::tree(map).shortcut);
  editor.update(Key{32701, 32701, 32731}, LogOdds(0.8F));
  EXPECT_TRUE(MapAccess::tree(map).shortcut);
  editor.update(Key{32700, 32800, 32700}, LogOdds(0.8F));
  EXPECT_FALSE(MapAccess::tree(map).shortcut);
  EXPECT_EQ(map.at(Key{32700, 32800, 32700}), LogOdds(0.8F));
  editor.synchronize();
  EXPECT_TRUE(MapAccess::tree(map).shortcut);
}

}  // namespace
