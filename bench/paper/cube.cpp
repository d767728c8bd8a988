#include "cube.hpp"

#include <cstdint>

namespace pingvox::bench {
namespace {

/// Calls f(x, y, z) for each update, with x outermost.
template <class F>
void for_each_update(const PaperCube& cube, std::uint32_t middle, F&& f) {
  const auto n = static_cast<std::uint32_t>(cube.updates_along_axis);
  const std::uint32_t first = middle - PaperCube::kHalf, edge = 2 * PaperCube::kHalf * n;
  for (std::uint32_t x = 0; x < edge; ++x) {
    for (std::uint32_t y = 0; y < edge; ++y) {
      for (std::uint32_t z = 0; z < edge; ++z) f(first + x / n, first + y / n, first + z / n);
    }
  }
}

}  // namespace

void PaperCube::fill(OccupancyMap& map, Pruning pruning) const {
  Editor editor = map.edit(pruning);
  for_each_update(*this, 32768, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    editor.update(Key{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), static_cast<std::uint16_t>(z)},
                  evidence);
  });
}

void PaperCube::fill(octomap::OcTree& tree, Pruning pruning) const {
  const bool lazy = pruning != Pruning::kEachUpdate;
  for_each_update(*this, 32768, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    tree.updateNode(octomap::OcTreeKey(static_cast<octomap::key_type>(x), static_cast<octomap::key_type>(y),
                                       static_cast<octomap::key_type>(z)),
                    evidence.value(), lazy);
  });
  if (lazy) tree.updateInnerOccupancy();
  if (pruning == Pruning::kLazy) tree.prune();
}

}  // namespace pingvox::bench
