#include "pingvox/map/tree_view.hpp"

#include <cassert>
#include <memory>
#include <optional>
#include <utility>

#include "map/brick_tree.hpp"
#include "map/map_access.hpp"
#include "pingvox/map/occupancy_map.hpp"

namespace pingvox {
namespace detail {

TreeView view_of(const OccupancyMap& map) {
  const BrickTree& tree = MapAccess::tree(map);
  return {.root = tree.root,
          .groups = tree.groups.data(),
          .bricks = tree.bricks.view(),
          .group_count = tree.groups.bytes() / sizeof(Group),
          .brick_count = tree.bricks.bytes() / sizeof(Brick),
          .extra_levels = tree.extra_levels,
          .pruned = tree.pruned};
}

TreeBuilder::TreeBuilder(const MapOptions& options)
    : options_(std::make_unique<MapOptions>(options)), tree_(std::make_unique<BrickTree>(options.depth)) {
  assert(options.validate() && options.depth >= 2);
}
TreeBuilder::~TreeBuilder() = default;

Entry TreeBuilder::add(const CellStates& cells) {
  return store(*tree_, cells, options_->clamp, options_->parents);
}

Entry TreeBuilder::add(const Group& group) {
  return store(*tree_, group, options_->parents);
}

std::size_t TreeBuilder::bytes() const {
  return tree_->bytes();
}

OccupancyMap TreeBuilder::finish(Entry root) {
  tree_->root = root;
  return OccupancyMap(*options_, std::move(tree_));
}

}  // namespace detail

NodeView::NodeView(const detail::BrickTree& tree, Kind kind, int depth, Parents parents, std::uint32_t index,
                   float value)
    : tree_(&tree),
      index_(index),
      value_(value),
      depth_(depth),
      kind_(kind),
      parents_(parents),
      extra_levels_(static_cast<std::uint8_t>(tree.extra_levels)) {}

std::optional<NodeView> NodeView::of(const detail::BrickTree& tree, detail::Entry entry, int depth, Parents parents) {
  if (entry.is_none()) return std::nullopt;
  if (entry.is_leaf()) return NodeView(tree, Kind::kLeaf, depth, parents, 0, entry.value);
  const Kind kind = depth == tree.brick_depth() ? Kind::kBrick : Kind::kGroup;
  const NodeView node(tree, kind, depth, parents, entry.link, entry.value);
  // A lattice of one level has its root in octant 0 of the brick.
  return depth < tree.extra_levels ? node.child(0) : node;
}

std::optional<NodeView> NodeView::child(int octant) const {
  assert(octant >= 0 && octant < 8);
  switch (kind_) {
    case Kind::kLeaf:
      return std::nullopt;
    case Kind::kGroup:
      return of(*tree_, tree_->groups[index_].child[static_cast<std::size_t>(octant)], depth_ + 1, parents_);
    case Kind::kBrick: {
      const detail::BrickView brick = tree_->bricks[index_];
      if (detail::octant_known(brick, octant) == 0) return std::nullopt;
      const bool joined = tree_->pruned && ((detail::cells_of_uniform_octants(brick) >> (octant * 8)) & 1) != 0;
      NodeView view(*tree_, joined ? Kind::kLeaf : Kind::kOctant, depth_ + 1, parents_, index_,
                    joined ? brick.value[static_cast<std::size_t>(octant) * 8]
                           : detail::summary_of_octant(brick, octant, parents_));
      view.octant_ = static_cast<std::uint8_t>(octant);
      return view;
    }
    case Kind::kOctant: {
      const detail::BrickView brick = tree_->bricks[index_];
      const int cell = octant_ * 8 + octant;
      if (((brick.known >> cell) & 1) == 0) return std::nullopt;
      return NodeView(*tree_, Kind::kLeaf, depth_ + 1, parents_, 0, brick.value[static_cast<std::size_t>(cell)]);
    }
  }
  return std::nullopt;
}

}  // namespace pingvox
