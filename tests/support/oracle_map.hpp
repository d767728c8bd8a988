#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "map/brick_tree.hpp"
#include "pingvox/map/log_odds.hpp"
#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::test {

/// Components of a lattice's keys that are in use.
inline WideWord highest_word(int depth) {
  return depth == kMaxDepth ? ~WideWord{0} : (WideWord{1} << depth) - 1;
}

/// A node as the tests compare it: bits, not values, so that 0 and -0 differ.
struct Node {
  WideKey key;
  int depth = 0;
  bool is_leaf = false;
  std::uint32_t bits = 0;
  float value() const { return std::bit_cast<float>(bits); }
  friend bool operator==(const Node&, const Node&) = default;
};

/// What a scan says, kept as plain sets.
struct OracleScan {
  LogOdds miss = LogOdds::from_probability(0.4);
  std::set<WideKey> missed;
  std::map<WideKey, LogOdds> hit;

  void add_hit(const WideKey& key, LogOdds evidence) {
    const auto [at, is_new] = hit.emplace(key, evidence);
    if (!is_new) at->second = std::max(at->second, evidence);
  }
};

/// A map of cells written to be obviously right: each cell of the finest resolution is one entry of a std::map, and
/// everything that a tree would keep (joined leaves, inner nodes, counts) is derived from the cells when it is asked
/// for.
class OracleMap {
 public:
  OracleMap(int depth, const Clamp& clamp) : depth_(depth), clamp_(clamp) {}

  std::map<WideKey, float> cells;

  void update(const WideKey& key, LogOdds evidence) {
    if (evidence.value() == 0.0F) return;
    float& belief = cells.emplace(key, 0.0F).first->second;
    const bool is_stable = evidence.value() > 0.0F ? belief >= clamp_.highest.value() : belief <= clamp_.lowest.value();
    if (!is_stable) belief = clamped(belief + evidence.value());
  }

  void apply(const OracleScan& scan) {
    for (const auto& [key, evidence] : scan.hit) update(key, evidence);
    for (const WideKey& key : scan.missed) {
      if (scan.hit.count(key) == 0) update(key, scan.miss);
    }
  }

  /// Cell by cell: only for depths near the finest.
  void set(const WideKey& key, int depth, LogOdds belief) {
    const WideWord edge = WideWord{1} << (depth_ - depth), inside = edge - 1;
    for (WideWord x = 0; x < edge; ++x) {
      for (WideWord y = 0; y < edge; ++y) {
        for (WideWord z = 0; z < edge; ++z) {
          cells[WideKey{(key.x & ~inside) | x, (key.y & ~inside) | y, (key.z & ~inside) | z}] = belief.value();
        }
      }
    }
  }

  void merge(const OracleMap& other) {
    for (const auto& [key, belief] : other.cells) {
      const auto mine = cells.find(key);
      if (mine == cells.end()) {
        cells.emplace(key, clamped(belief));
      } else {
        mine->second = clamped(mine->second + belief);
      }
    }
  }

  enum class Join { kEqualLeaves, kNothing };

  /// All nodes of the octree over the cells, parents before children, octants in order. Nodes at `max_depth` are given
  /// as leaves.
  std::vector<Node> nodes(Parents parents, Join join, std::optional<int> max_depth = std::nullopt) const {
    std::vector<Node> all;
    const std::vector<std::pair<WideKey, float>> everything(cells.begin(), cells.end());
    if (!everything.empty()) derive(everything, WideKey{}, 0, parents, join, max_depth, all);
    return all;
  }

 private:
  float clamped(float value) const { return std::clamp(value, clamp_.lowest.value(), clamp_.highest.value()); }

  // Appends the node of `depth` with this lowest corner and all below it; REQUIRES that it has cells.
  Node derive(const std::vector<std::pair<WideKey, float>>& inside, const WideKey& key, int depth, Parents parents,
              Join join, std::optional<int> max_depth, std::vector<Node>& all) const {
    Node node{key, depth, depth == depth_, 0};
    const std::size_t place = all.size();
    all.push_back(node);
    if (node.is_leaf) {
      node.bits = std::bit_cast<std::uint32_t>(inside.front().second);
    } else {
      std::array<std::vector<std::pair<WideKey, float>>, 8> parts;
      const int bit = depth_ - 1 - depth;
      for (const auto& cell : inside) parts[static_cast<std::size_t>(cell.first.octant(bit))].push_back(cell);
      float highest = std::numeric_limits<float>::lowest();
      double sum = 0.0;
      std::vector<Node> children;
      for (std::size_t o = 0; o < 8; ++o) {
        if (parts[o].empty()) continue;
        const WideKey corner{key.x | (WideWord{o & 1} << bit), key.y | (WideWord{(o >> 1) & 1} << bit),
                             key.z | (WideWord{o >> 2} << bit)};
        children.push_back(derive(parts[o], corner, depth + 1, parents, join, max_depth, all));
        highest = std::max(highest, children.back().value());
        sum += double{children.back().value()};
      }
      const float mean = static_cast<float>(sum / static_cast<double>(children.size()));
      node.bits = std::bit_cast<std::uint32_t>(parents == Parents::kMax ? highest : mean);
      node.is_leaf = join == Join::kEqualLeaves && children.size() == 8 &&
                     std::all_of(children.begin(), children.end(), [&](const Node& child) {
                       return child.is_leaf && child.value() == children[0].value();
                     });
    }
    const bool is_cut = depth == max_depth;
    if (node.is_leaf || is_cut) all.resize(place + 1);
    all[place] = node;
    if (is_cut) all[place].is_leaf = true;
    return node;
  }

  int depth_;
  Clamp clamp_;
};

/// All nodes of a map, parents before children, octants in order.
inline void append_nodes(const NodeView& view, const WideKey& key, int lattice_depth, std::vector<Node>& all) {
  all.push_back({key, view.depth(), view.is_leaf(), std::bit_cast<std::uint32_t>(view.belief().value())});
  for (int octant = 0; octant < 8; ++octant) {
    const auto child = view.child(octant);
    if (!child) continue;
    const int bit = lattice_depth - 1 - view.depth();
    const auto with = [&](WideWord word, int axis) {
      return word | (static_cast<WideWord>((octant >> axis) & 1) << bit);
    };
    append_nodes(*child, {with(key.x, 0), with(key.y, 1), with(key.z, 2)}, lattice_depth, all);
  }
}
inline std::vector<Node> nodes_of(const OccupancyMap& map) {
  std::vector<Node> all;
  if (const auto root = map.root()) append_nodes(*root, {}, map.lattice().depth(), all);
  return all;
}

}  // namespace pingvox::test
