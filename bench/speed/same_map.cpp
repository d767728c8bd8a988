#include "same_map.hpp"

#include <fmt/core.h>

#include <bit>
#include <optional>

#include "cells_beyond_rounding.hpp"
#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox::bench {
namespace {

const octomap::OcTreeNode* child_of(const octomap::OcTree& tree, const octomap::OcTreeNode* node, int octant) {
  const auto i = static_cast<unsigned>(octant);
  return node != nullptr && tree.nodeHasChildren(node) && tree.nodeChildExists(node, i) ? tree.getNodeChild(node, i)
                                                                                        : nullptr;
}

/// Lowest cell and depth of a node.
struct Node {
  std::uint32_t x = 0, y = 0, z = 0;
  int depth = 0;

  Node child(int octant, int levels) const {
    const auto bits = static_cast<std::uint32_t>(octant);
    const int shift = levels - depth - 1;
    return {x | (bits & 1U) << shift, y | (bits >> 1U & 1U) << shift, z | (bits >> 2U & 1U) << shift, depth + 1};
  }
};

/// Walks both trees together; a leaf of one is compared with all leaves of the other below it.
class Comparison {
 public:
  Comparison(const OccupancyMap& ours, const octomap::OcTree& peer)
      : tree_(peer), threshold_(peer.getOccupancyThresLog()), levels_(ours.lattice().depth()) {}

  void add(const std::optional<NodeView>& ours, const octomap::OcTreeNode* peer, const Node& node,
           std::optional<float> our_leaf, std::optional<float> peer_leaf) {
    if (ours && ours->is_leaf()) our_leaf = ours->belief().value();
    if (peer != nullptr && !tree_.nodeHasChildren(peer)) peer_leaf = peer->getLogOdds();
    const bool ours_ends = !ours || ours->is_leaf(), peer_ends = peer == nullptr || !tree_.nodeHasChildren(peer);
    if (ours_ends && peer_ends) return count(our_leaf, peer_leaf, node);
    for (int octant = 0; octant < 8; ++octant) {
      add(ours_ends ? std::nullopt : ours->child(octant), peer_ends ? nullptr : child_of(tree_, peer, octant),
          node.child(octant, levels_), our_leaf, peer_leaf);
    }
  }

  const MapDifference& result() const { return result_; }

 private:
  void count(std::optional<float> a, std::optional<float> b, const Node& node) {
    if (!a && !b) return;
    const std::uint64_t cells = std::uint64_t{1} << (3 * (levels_ - node.depth));
    result_.cells += cells;
    if (a && b && std::bit_cast<std::uint32_t>(*a) == std::bit_cast<std::uint32_t>(*b)) return;
    result_.differs += cells;
    if (!b) result_.only_ours += cells;
    if (!a) result_.only_peer += cells;
    if (!a || !b || (*a >= threshold_) != (*b >= threshold_)) result_.classes += cells;
    add_keys(node);
  }

  void add_keys(const Node& node) {
    const std::uint32_t edge = 1U << (levels_ - node.depth);
    for (std::uint32_t x = 0; x < edge; ++x) {
      for (std::uint32_t y = 0; y < edge; ++y) {
        for (std::uint32_t z = 0; z < edge; ++z) {
          if (result_.keys.size() == MapDifference::kMaxKeys) return;
          result_.keys.push_back({static_cast<std::uint16_t>(node.x + x), static_cast<std::uint16_t>(node.y + y),
                                  static_cast<std::uint16_t>(node.z + z)});
        }
      }
    }
  }

  const octomap::OcTree& tree_;
  float threshold_;
  int levels_;
  MapDifference result_;
};

}  // namespace

MapDifference difference(const OccupancyMap& ours, const octomap::OcTree& peer) {
  Comparison comparison(ours, peer);
  comparison.add(ours.root(), peer.getRoot(), Node(), {}, {});
  return comparison.result();
}

Result<MapDifference> check_equal(const OccupancyMap& ours, const octomap::OcTree& peer,
                                  std::span<const RayCloud> scans) {
  MapDifference found = difference(ours, peer);
  if (found.differs > found.keys.size()) {
    return fail(Error::Code::kCorrupt,
                fmt::format("not what liboctomap makes: {} of {} cells differ", found.differs, found.cells));
  }
  const std::vector<Key> beyond = cells_beyond_rounding(ours.lattice(), scans, found.keys);
  if (beyond.empty()) return found;
  const Eigen::Vector3d first_m = ours.lattice().centre_of(beyond.front());
  return fail(Error::Code::kCorrupt,
              fmt::format("not what liboctomap makes: {} of {} cells differ, {} of them beyond rounding, the first at "
                          "({}, {}, {}) m",
                          found.differs, found.cells, beyond.size(), first_m.x(), first_m.y(), first_m.z()));
}

Result<void> check_identical(const OccupancyMap& ours, const octomap::OcTree& peer) {
  const MapDifference found = difference(ours, peer);
  const std::uint64_t nodes = ours.counts().nodes();
  if (found.differs == 0 && nodes == peer.size()) return {};
  return fail(Error::Code::kCorrupt,
              fmt::format("not what liboctomap makes: {} of {} cells differ, {} nodes against {}", found.differs,
                          found.cells, nodes, peer.size()));
}

}  // namespace pingvox::bench
