#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "differences.hpp"
#include "map/map_access.hpp"
#include "oracle_map.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/scan_update.hpp"

namespace pingvox::test {

/// Keys in small cubes at the places where a lattice may go wrong: its corners, its centre, and somewhere.
class Places {
 public:
  Places(int depth, std::mt19937_64& random) : random_(random), edge_(depth < 3 ? WideWord{1} << depth : 8) {
    const WideWord highest = highest_word(depth);
    if (depth <= 3) {
      corners_ = {WideKey{}};
      return;
    }
    const WideWord centre = (highest >> 1) - 3, last = highest - 7;
    const auto any = [&] { return (WideWord{random()} << 64 | random()) & highest & ~WideWord{7}; };
    corners_ = {WideKey{}, {last, last, last}, {centre, centre, centre}, {any(), any(), any()}, {0, centre, last}};
  }
  WideKey key() {
    const WideKey corner = cube();
    return {corner.x + random_() % edge_, corner.y + random_() % edge_, corner.z + random_() % edge_};
  }
  WideKey cube() { return corners_[random_() % corners_.size()]; }
  WideWord edge() const { return edge_; }

 private:
  std::mt19937_64& random_;
  WideWord edge_;
  std::vector<WideKey> corners_;
};

/// A map and its oracle under the same random operations.
class RandomOperations {
 public:
  /// Gives a map that holds the same: by way of a file, for instance.
  using Reload = std::function<OccupancyMap(const OccupancyMap&)>;

  /// @param reload  one more operation; none if empty
  RandomOperations(int depth, std::uint64_t seed, Reload reload = {})
      : random_(seed),
        places_(depth, random_),
        map_(options(depth)),
        oracle_(depth, map_.options().clamp),
        reload_(std::move(reload)),
        depth_(depth) {
    detail::MapAccess::set_early_drop(map_, random_() % 2 == 0 ? EarlyDrop::kOn : EarlyDrop::kOff);
  }

  void step() {
    switch (random_() % 13) {
      case 11:
        return batch();
      case 0:
      case 1:
        return edit_cells();
      case 2:
      case 3:
        return fill_cube();
      case 4:
      case 5:
      case 6:
        return scan();
      case 7:
        return set_cells();
      case 8:
        return merge();
      case 9:
        return copy();
      case 10:
        return reload_ && random_() % 2 == 0 ? reload() : move();
      default:
        if (random_() % 8 != 0) return scan();
        map_.clear();
        oracle_.cells.clear();
        is_pruned_ = true;
    }
  }

  void check() {
    std::vector<Node> expected = oracle_.nodes(map_.options().parents, OracleMap::Join::kEqualLeaves);
    compare_nodes(expected);
    compare_cells();
    if (!is_pruned_) return;
    ASSERT_EQ(first_difference(nodes_of(map_), expected), "");
    compare_counts(expected);
    compare_cuts();
    compare_boxes(expected);
    joined_ += static_cast<std::size_t>(std::count_if(
        expected.begin(), expected.end(), [&](const Node& node) { return node.is_leaf && node.depth < depth_; }));
  }

  std::size_t nodes_compared() const { return compared_; }
  std::size_t joined_leaves() const { return joined_; }

 private:
  MapOptions options(int depth) {
    MapOptions options{.resolution_m = 1.0, .depth = depth};
    options.parents = random_() % 2 == 0 ? Parents::kMax : Parents::kMean;
    options.thresholds = {LogOdds(-0.5F), LogOdds(0.5F)};
    return options;
  }

  // Few values, so that cells become equal; the clamps are reached in one to nine steps.
  LogOdds evidence() {
    constexpr std::array kProbabilities{0.7, 0.4, 0.95, 0.05, 0.5, 0.99};
    return LogOdds::from_probability(kProbabilities[random_() % kProbabilities.size()]);
  }

  Pruning pruning() {
    const auto mode = static_cast<Pruning>(random_() % 3);
    is_pruned_ = mode != Pruning::kNever;
    return mode;
  }

  void edit_cells() {
    Editor editor = map_.edit(pruning());
    for (std::uint64_t i = 1 + random_() % 60; i > 0; --i) {
      const WideKey key = places_.key();
      const LogOdds change = evidence();
      editor.update(key, change);
      oracle_.update(key, change);
      if (random_() % 30 == 0) {
        editor.synchronize();
        check();
      }
    }
  }

  void fill_cube() {
    std::vector<WideKey> keys;
    const WideWord edge = std::min<WideWord>(places_.edge(), WideWord{2} << (random_() % 3));
    const WideKey some = places_.key();
    const WideKey corner{some.x & ~(edge - 1), some.y & ~(edge - 1), some.z & ~(edge - 1)};
    for (WideWord x = 0; x < edge; ++x) {
      for (WideWord y = 0; y < edge; ++y) {
        for (WideWord z = 0; z < edge; ++z) keys.push_back({corner.x + x, corner.y + y, corner.z + z});
      }
    }
    if (random_() % 2 == 0) std::shuffle(keys.begin(), keys.end(), random_);
    if (random_() % 4 == 0) keys.pop_back();
    const LogOdds change = LogOdds::from_probability(random_() % 2 == 0 ? 0.99 : 0.02);
    const auto times = 1 + random_() % 2;  // at the latest the second one reaches the clamp
    Editor editor = map_.edit(pruning());
    for (std::uint64_t i = 0; i < times; ++i) {
      for (const WideKey& key : keys) {
        editor.update(key, change);
        oracle_.update(key, change);
      }
    }
  }

  void scan() {
    ScanUpdate scan(map_.lattice(), LogOdds::from_probability(random_() % 2 == 0 ? 0.4 : 0.05));
    OracleScan expected{scan.miss(), {}, {}};
    const WideKey cube = places_.cube();
    const bool frees_all = random_() % 3 == 0;
    for (WideWord x = 0; x < places_.edge(); ++x) {
      for (WideWord y = 0; y < places_.edge(); ++y) {
        for (WideWord z = 0; z < places_.edge(); ++z) {
          if (!frees_all && random_() % 8 != 0) continue;
          const WideKey key{cube.x + x, cube.y + y, cube.z + z};
          scan.add_miss(key);
          expected.missed.insert(key);
        }
      }
    }
    for (std::uint64_t i = random_() % 100; i > 0; --i) {
      const WideKey key = places_.key();
      const LogOdds change = evidence();
      if (random_() % 2 == 0) {
        scan.add_hit(key, change);
        expected.add_hit(key, change);
      } else {
        scan.add_miss(key);
        expected.missed.insert(key);
      }
    }
    const auto report = map_.apply(scan);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->cells_hit, expected.hit.size());
    for (const auto& [key, change] : expected.hit) expected.missed.erase(key);
    EXPECT_EQ(report->cells_freed, expected.missed.size());
    oracle_.apply(expected);
    is_pruned_ = true;
  }

  void batch() {
    std::vector<WideKey> keys;
    for (std::uint64_t i = random_() % 200; i > 0; --i) {
      keys.push_back(random_() % 3 == 0 && !keys.empty() ? keys[random_() % keys.size()] : places_.key());
    }
    const LogOdds change = evidence();
    ASSERT_TRUE(map_.update(std::span<const WideKey>(keys), change));
    for (const WideKey& key : keys) oracle_.update(key, change);
    is_pruned_ = true;
  }

  void set_cells() {
    Editor editor = map_.edit(pruning());
    for (std::uint64_t i = 1 + random_() % 12; i > 0; --i) {
      const WideKey key = places_.key();
      const LogOdds belief(static_cast<float>(random_() % 3) - 1.25F);
      const int depth = depth_ - static_cast<int>(random_() % static_cast<std::uint64_t>(std::min(depth_, 3) + 1));
      editor.set(key, depth, belief);
      oracle_.set(key, depth, belief);
      const WideKey next = places_.key();
      const LogOdds change = evidence();
      editor.update(next, change);
      oracle_.update(next, change);
    }
  }

  void merge() {
    OccupancyMap other(map_.options());
    OracleMap other_oracle(depth_, map_.options().clamp);
    std::swap(map_, other);
    std::swap(oracle_, other_oracle);
    fill_cube();
    edit_cells();
    if (random_() % 2 == 0) scan();
    std::swap(map_, other);
    std::swap(oracle_, other_oracle);
    ASSERT_TRUE(map_.merge(other));
    oracle_.merge(other_oracle);
    if (random_() % 8 == 0) {
      ASSERT_TRUE(map_.merge(map_));
      oracle_.merge(OracleMap(oracle_));
    }
    is_pruned_ = true;
  }

  void copy() {
    const std::vector<Node> before = nodes_of(map_);
    OccupancyMap copied(map_);
    EXPECT_EQ(first_difference(nodes_of(copied), before), "");
    {
      Editor editor = copied.edit();
      for (int i = 0; i < 20; ++i) editor.update(places_.key(), LogOdds::from_probability(0.95));
    }
    copied.clear();
    EXPECT_EQ(first_difference(nodes_of(map_), before), "") << "the copy is not independent";
    copied = map_;
    std::swap(copied, map_);
    const OccupancyMap& itself = map_;
    map_ = itself;
    copied.clear();
    EXPECT_EQ(first_difference(nodes_of(map_), before), "");
  }

  void move() {
    const std::vector<Node> before = nodes_of(map_);
    OccupancyMap moved(std::move(map_));
    EXPECT_EQ(first_difference(nodes_of(moved), before), "");
    map_ = std::move(moved);
    EXPECT_EQ(first_difference(nodes_of(map_), before), "");
  }

  void reload() {
    ASSERT_TRUE(map_.apply(ScanUpdate(map_.lattice())));  // files hold maps that are pruned
    is_pruned_ = true;
    map_ = reload_(map_);
  }

  void compare_nodes(const std::vector<Node>& expected) {
    for (const Node& node : expected) {
      const auto view = map_.node_at(node.key, node.depth);
      ASSERT_TRUE(view) << text_of(node);
      ASSERT_EQ(std::bit_cast<std::uint32_t>(view->belief().value()), node.bits) << text_of(node);
      ASSERT_EQ(view->depth(), node.depth);
      ++compared_;
      if (!is_pruned_) continue;
      ASSERT_EQ(view->is_leaf(), node.is_leaf) << text_of(node);
      if (node.is_leaf) {
        ASSERT_EQ(map_.node_at(node.key, depth_)->depth(), node.depth) << text_of(node);
      }
    }
    ASSERT_EQ(map_.empty(), expected.empty());
  }

  void compare_cells() {
    const auto same = [&](const WideKey& key, std::optional<float> belief) {
      const auto found = map_.at(key);
      ASSERT_EQ(found.has_value(), belief.has_value()) << text_of(key);
      const Occupancy occupancy = !belief             ? Occupancy::kUnknown
                                  : *belief >= 0.5F   ? Occupancy::kOccupied
                                  : !(*belief < -0.5) ? Occupancy::kUnknown
                                                      : Occupancy::kFree;
      ASSERT_EQ(map_.classify(key), occupancy);
      if (belief) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(found->value()), std::bit_cast<std::uint32_t>(*belief)) << text_of(key);
      }
    };
    for (const auto& [key, belief] : oracle_.cells) {
      ASSERT_NO_FATAL_FAILURE(same(key, belief));
      if (depth_ > 33) continue;
      const auto at_point = map_.at(map_.lattice().centre_of(key));
      ASSERT_TRUE(at_point && at_point->value() == belief);
    }
    for (int i = 0; i < 300; ++i) {
      const WideKey key = places_.key();
      const auto cell = oracle_.cells.find(key);
      ASSERT_NO_FATAL_FAILURE(
          same(key, cell == oracle_.cells.end() ? std::nullopt : std::optional<float>(cell->second)));
    }
  }

  void compare_counts(const std::vector<Node>& expected) {
    MapCounts counts;
    for (const Node& node : expected) ++(node.is_leaf ? counts.leaves : counts.inner);
    for (const auto& [key, belief] : oracle_.cells) {
      ++(belief >= 0.5F ? counts.occupied_cells : belief < -0.5F ? counts.free_cells : counts.undecided_cells);
    }
    const MapCounts found = map_.counts();
    EXPECT_EQ(found.leaves, counts.leaves);
    EXPECT_EQ(found.inner, counts.inner);
    EXPECT_EQ(found.occupied_cells, counts.occupied_cells);
    EXPECT_EQ(found.free_cells, counts.free_cells);
    EXPECT_EQ(found.undecided_cells, counts.undecided_cells);
  }

  std::vector<Node> leaves(const LeafQuery& query) const {
    std::vector<Node> found;
    for_each_leaf(map_, query, [&](const Leaf& leaf) {
      found.push_back({leaf.key, leaf.depth, true, std::bit_cast<std::uint32_t>(leaf.belief.value())});
    });
    return found;
  }

  static std::vector<Node> leaves_of(std::vector<Node> nodes) {
    nodes.erase(std::remove_if(nodes.begin(), nodes.end(), [](const Node& node) { return !node.is_leaf; }),
                nodes.end());
    return nodes;
  }

  void compare_cuts() {
    const Parents parents = map_.options().parents;
    for (const int depth : {0, depth_ / 2, depth_ - 2, depth_ - 1, depth_}) {
      if (depth < 0) continue;
      ASSERT_EQ(first_difference(leaves({.max_depth = depth, .box = {}}),
                                 leaves_of(oracle_.nodes(parents, OracleMap::Join::kEqualLeaves, depth))),
                "")
          << "cut at " << depth;
    }
  }

  /// Lowest and highest corner of a node [m]; cells are 1 m.
  Box box_of(const Node& node) const {
    const WideWord half = WideWord{1} << (depth_ - 1);
    const auto metres = [&](WideWord word) {
      return word >= half ? static_cast<double>(word - half) : -static_cast<double>(half - word);
    };
    const Eigen::Vector3d low(metres(node.key.x), metres(node.key.y), metres(node.key.z));
    return {low, low.array() + std::ldexp(1.0, depth_ - node.depth)};
  }

  void compare_boxes(const std::vector<Node>& expected) {
    const std::vector<Node> all = leaves_of(expected);
    const auto bounds = map_.bounds();
    ASSERT_EQ(bounds.has_value(), !all.empty());
    if (!bounds || depth_ > 33) return;  // deeper, the corners are no exact doubles
    Box around = box_of(all.front());
    for (const Node& leaf : all) {
      around.min = around.min.cwiseMin(box_of(leaf).min);
      around.max = around.max.cwiseMax(box_of(leaf).max);
    }
    EXPECT_EQ(bounds->min, around.min);
    EXPECT_EQ(bounds->max, around.max);

    const Box cell = box_of({places_.key(), depth_, true, 0});
    const auto margin = [&] { return static_cast<double>(random_() % 17) * 0.25; };
    const Box box{cell.min - Eigen::Vector3d(margin(), margin(), margin()),
                  cell.min + Eigen::Vector3d(margin(), margin(), margin())};
    std::vector<Node> inside;
    for (const Node& leaf : all) {
      const Box space = box_of(leaf);
      if ((space.min.array() < box.max.array()).all() && (space.max.array() > box.min.array()).all()) {
        inside.push_back(leaf);
      }
    }
    EXPECT_EQ(first_difference(leaves({.max_depth = {}, .box = box}), inside), "");
  }

  std::mt19937_64 random_;
  Places places_;
  OccupancyMap map_;
  OracleMap oracle_;
  Reload reload_;
  int depth_;
  bool is_pruned_ = true;
  std::size_t compared_ = 0, joined_ = 0;
};

}  // namespace pingvox::test
