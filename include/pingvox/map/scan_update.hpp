#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pingvox/geometry/key.hpp"
#include "pingvox/geometry/lattice.hpp"
#include "pingvox/map/log_odds.hpp"

namespace pingvox {

/// Cell updates of one scan (a sweep, a beam, a cloud): the cells that sound passed through and those it came back
/// from. Each cell is updated once: a hit beats a miss, and of several hits the one with the most evidence counts.
/// Marks go into bit masks, so overlapping rays cost nothing and nothing is hashed but one page in 4096 cells.
class ScanUpdate {
 public:
  /// A cube of 16^3 cells: 4^3 bricks of 4^3 cells. Brick o * 8 + i, like cells in a brick, is in the tree's order.
  static constexpr int kPageBits = 4;
  struct Page {
    WideKey lowest;                ///< its lowest cell
    std::uint64_t bricks = 0;      ///< a bit for each brick that has marks: of a flat scan few have
    std::uint64_t bricks_hit = 0;  ///< for each with hits
    std::array<std::uint64_t, 64> missed{};
    std::array<std::uint64_t, 64> hit{};
    std::array<std::uint32_t, 64> evidence{};  ///< of a brick's hits (`hits`); valid where hit != 0
  };
  /// Evidence for the hits of a brick.
  struct Hits {
    const float* of_cell = nullptr;  ///< 64 of them, valid where a bit of `hit` is set; nullptr: all alike
    LogOdds all{};
  };

  /// @param lattice  of the map to update: other maps refuse the scan
  /// @param miss     evidence for a cell that sound passed through
  explicit ScanUpdate(const Lattice& lattice, LogOdds miss = LogOdds::from_probability(0.4))
      : lattice_(lattice), miss_(miss) {}

  /// Number of a cell in its page: brick * 64 + cell in the brick.
  template <KeyWord W>
  static constexpr std::size_t cell_in_page(const BasicKey<W>& key) {
    return static_cast<std::size_t>(((key.octant(3) * 8 + key.octant(2)) * 8 + key.octant(1)) * 8 + key.octant(0));
  }

  template <KeyWord W>
  void add_miss(const BasicKey<W>& key) {
    mark_missed(page_of(key.template as<WideWord>()), cell_in_page(key));
  }
  template <KeyWord W>
  void add_hit(const BasicKey<W>& key, LogOdds evidence) {
    mark_hit(page_of(key.template as<WideWord>()), cell_in_page(key), evidence);
  }

  /// Index of a page, which is created if needed: for tracers that stay in it for many cells.
  std::uint32_t page_of(const WideKey& key) {
    const auto page = [](WideWord word) { return static_cast<std::size_t>(word >> kPageBits); };
    const std::size_t x = page(key.x) ^ page(key.z) << 2, y = page(key.y) ^ page(key.z);
    std::uint32_t& recent = recent_[(x & 15U) | (y & 15U) << 4];
    if (recent >= used_ || !is_in(pages_[recent], key)) recent = page_at(key);
    return recent;
  }
  void mark_missed(std::uint32_t page, std::size_t cell) {
    mark_missed_in(page, cell / 64, std::uint64_t{1} << (cell % 64));
  }
  /// Marks cells of a brick as missed: a bit each.
  void mark_missed_in(std::uint32_t page, std::size_t brick, std::uint64_t cells) {
    Page& in = pages_[page];
    in.bricks |= std::uint64_t{1} << brick;
    in.missed[brick] |= cells;
  }
  /// The same for all bricks of a page, a word each, for tracers of many rays.
  void mark_missed_in(std::uint32_t page, std::span<const std::uint64_t, 64> cells_of_bricks);
  void mark_hit(std::uint32_t page, std::size_t cell, LogOdds evidence) {
    mark_hit_in(page, cell / 64, std::uint64_t{1} << (cell % 64), evidence);
  }
  /// Marks cells of a brick as hit: a bit each.
  void mark_hit_in(std::uint32_t page, std::size_t brick, std::uint64_t cells, LogOdds evidence) {
    Page& in = pages_[page];
    if (!has_hits_) usual_hit_ = evidence;
    has_hits_ = true;
    if (in.hit[brick] == 0) in.evidence[brick] = kUsual;
    if (in.evidence[brick] == kUsual && evidence != usual_hit_) spread_evidence(in, brick);
    in.bricks |= std::uint64_t{1} << brick;
    in.bricks_hit |= std::uint64_t{1} << brick;
    in.hit[brick] |= cells;
    if (in.evidence[brick] == kUsual) return;
    for (std::uint64_t left = cells; left != 0; left &= left - 1) {
      float& greatest = evidence_[in.evidence[brick]][static_cast<std::size_t>(std::countr_zero(left))];
      greatest = std::max(greatest, evidence.value());
    }
  }

  const Lattice& lattice() const { return lattice_; }
  LogOdds miss() const { return miss_; }
  bool empty() const { return used_ == 0; }
  /// Removes all marks and keeps the memory for the next scan.
  void clear();

  /// Adds all marks of another scan, such as the part that another thread has traced.
  /// REQUIRES the same lattice and evidence of misses.
  void add(const ScanUpdate& other);

  /// The pages in the tree's order; in lattices of more than 25 levels by x, y, z: their numbers have more than 64
  /// bits.
  std::vector<std::uint32_t> pages_in_order() const;
  const Page& page(std::uint32_t index) const { return pages_[index]; }
  /// REQUIRES hits in the brick.
  Hits hits(const Page& page, std::size_t brick) const {
    const std::uint32_t at = page.evidence[brick];
    return at == kUsual ? Hits{nullptr, usual_hit_} : Hits{evidence_[at].data(), {}};
  }

 private:
  /// Instead of a place in evidence_: each hit of the brick has the evidence usual_hit_.
  static constexpr std::uint32_t kUsual = 0xFFFFFFFF;

  /// Gives the hits of a brick evidence of their own.
  void spread_evidence(Page& page, std::size_t brick);
  static bool is_in(const Page& page, const WideKey& key) {
    return ((page.lowest.x ^ key.x) | (page.lowest.y ^ key.y) | (page.lowest.z ^ key.z)) >> kPageBits == 0;
  }
  std::uint32_t page_at(const WideKey& key);
  /// REQUIRES that there is none at this place.
  std::uint32_t add_page(const WideKey& lowest);
  void hash_pages();
  std::size_t slot_of(const WideKey& lowest) const;

  Lattice lattice_;
  LogOdds miss_;
  std::vector<Page> pages_;  ///< the first used_ are in use, the others have no marks
  std::size_t used_ = 0;
  std::vector<std::array<float, 64>> evidence_;
  std::size_t evidence_used_ = 0;
  bool has_hits_ = false;
  LogOdds usual_hit_{};  ///< of the first hit: most scans have no other
  /// Pages that were asked for, by the lowest bits of their place: neighbours are asked for again and again.
  std::array<std::uint32_t, 256> recent_{};
  std::vector<std::uint32_t> slots_;  ///< open addressing by lowest cell: index of the page + 1, 0 is free
  std::size_t hashed_ = 0;            ///< the first so many pages are in slots_: the others when one is looked up
};

}  // namespace pingvox
