#include "web/live_cells.hpp"

#include <bit>
#include <optional>
#include <utility>

#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/map/scan_update.hpp"
#include "web/byte_columns.hpp"
#include "web/cell_places.hpp"

namespace pingvox::web {
namespace {

constexpr int kPageLevels = ScanUpdate::kPageBits;
constexpr std::int64_t kPageEdge = std::int64_t{1} << kPageLevels;
constexpr std::size_t kBricksInPage = 64;

/// The cells of a page, as they are found.
class PageBuilder {
 public:
  /// Adds a cell, counted from the lowest one of the page.
  void add(std::int64_t x, std::int64_t y, std::int64_t z, std::uint8_t byte) {
    const auto index = [](std::int64_t i, std::int64_t j, std::int64_t k) {
      return static_cast<std::size_t>(i + kBrickEdge * (j + kBrickEdge * k));
    };
    PageCells::Brick& brick = bricks_[index(x >> 2, y >> 2, z >> 2)];
    const std::size_t bit = index(x & 3, y & 3, z & 3);
    brick.mask |= std::uint64_t{1} << bit;
    brick.byte[bit] = byte;
    ++cells_;
  }

  std::size_t cells() const { return cells_; }

  PageCells take(const PagePlace& place) {
    PageCells page{place, {}};
    for (std::size_t i = 0; i < kBricksInPage; ++i) {
      if (bricks_[i].mask == 0) continue;
      page.bricks.push_back(std::exchange(bricks_[i], {}));
      page.bricks.back().place = static_cast<std::uint8_t>(i);
    }
    cells_ = 0;
    return page;
  }

 private:
  std::array<PageCells::Brick, kBricksInPage> bricks_;
  std::size_t cells_ = 0;
};

/// nullopt: it is too far away for the browser.
std::optional<PagePlace> page_place(const Lattice& lattice, const WideKey& key) {
  __extension__ typedef __int128 SignedWide;
  constexpr SignedWide kFarthest = std::int64_t{1} << 27;
  const WideWord half = WideWord{1} << (lattice.depth() - 1);
  std::array<std::int32_t, 3> place{};
  std::size_t axis = 0;
  for (const WideWord word : {key.x, key.y, key.z}) {
    const SignedWide page = static_cast<SignedWide>(word - half) >> kPageLevels;
    if (page < -kFarthest || page >= kFarthest) return std::nullopt;
    place[axis++] = static_cast<std::int32_t>(page);
  }
  return PagePlace{place[0], place[1], place[2]};
}

/// Adds the occupied cells below a node.
class PageWalk {
 public:
  PageWalk(const OccupancyMap& map, LogOdds lowest) : map_(map), lowest_(lowest) {}

  PageCells cells_of(const NodeView& node, const PagePlace& place) {
    visit(node, {});
    return builder_.take(place);
  }
  std::size_t cells() const { return cells_; }

 private:
  void visit(const NodeView& node, const CellPlace& at) {
    const int levels = std::min(map_.lattice().depth() - node.depth(), kPageLevels);
    const bool is_leaf = node.is_leaf();
    // By the greatest value below an inner node there is none.
    if ((is_leaf || map_.options().parents == Parents::kMax) && node.belief() < lowest_) return;
    if (is_leaf) {
      const std::uint8_t byte = byte_.of(node.belief());
      const std::int64_t edge = std::int64_t{1} << levels;
      for (std::int64_t z = 0; z < edge; ++z) {
        for (std::int64_t y = 0; y < edge; ++y) {
          for (std::int64_t x = 0; x < edge; ++x) builder_.add(at.x + x, at.y + y, at.z + z, byte);
        }
      }
      cells_ += static_cast<std::size_t>(edge * edge * edge);
      return;
    }
    const std::int64_t half = std::int64_t{1} << (levels - 1);
    for (int octant = 0; octant < 8; ++octant) {
      const std::optional<NodeView> child = node.child(octant);
      const auto step = [&](int axis) { return ((octant >> axis) & 1) * half; };
      if (child) visit(*child, {at.x + step(0), at.y + step(1), at.z + step(2)});
    }
  }

  const OccupancyMap& map_;
  LogOdds lowest_;
  ProbabilityByte byte_;
  PageBuilder builder_;
  std::size_t cells_ = 0;
};

/// Calls visit(node, key) for the nodes of the size of a page, and leaves above them once for each of their pages.
template <class Visit>
void for_each_page(const OccupancyMap& map, LogOdds lowest, const NodeView& node, const WideKey& key, int levels,
                   Visit&& visit) {
  if (levels <= kPageLevels) {
    visit(node, key);
    return;
  }
  if ((node.is_leaf() || map.options().parents == Parents::kMax) && node.belief() < lowest) return;
  const WideWord half = WideWord{1} << (levels - 1);
  for (int octant = 0; octant < 8; ++octant) {
    const auto step = [&](int axis) { return ((octant >> axis) & 1) != 0 ? half : WideWord{0}; };
    const WideKey below{key.x + step(0), key.y + step(1), key.z + step(2)};
    const std::optional<NodeView> child = node.is_leaf() ? std::optional(node) : node.child(octant);
    if (child) for_each_page(map, lowest, *child, below, levels - 1, visit);
  }
}

Error too_many_live_cells() {
  return {Error::Code::kLimit, "the map has more cells than a browser can show"};
}

}  // namespace

bool has_pages(const Lattice& lattice) {
  return lattice.depth() > kPageLevels;
}

Result<CellChanges> changed_cells(const OccupancyMap& map, const ChangedPages::Taken& changed) {
  CellChanges changes{changed.all, {}};
  PageWalk walk(map, LogOdds::from_probability(lowest_probability(map)));
  const int page_depth = map.lattice().depth() - kPageLevels;
  const auto add = [&](const NodeView& node, const WideKey& key) {
    const std::optional<PagePlace> place = page_place(map.lattice(), key);
    if (!place || walk.cells() > kMaxCells) return;
    PageCells page = walk.cells_of(node, *place);
    if (!page.bricks.empty() || !changes.is_whole) changes.pages.push_back(std::move(page));
  };
  if (changes.is_whole) {
    const LogOdds lowest = LogOdds::from_probability(lowest_probability(map));
    if (const std::optional<NodeView> root = map.root())
      for_each_page(map, lowest, *root, {}, map.lattice().depth(), add);
  }
  for (const WideKey& key : changed.lowest) {
    const std::optional<NodeView> node = map.node_at(key, page_depth);
    if (node) add(*node, key);
  }
  if (walk.cells() > kMaxCells) return tl::unexpected(too_many_live_cells());
  return changes;
}

LiveCells::LiveCells(const OccupancyMap& map)
    : lowest_(static_cast<float>(lowest_probability(map))),
      resolution_m_(static_cast<float>(map.lattice().resolution_m())) {}

void LiveCells::apply(const CellChanges& changes) {
  const std::uint32_t before = newest_;
  const std::uint32_t newest_version = newest_ == kNone ? 0 : bricks_[newest_].version;
  ++version_;
  std::unordered_map<PagePlace, bool, Hash> there;
  for (const PageCells& page : changes.pages) {
    if (changes.is_whole) there.emplace(page.place, true);
    const auto known = pages_.find(page.place);
    if (known == pages_.end() && page.bricks.empty()) continue;
    Page& to = known != pages_.end() ? known->second : pages_[page.place];
    std::size_t next = 0;
    for (std::size_t i = 0; i < kBricksInPage; ++i) {
      const bool has = next < page.bricks.size() && page.bricks[next].place == i;
      const auto brick = static_cast<std::uint8_t>(i);
      set(page.place, to, brick, has ? page.bricks[next] : PageCells::Brick{.place = brick});
      next += has ? 1 : 0;
    }
  }
  if (changes.is_whole) {
    for (auto& [place, page] : pages_) {
      if (there.contains(place)) continue;
      for (std::size_t i = 0; i < kBricksInPage; ++i) {
        const auto brick = static_cast<std::uint8_t>(i);
        set(place, page, brick, {.place = brick});
      }
    }
  }
  const bool is_same = newest_ == before && (newest_ == kNone || bricks_[newest_].version == newest_version);
  if (is_same) --version_;
}

/// Sets the cells of a brick, which has the version then if they are others.
void LiveCells::set(const PagePlace& place, Page& page, std::uint8_t brick, const PageCells::Brick& cells) {
  std::uint32_t& index = page.bricks[brick];
  if (index == kNone && cells.mask == 0) return;
  if (index == kNone) {
    index = static_cast<std::uint32_t>(bricks_.size());
    const auto along = [&](std::int32_t of_page, int axis) { return 4 * of_page + (brick >> (2 * axis) & 3); };
    bricks_.push_back({{along(place.x, 0), along(place.y, 1), along(place.z, 2)}, {.place = brick}});
  } else if (bricks_[index].cells == cells) {
    return;
  }
  cells_ += static_cast<std::size_t>(std::popcount(cells.mask));
  cells_ -= static_cast<std::size_t>(std::popcount(bricks_[index].cells.mask));
  bricks_[index].cells = cells;
  bricks_[index].version = version_;
  move_to_end(index);
}

/// Of the order of changes.
void LiveCells::move_to_end(std::uint32_t index) {
  if (newest_ == index) return;
  Brick& brick = bricks_[index];
  const bool is_linked = brick.before != kNone || brick.after != kNone || oldest_ == index;
  if (is_linked) {
    (brick.before != kNone ? bricks_[brick.before].after : oldest_) = brick.after;
    bricks_[brick.after].before = brick.before;
  }
  brick.before = newest_;
  brick.after = kNone;
  (newest_ != kNone ? bricks_[newest_].after : oldest_) = index;
  newest_ = index;
}

Bytes LiveCells::all() const {
  std::vector<std::uint32_t> there;
  for (std::uint32_t i = 0; i < bricks_.size(); ++i) {
    if (bricks_[i].cells.mask != 0) there.push_back(i);
  }
  return bytes_of(there, Part::kAll);
}

Bytes LiveCells::since(std::uint32_t version) const {
  if (version > version_) return all();
  std::vector<std::uint32_t> changed;
  for (std::uint32_t i = newest_; i != kNone && bricks_[i].version > version; i = bricks_[i].before) {
    changed.push_back(i);
  }
  return bytes_of(changed, Part::kChanges);
}

Bytes LiveCells::bytes_of(const std::vector<std::uint32_t>& bricks, Part part) const {
  std::size_t cells = 0;
  for (const std::uint32_t i : bricks) cells += static_cast<std::size_t>(std::popcount(bricks_[i].cells.mask));
  constexpr std::size_t kHeaderBytes = 32, kBrickBytes = 20;
  ByteColumns out;
  out.reserve(kHeaderBytes + bricks.size() * kBrickBytes + cells + 4);
  out.put(kCellsMagic);
  out.put(static_cast<std::uint32_t>(bricks.size()));
  out.put(static_cast<std::uint32_t>(cells));
  out.put(version_);
  out.put(lowest_);
  out.put(resolution_m_);
  out.put(std::uint32_t{part == Part::kChanges ? 1U : 0U});
  out.put(std::uint32_t{0});
  for (const std::size_t axis : {0U, 1U, 2U}) {
    out.put(bricks, [&](std::uint32_t i) { return bricks_[i].place[axis]; });
  }
  out.put(bricks, [&](std::uint32_t i) { return static_cast<std::uint32_t>(bricks_[i].cells.mask); });
  out.put(bricks, [&](std::uint32_t i) { return static_cast<std::uint32_t>(bricks_[i].cells.mask >> 32); });
  for (const std::uint32_t i : bricks) {
    const PageCells::Brick& brick = bricks_[i].cells;
    for (std::uint64_t left = brick.mask; left != 0; left &= left - 1) {
      out.put(brick.byte[static_cast<std::size_t>(std::countr_zero(left))]);
    }
  }
  out.align();
  return out.take();
}

std::size_t LiveCells::Hash::operator()(const PagePlace& place) const {
  constexpr std::uint64_t kX = 0x9E3779B97F4A7C15, kY = 0xC2B2AE3D27D4EB4F, kZ = 0x165667B19E3779F9;
  const auto word = [](std::int32_t axis) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(axis)); };
  const std::uint64_t mixed = word(place.x) * kX ^ word(place.y) * kY ^ word(place.z) * kZ;
  return static_cast<std::size_t>(mixed ^ mixed >> 32);
}

}  // namespace pingvox::web
