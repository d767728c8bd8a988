#include "pingvox/map/nearest_cell.hpp"

#include <cassert>
#include <queue>
#include <vector>

namespace pingvox {
namespace {

/// A node, or the space of one that is unknown.
struct NearNode {
  double squared_m2;         ///< distance to its nearest point
  Eigen::Vector3d corner_m;  ///< lowest
  double edge_m;
  std::optional<NodeView> node;  ///< nullopt: unknown

  friend bool operator<(const NearNode& a, const NearNode& b) { return a.squared_m2 > b.squared_m2; }
};

/// The nearest node first: when it is a leaf, or unknown, no other is nearer.
class NearestSearch {
 public:
  NearestSearch(const OccupancyMap& map, const Eigen::Vector3d& point_m, double max_range_m, Sought sought)
      : map_(map), point_m_(point_m), max_range_m_(max_range_m), sought_(sought) {}

  std::optional<NearestCell> run() {
    const double edge_m = map_.lattice().cell_size_m(0);
    std::optional<NodeView> root = map_.root();
    // The tree of a lattice of one level begins above it.
    if (root && root->depth() < 0) root = root->child(0);
    push(root, Eigen::Vector3d::Constant(-0.5 * edge_m), edge_m);
    while (!nodes_.empty()) {
      const NearNode nearest = nodes_.top();
      nodes_.pop();
      if (!nearest.node || nearest.node->is_leaf()) return cell_of(nearest);
      const double half_m = 0.5 * nearest.edge_m;
      for (int octant = 0; octant < 8; ++octant) {
        const Eigen::Vector3d offset(octant & 1, octant >> 1 & 1, octant >> 2 & 1);
        push(nearest.node->child(octant), nearest.corner_m + half_m * offset, half_m);
      }
    }
    return std::nullopt;
  }

 private:
  void push(const std::optional<NodeView>& node, const Eigen::Vector3d& corner_m, double edge_m) {
    if (!may_hold(node)) return;
    const double squared_m2 = (nearest_point(corner_m, edge_m) - point_m_).squaredNorm();
    if (squared_m2 <= max_range_m_ * max_range_m_) nodes_.push({squared_m2, corner_m, edge_m, node});
  }

  /// Whether a node is, or has below it, what is sought, as far as it can say.
  bool may_hold(const std::optional<NodeView>& node) const {
    if (!node) return sought_ == Sought::kNotFree;
    const Thresholds& thresholds = map_.options().thresholds;
    if (!node->is_leaf()) {
      return sought_ == Sought::kNotFree || map_.options().parents != Parents::kMax ||
             node->belief() >= thresholds.upper;
    }
    const Occupancy what = classify(node->belief(), thresholds);
    return what == Occupancy::kOccupied || (sought_ == Sought::kNotFree && what == Occupancy::kUnknown);
  }

  Eigen::Vector3d nearest_point(const Eigen::Vector3d& corner_m, double edge_m) const {
    return point_m_.cwiseMax(corner_m).cwiseMin((corner_m.array() + edge_m).matrix());
  }

  NearestCell cell_of(const NearNode& found) const {
    const Eigen::Vector3d point_m = nearest_point(found.corner_m, found.edge_m);
    const Occupancy what = found.node ? classify(found.node->belief(), map_.options().thresholds) : Occupancy::kUnknown;
    return {what, point_m, (point_m - point_m_).norm()};
  }

  const OccupancyMap& map_;
  Eigen::Vector3d point_m_;
  double max_range_m_;
  Sought sought_;
  std::priority_queue<NearNode> nodes_;
};

}  // namespace

std::optional<NearestCell> nearest_cell(const OccupancyMap& map, const Eigen::Vector3d& point_m, double max_range_m,
                                        Sought sought) {
  assert(point_m.allFinite() && max_range_m >= 0.0);
  return NearestSearch(map, point_m, max_range_m, sought).run();
}

}  // namespace pingvox
