#include <array>
#include <bit>

#include "map/brick_tree.hpp"
#include "map/page_updates.hpp"

namespace pingvox::detail {
namespace {

/// That of pages. Links below come and go: with them it would be made again after each scan, and updates of a page
/// change them by themselves.
constexpr int kLowestLevel = 2 + kPageLevels;

/// Calls f(child, place) for the known children of eight nodes: a place is 0..3 along each axis.
template <class F>
void for_each_child(const BrickTree& tree, const Shortcut& nodes, F&& f) {
  for (unsigned n = 0; n < 8; ++n) {
    const Entry node = nodes.node[n];
    if (node.is_none()) continue;
    for (unsigned o = 0; o < 8; ++o) {
      const Entry child = node.is_inner() ? tree.groups[node.link].child[o] : node;
      const auto along = [&](unsigned axis) { return (n >> axis & 1) << 1 | (o >> axis & 1); };
      if (!child.is_none()) f(child, std::array{along(0), along(1), along(2)});
    }
  }
}

/// Eight nodes one level below that cover all known space; nullopt: it is wider than two of them, or empty.
std::optional<Shortcut> one_below(const BrickTree& tree, const Shortcut& above) {
  std::array<unsigned, 3> known{};  ///< of each axis a bit for each place where something is
  for_each_child(tree, above, [&](const Entry&, const auto& place) {
    for (std::size_t axis = 0; axis < 3; ++axis) known[axis] |= 1U << place[axis];
  });
  if (known[0] == 0) return std::nullopt;
  std::array<unsigned, 3> first{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = static_cast<unsigned>(std::countr_zero(known[axis]));
    if (known[axis] >> first[axis] > 3) return std::nullopt;
  }
  const BasicKey<std::uint64_t>& from = above.lowest;
  Shortcut found{above.level - 1, {2 * from.x + first[0], 2 * from.y + first[1], 2 * from.z + first[2]}, {}};
  for_each_child(tree, above, [&](const Entry& child, const auto& place) {
    found.node[(place[0] - first[0]) | (place[1] - first[1]) << 1 | (place[2] - first[2]) << 2] = child;
  });
  return found;
}

}  // namespace

std::optional<Shortcut> shortcut_of(const BrickTree& tree) {
  if (!tree.root.is_inner() || tree.levels <= kLowestLevel || tree.levels > kLevelsOf<std::uint64_t>) {
    return std::nullopt;
  }
  std::optional<Shortcut> found = one_below(tree, {tree.levels, {}, {tree.root}});
  while (found && found->level > kLowestLevel) {
    const auto next = one_below(tree, *found);
    if (!next) break;
    found = next;
  }
  return found;
}

}  // namespace pingvox::detail
