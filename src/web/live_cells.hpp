#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pingvox/map/changed_pages.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"
#include "pingvox/web/scene_bytes.hpp"

namespace pingvox::web {

/// A page of a map by its number on each axis, counted from the origin.
struct PagePlace {
  std::int32_t x = 0, y = 0, z = 0;
  friend bool operator==(const PagePlace&, const PagePlace&) = default;
};

/// The cells of a page (ScanUpdate::Page: 4 x 4 x 4 bricks) that may be occupied.
struct PageCells {
  struct Brick {
    std::uint8_t place = 0;                  ///< x + 4 y + 16 z in the page
    std::uint64_t mask = 0;                  ///< bit x + 4 y + 16 z in the brick; not 0
    std::array<std::uint8_t, 64> byte = {};  ///< round(255 p), by bits; 0 where there is no cell
    friend bool operator==(const Brick&, const Brick&) = default;
  };
  PagePlace place;
  std::vector<Brick> bricks;
};

/// Pages of a map as they are now.
struct CellChanges {
  bool is_whole = false;         ///< all other pages are empty
  std::vector<PageCells> pages;  ///< without is_whole also empty ones
};

/// Whether the pages of a map of so many levels are those of `ChangedPages`, as counted from the origin.
bool has_pages(const Lattice& lattice);

/// What has changed in a map. Pages more than 2^27 from the origin are left out.
/// @return kLimit when there are more cells than kMaxCells. REQUIRES has_pages
Result<CellChanges> changed_cells(const OccupancyMap& map, const ChangedPages::Taken& changed);

/// The cells of a map as clients know them. Each change has a version, so that a client can be sent what has changed
/// since the version it knows. Bricks that became empty are kept.
class LiveCells {
 public:
  /// @param map  for its resolution and thresholds
  explicit LiveCells(const OccupancyMap& map);

  std::uint32_t version() const { return version_; }
  std::size_t cells() const { return cells_; }

  /// Begins the next version, if something has changed.
  void apply(const CellChanges& changes);
  /// As `map/N/cells`, with the version.
  Bytes all() const;
  /// The same of the bricks that have changed since a version, empty ones included. A version that does not exist yet:
  /// all, as `all`.
  Bytes since(std::uint32_t version) const;

 private:
  struct Hash {
    std::size_t operator()(const PagePlace& place) const;
  };
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  struct Brick {
    std::array<std::int32_t, 3> place;
    PageCells::Brick cells;
    std::uint32_t version = 0;
    /// Neighbours in the order of changes.
    std::uint32_t before = kNone, after = kNone;
  };
  struct Page {
    std::array<std::uint32_t, 64> bricks;  ///< indices
    Page() { bricks.fill(kNone); }
  };
  enum class Part { kAll, kChanges };

  void set(const PagePlace& place, Page& page, std::uint8_t brick, const PageCells::Brick& cells);
  void move_to_end(std::uint32_t index);
  Bytes bytes_of(const std::vector<std::uint32_t>& bricks, Part part) const;

  float lowest_, resolution_m_;
  std::uint32_t version_ = 1;
  std::size_t cells_ = 0;
  std::vector<Brick> bricks_;
  std::uint32_t oldest_ = kNone, newest_ = kNone;  ///< by their versions
  std::unordered_map<PagePlace, Page, Hash> pages_;
};

}  // namespace pingvox::web
