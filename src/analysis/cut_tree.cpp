#include "pingvox/analysis/cut_tree.hpp"

#include <cassert>

#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox {

OccupancyMap cut_tree(const OccupancyMap& map, int depth) {
  assert(depth >= 1);
  OccupancyMap out(map.options());
  Editor editor = out.edit();
  for_each_leaf(map, {.max_depth = depth, .box = {}},
                [&](const Leaf& leaf) { editor.set(leaf.key, leaf.depth, leaf.belief); });
  editor.synchronize();
  return out;
}

}  // namespace pingvox
