#include "same_map.hpp"

#include <fmt/core.h>

#include <bit>
#include <optional>

#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox::bench {
namespace {

const octomap::OcTreeNode* child_of(const octomap::OcTree& tree, const octomap::OcTreeNode* node, int octant) {
  const auto i = static_cast<unsigned>(octant);
  return node != nullptr && tree.nodeHasChildren(node) && tree.nodeChildExists(node, i) ? tree.getNodeChild(node, i)
                                                                                        : nullptr;
}

/// Walks both trees at once; where one ends in a leaf it is compared with all leaves of the other.
class Comparison {
 public:
  Comparison(const OccupancyMap& ours, const octomap::OcTree& peer)
      : tree_(peer), threshold_(peer.getOccupancyThresLog()), levels_(ours.lattice().depth()) {}

  void add(const std::optional<NodeView>& ours, const octomap::OcTreeNode* peer, int depth,
           std::optional<float> our_leaf, std::optional<float> peer_leaf) {
    if (ours && ours->is_leaf()) our_leaf = ours->belief().value();
    if (peer != nullptr && !tree_.nodeHasChildren(peer)) peer_leaf = peer->getLogOdds();
    const bool ours_ends = !ours || ours->is_leaf(), peer_ends = peer == nullptr || !tree_.nodeHasChildren(peer);
    if (ours_ends && peer_ends) return count(our_leaf, peer_leaf, depth);
    for (int octant = 0; octant < 8; ++octant) {
      add(ours_ends ? std::nullopt : ours->child(octant), peer_ends ? nullptr : child_of(tree_, peer, octant),
          depth + 1, our_leaf, peer_leaf);
    }
  }

  const MapDifference& result() const { return result_; }

 private:
  void count(std::optional<float> a, std::optional<float> b, int depth) {
    if (!a && !b) return;
    const std::uint64_t cells = std::uint64_t{1} << (3 * (levels_ - depth));
    result_.cells += cells;
    if (a && b && std::bit_cast<std::uint32_t>(*a) == std::bit_cast<std::uint32_t>(*b)) return;
    result_.differs += cells;
    if (!b) result_.only_ours += cells;
    if (!a) result_.only_peer += cells;
    if (!a || !b || (*a >= threshold_) != (*b >= threshold_)) result_.classes += cells;
  }

  const octomap::OcTree& tree_;
  float threshold_;
  int levels_;
  MapDifference result_;
};

}  // namespace

MapDifference difference(const OccupancyMap& ours, const octomap::OcTree& peer) {
  Comparison comparison(ours, peer);
  comparison.add(ours.root(), peer.getRoot(), 0, {}, {});
  return comparison.result();
}

Result<MapDifference> alike(const OccupancyMap& ours, const octomap::OcTree& peer, double tolerated) {
  const MapDifference found = difference(ours, peer);
  if (found.share() <= tolerated) return found;
  return fail(Error::Code::kCorrupt,
              fmt::format("not what liboctomap makes: {} of {} cells differ", found.differs, found.cells));
}

Result<void> same_to_the_bit(const OccupancyMap& ours, const octomap::OcTree& peer) {
  const MapDifference found = difference(ours, peer);
  const std::uint64_t nodes = ours.counts().nodes();
  if (found.differs == 0 && nodes == peer.size()) return {};
  return fail(Error::Code::kCorrupt,
              fmt::format("not what liboctomap makes: {} of {} cells differ, {} nodes against {}", found.differs,
                          found.cells, nodes, peer.size()));
}

}  // namespace pingvox::bench
