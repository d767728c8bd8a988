#include "pingvox/map/occupancy_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <new>
#include <utility>
#include <variant>

#include "base/option_errors.hpp"
#include "geometry/internal/cell_counts.hpp"
#include "geometry/internal/tree_order.hpp"
#include "map/bits.hpp"
#include "map/brick_tree.hpp"
#include "map/cursor.hpp"
#include "map/growth.hpp"
#include "map/internal/count_cells.hpp"
#include "map/key_batch.hpp"
#include "map/page_updates.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/map/scan_update.hpp"

namespace pingvox {
namespace {

/// Short enough to fit into a std::string without an allocation.
constexpr const char* kOutOfMemory = "out of memory";

detail::CursorRules rules_of(const detail::BrickTree& tree, const MapOptions& options, Pruning pruning) {
  return {options.parents, pruning, tree.early_drop, options.clamp};
}

void count(const NodeView& node, int depth, const Thresholds& thresholds, MapCounts& counts) {
  if (!node.is_leaf()) {
    ++counts.inner;
    for (int octant = 0; octant < 8; ++octant) {
      if (const auto child = node.child(octant)) count(*child, depth, thresholds, counts);
    }
    return;
  }
  ++counts.leaves;
  const std::uint64_t cells = detail::cells_in_node(depth - node.depth());
  detail::count_cells(classify(node.belief(), thresholds), cells, counts);
}

/// The deepest entry that holds a key.
template <KeyWord W>
inline detail::Entry entry_above(const detail::BrickTree& tree, const BasicKey<W>& key) {
  detail::Entry entry = tree.root;
  int level = tree.levels;
  if (const detail::Entry* const node = tree.shortcut ? tree.shortcut->node_of(key) : nullptr) {
    entry = *node;
    level = tree.shortcut->level;
  }
  while (--level >= 2 && entry.is_inner())
    entry = tree.groups[entry.link].child[static_cast<std::size_t>(key.octant(level))];
  return entry;
}

/// Calls f.operator()<W>() with the width of the cursor that a lattice of `depth` needs.
template <class F>
auto with_cursor_word(int depth, F&& f) {
  return depth <= kLevelsOf<std::uint64_t> ? f.template operator()<std::uint64_t>() : f.template operator()<WideWord>();
}

std::variant<detail::Cursor<std::uint64_t>, detail::Cursor<WideWord>> cursor_in(detail::BrickTree& tree,
                                                                                const detail::CursorRules& rules) {
  if (tree.levels <= kLevelsOf<std::uint64_t>) return detail::Cursor<std::uint64_t>(tree, rules);
  return detail::Cursor<WideWord>(tree, rules);
}

void count_updates(const ScanUpdate::Page& page, ApplyReport& report) {
  detail::for_each_bit(page.bricks,
                       [&](std::size_t brick) { report.cells_freed += detail::count_bits(page.missed[brick]); });
  detail::for_each_bit(page.bricks_hit, [&](std::size_t brick) {
    report.cells_freed -= detail::count_bits(page.missed[brick] & page.hit[brick]);
    report.cells_hit += detail::count_bits(page.hit[brick]);
  });
}

template <KeyWord W>
ApplyReport apply_scan(detail::BrickTree& tree, const detail::CursorRules& rules, const ScanUpdate& scan) {
  ApplyReport report;
  detail::Cursor<W> cursor(tree, rules);
  const int page_depth = tree.brick_depth() - detail::kPageLevels;
  for (const std::uint32_t index : scan.pages_in_order()) {
    const ScanUpdate::Page& page = scan.page(index);
    count_updates(page, report);
    if (page_depth < 0) {
      detail::for_each_bit(page.bricks, [&](std::size_t brick) {
        cursor.update_brick(detail::lowest_in<W>(page, brick), detail::updates_of_brick(scan, page, brick));
      });
      continue;
    }
    const detail::Entry before = cursor.seek(page.lowest.as<W>(), page_depth);
    const detail::Entry after = detail::update_page(tree, rules, scan, page, before);
    if (after != before) cursor.put(page_depth, after);
  }
  cursor.flush();
  return report;
}

void apply_batch(detail::BrickTree& tree, const detail::CursorRules& rules, detail::KeyBatch& batch, LogOdds evidence) {
  detail::Cursor<std::uint64_t> cursor(tree, rules);
  batch.take([&](const BasicKey<std::uint64_t>& key, const detail::KeyBatch::Cells& cells) {
    const auto update = [&](std::uint64_t some) { return cursor.update_brick(key, {0, {}, some, nullptr, evidence}); };
    bool changed = update(cells.once);
    std::uint64_t left = cells.more;
    for (std::uint32_t round = 2; left != 0 && changed; ++round) {
      changed = update(left);  // once nothing changes, nothing will: it is the same evidence
      for (std::uint64_t some = left; some != 0; some &= some - 1) {
        const auto cell = static_cast<std::size_t>(std::countr_zero(some));
        if (cells.times[cell] <= round) left &= ~(std::uint64_t{1} << cell);
      }
    }
  });
  cursor.flush();
}

/// An error when so many bytes are more than the limit; 0 is none.
Result<void> check_limit(std::size_t needed, std::size_t limit) {
  if (limit == 0 || needed <= limit) return {};
  return fail(Error::Code::kLimit,
              fmt::format("the map would need {} bytes, more than its limit of {}", needed, limit));
}

/// Options with a resolution.
MapOptions with_resolution(MapOptions options) {
  options.resolution_m = options.resolution_m.value_or(MapOptions::kDefaultResolution_m);
  return options;
}

}  // namespace

Result<void> MapOptions::validate() const {
  OptionErrors errors;
  if (const auto lattice = Lattice::make(resolution_m.value_or(kDefaultResolution_m), depth); !lattice)
    errors.add(lattice.error().message);
  const float low = clamp.lowest.value(), high = clamp.highest.value();
  if (!(low < 0.0F && high > 0.0F && std::isfinite(low) && std::isfinite(high))) {
    errors.add(fmt::format("clamp must be finite with lowest < 0 < highest log-odds, is {} and {}", low, high));
  }
  if (!(thresholds.lower <= thresholds.upper)) {
    errors.add(fmt::format("lower threshold must not exceed the upper one, {} and {} do", thresholds.lower.value(),
                           thresholds.upper.value()));
  }
  return errors.result("map");
}

Result<OccupancyMap> OccupancyMap::make(const MapOptions& options) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  return OccupancyMap(options);
}

OccupancyMap::OccupancyMap(const MapOptions& options)
    : options_(with_resolution(options)),
      lattice_(*options_.resolution_m, options.depth),
      tree_(std::make_unique<detail::BrickTree>(options.depth)) {
  assert(options.validate());
}

OccupancyMap::OccupancyMap(const MapOptions& options, std::unique_ptr<detail::BrickTree> tree)
    : options_(with_resolution(options)), lattice_(*options_.resolution_m, options.depth), tree_(std::move(tree)) {
  assert(options.validate() && tree_->levels - tree_->extra_levels == options.depth && tree_->pruned);
  tree_->shortcut = detail::shortcut_of(*tree_);
}

OccupancyMap::OccupancyMap(const OccupancyMap& other)
    : options_(other.options_), lattice_(other.lattice_), tree_(std::make_unique<detail::BrickTree>(*other.tree_)) {}
OccupancyMap& OccupancyMap::operator=(const OccupancyMap& other) {
  return *this = OccupancyMap(other);
}
OccupancyMap::OccupancyMap(OccupancyMap&& other) noexcept = default;
OccupancyMap& OccupancyMap::operator=(OccupancyMap&& other) noexcept = default;
OccupancyMap::~OccupancyMap() = default;

bool OccupancyMap::empty() const {
  return tree_->root.is_none();
}

std::optional<NodeView> OccupancyMap::root() const {
  return NodeView::of(*tree_, tree_->root, 0, options_.parents);
}

template <KeyWord W>
std::optional<NodeView> OccupancyMap::node_at(const BasicKey<W>& key, int depth) const {
  assert(depth >= 0 && depth <= lattice_.depth());
  std::optional<NodeView> node = root();
  while (node && !node->is_leaf() && node->depth() < depth) {
    node = node->child(key.octant(lattice_.depth() - 1 - node->depth()));
  }
  return node;
}

template <KeyWord W>
std::optional<LogOdds> OccupancyMap::at(const BasicKey<W>& key) const {
  const detail::Entry entry = entry_above(*tree_, key);
  if (entry.is_none()) return std::nullopt;
  if (entry.is_leaf()) return LogOdds(entry.value);
  const detail::BrickView brick = tree_->bricks[entry.link];
  const std::size_t cell = static_cast<std::size_t>(detail::cell_in_brick(key));
  if (((brick.known >> cell) & 1) == 0) return std::nullopt;
  return LogOdds(brick.value[cell]);
}

std::optional<LogOdds> OccupancyMap::at(const Eigen::Vector3d& point_m) const {
  return with_key_word(lattice_.depth(), [&]<KeyWord W>() -> std::optional<LogOdds> {
    const auto key = lattice_.key_of<W>(point_m);
    return key ? at(*key) : std::nullopt;
  });
}

template <KeyWord W>
Occupancy OccupancyMap::classify(const BasicKey<W>& key) const {
  const detail::Entry entry = entry_above(*tree_, key);
  float value = entry.value;
  unsigned is_known = entry.is_none() ? 0 : 1;
  if (entry.is_inner()) {
    const detail::BrickView brick = tree_->bricks[entry.link];
    const std::size_t cell = static_cast<std::size_t>(detail::cell_in_brick(key));
    value = brick.value[cell];
    is_known = static_cast<unsigned>(brick.known >> cell) & 1U;
  }
  // By arithmetic: a branch would be mispredicted, as neighbouring queries differ.
  const unsigned is_occupied = value >= options_.thresholds.upper.value() ? 1 : 0;
  const unsigned is_free = value < options_.thresholds.lower.value() ? 1 : 0;
  return static_cast<Occupancy>(is_known * (2 * is_occupied + is_free));
}

Occupancy OccupancyMap::classify(const Eigen::Vector3d& point_m) const {
  const auto belief = at(point_m);
  return belief ? pingvox::classify(*belief, options_.thresholds) : Occupancy::kUnknown;
}

MapCounts OccupancyMap::counts() const {
  MapCounts counts;
  if (const auto node = root()) count(*node, lattice_.depth(), options_.thresholds, counts);
  return counts;
}

std::optional<Box> OccupancyMap::bounds() const {
  if (empty()) return std::nullopt;
  const double inf = std::numeric_limits<double>::infinity();
  Box box{Eigen::Vector3d::Constant(inf), Eigen::Vector3d::Constant(-inf)};
  for_each_leaf(*this, [&](const Leaf& leaf) {
    const Eigen::Vector3d corner = lattice_.lowest_corner_of(leaf.key, leaf.depth);
    box.min = box.min.cwiseMin(corner);
    box.max = box.max.cwiseMax((corner.array() + leaf.edge_m()).matrix());
  });
  return box;
}

std::size_t OccupancyMap::memory_bytes() const {
  return tree_->bytes();
}

Result<ApplyReport> OccupancyMap::apply(const ScanUpdate& scan) {
  if (!(scan.lattice() == lattice_)) {
    return fail(
        Error::Code::kBadOption,
        fmt::format("the scan is of cells of {} m and {} levels, the map of {} m and {}", scan.lattice().resolution_m(),
                    scan.lattice().depth(), lattice_.resolution_m(), lattice_.depth()));
  }
  try {
    if (!tree_->pruned) detail::prune_all(*tree_, options_.parents);
    if (const std::size_t limit = options_.memory_limit_bytes; limit > 0) {
      const std::size_t growth = with_cursor_word(
          tree_->levels, [&]<KeyWord W>() { return detail::growth_of<W>(*tree_, scan, options_.clamp); });
      if (const auto fits = check_limit(tree_->bytes() + growth, limit); !fits) return tl::unexpected(fits.error());
    }
    const detail::CursorRules rules = rules_of(*tree_, options_, Pruning::kLazy);
    return with_cursor_word(tree_->levels, [&]<KeyWord W>() { return apply_scan<W>(*tree_, rules, scan); });
  } catch (const std::bad_alloc&) {
    detail::prune_all(*tree_, options_.parents);
    return fail(Error::Code::kNoMemory, kOutOfMemory);
  }
}

template <KeyWord W>
Result<void> OccupancyMap::update(std::span<const BasicKey<W>> keys, LogOdds evidence) {
  try {
    if (!tree_->pruned) detail::prune_all(*tree_, options_.parents);
    if (tree_->levels > detail::KeyBatch::kMaxLevels || keys.size() > std::numeric_limits<std::uint32_t>::max()) {
      Editor editor = edit();
      for (const BasicKey<W>& key : keys) editor.update(key, evidence);
      return {};
    }
    detail::KeyBatch batch;
    if (const std::size_t limit = options_.memory_limit_bytes; limit > 0) {
      batch.gather(keys);
      const std::size_t growth = detail::growth_of(*tree_, batch, evidence, options_.clamp);
      if (auto fits = check_limit(tree_->bytes() + growth, limit); !fits) return fits;
    }
    batch.gather(keys);
    apply_batch(*tree_, rules_of(*tree_, options_, Pruning::kLazy), batch, evidence);
    return {};
  } catch (const std::bad_alloc&) {
    detail::prune_all(*tree_, options_.parents);
    return fail(Error::Code::kNoMemory, kOutOfMemory);
  }
}

Result<void> OccupancyMap::merge(const OccupancyMap& other) {
  if (!(lattice_ == other.lattice_)) {
    return fail(
        Error::Code::kBadOption,
        fmt::format("maps on different lattices cannot be merged: {} m and {} levels, {} m and {} levels",
                    lattice_.resolution_m(), lattice_.depth(), other.lattice_.resolution_m(), other.lattice_.depth()));
  }
  try {
    detail::BrickTree merged = *tree_;
    merged.root =
        detail::merge(merged, merged.root, *other.tree_, other.tree_->root, 0, options_.parents, options_.clamp);
    merged.shortcut = detail::shortcut_of(merged);
    if (!merged.pruned) detail::prune_all(merged, options_.parents);
    if (const std::size_t limit = options_.memory_limit_bytes; limit > 0 && merged.bytes() > limit) {
      return fail(Error::Code::kLimit,
                  fmt::format("the merged map needs {} bytes, more than its limit of {}", merged.bytes(), limit));
    }
    *tree_ = std::move(merged);
    return {};
  } catch (const std::bad_alloc&) {
    return fail(Error::Code::kNoMemory, kOutOfMemory);
  }
}

Editor OccupancyMap::edit(Pruning pruning) {
  return Editor(*this, pruning);
}

void OccupancyMap::clear() {
  const EarlyDrop early_drop = tree_->early_drop;
  *tree_ = detail::BrickTree(lattice_.depth());
  tree_->early_drop = early_drop;
}

// ---------------------------------------------------------------------------------------------------------------------

struct Editor::Place {
  // Keys of 64 bits are quicker; deeper lattices need wide ones.
  std::variant<detail::Cursor<std::uint64_t>, detail::Cursor<WideWord>> cursor;
};

Editor::Editor(OccupancyMap& map, Pruning pruning)
    : map_(map), place_(std::make_unique<Place>(cursor_in(*map.tree_, rules_of(*map.tree_, map.options_, pruning)))) {
  if (pruning == Pruning::kNever) {
    map_.tree_->pruned = false;
  } else if (!map_.tree_->pruned) {
    detail::prune_all(*map_.tree_, map_.options_.parents);
  }
}

// NOLINTNEXTLINE(bugprone-exception-escape): std::visit throws for a variant without a value, which ours never is
Editor::~Editor() {
  synchronize();
}

template <KeyWord W>
void Editor::update(const BasicKey<W>& key, LogOdds evidence) {
  if (auto* const cursor = std::get_if<detail::Cursor<std::uint64_t>>(&place_->cursor)) {
    cursor->update(key.template as<std::uint64_t>(), evidence);
  } else {
    std::get<detail::Cursor<WideWord>>(place_->cursor).update(key.template as<WideWord>(), evidence);
  }
}

template <KeyWord W>
void Editor::set(const BasicKey<W>& key, int depth, LogOdds belief) {
  assert(depth >= 0 && depth <= map_.lattice_.depth());
  const int tree_depth = depth + map_.tree_->extra_levels;
  if (auto* const cursor = std::get_if<detail::Cursor<std::uint64_t>>(&place_->cursor)) {
    cursor->set(key.template as<std::uint64_t>(), tree_depth, belief.value());
  } else {
    std::get<detail::Cursor<WideWord>>(place_->cursor).set(key.template as<WideWord>(), tree_depth, belief.value());
  }
}

void Editor::synchronize() {
  std::visit([](auto& cursor) { cursor.flush(); }, place_->cursor);
}

// The five widths, compiled once here.
// NOLINTBEGIN(bugprone-macro-parentheses): W is a type
#define PINGVOX_FOR_KEY_WORD(W)                                                          \
  template std::optional<LogOdds> OccupancyMap::at(const BasicKey<W>&) const;            \
  template std::optional<NodeView> OccupancyMap::node_at(const BasicKey<W>&, int) const; \
  template Occupancy OccupancyMap::classify(const BasicKey<W>&) const;                   \
  template Result<void> OccupancyMap::update(std::span<const BasicKey<W>>, LogOdds);     \
  template void Editor::update(const BasicKey<W>&, LogOdds);                             \
  template void Editor::set(const BasicKey<W>&, int, LogOdds);
PINGVOX_FOR_KEY_WORD(std::uint8_t)
PINGVOX_FOR_KEY_WORD(std::uint16_t)
PINGVOX_FOR_KEY_WORD(std::uint32_t)
PINGVOX_FOR_KEY_WORD(std::uint64_t)
PINGVOX_FOR_KEY_WORD(WideWord)
#undef PINGVOX_FOR_KEY_WORD
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace pingvox
