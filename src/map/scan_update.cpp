#include "pingvox/map/scan_update.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "geometry/internal/tree_order.hpp"
#include "map/bits.hpp"

namespace pingvox {
namespace {

using detail::for_each_bit;

constexpr std::uint32_t kFree = 0;

std::size_t hash_of(const WideKey& key) {
  // Neighbouring pages must spread: multiply each component by a different odd constant, and take the high bits.
  const auto mix = [](WideWord word, std::uint64_t factor) {
    word >>= ScanUpdate::kPageBits;
    return (static_cast<std::uint64_t>(word) ^ static_cast<std::uint64_t>(word >> 64)) * factor;
  };
  const std::uint64_t sum =
      mix(key.x, 0x9E3779B97F4A7C15U) + mix(key.y, 0xC2B2AE3D27D4EB4FU) + mix(key.z, 0x165667B19E3779F9U);
  return static_cast<std::size_t>(sum ^ (sum >> 29));
}

}  // namespace

std::size_t ScanUpdate::slot_of(const WideKey& lowest) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hash_of(lowest) & mask;
  while (slots_[slot] != kFree && pages_[slots_[slot] - 1].lowest != lowest) slot = (slot + 1) & mask;
  return slot;
}

void ScanUpdate::hash_pages() {
  // At most half of the slots are taken, with the one that is to come.
  const std::size_t needed = std::max<std::size_t>(64, std::bit_ceil(2 * (used_ + 1)));
  if (slots_.size() < needed) {
    slots_.assign(needed, kFree);
    hashed_ = 0;
  }
  for (; hashed_ < used_; ++hashed_) slots_[slot_of(pages_[hashed_].lowest)] = static_cast<std::uint32_t>(hashed_ + 1);
}

std::uint32_t ScanUpdate::page_at(const WideKey& key) {
  const auto lowest = [](WideWord word) { return word >> kPageBits << kPageBits; };
  const WideKey corner{lowest(key.x), lowest(key.y), lowest(key.z)};
  hash_pages();
  const std::size_t slot = slot_of(corner);
  return slots_[slot] != kFree ? slots_[slot] - 1 : add_page(corner);
}

inline std::uint32_t ScanUpdate::add_page(const WideKey& lowest) {
  if (used_ == pages_.size()) pages_.emplace_back();
  pages_[used_].lowest = lowest;
  return static_cast<std::uint32_t>(used_++);
}

void ScanUpdate::spread_evidence(Page& page, std::size_t brick) {
  if (evidence_used_ == evidence_.size()) evidence_.emplace_back();
  page.evidence[brick] = static_cast<std::uint32_t>(evidence_used_++);
  std::array<float, 64>& evidence = evidence_[page.evidence[brick]];
  evidence.fill(std::numeric_limits<float>::lowest());
  for (std::size_t cell = 0; cell < 64; ++cell) {
    if (((page.hit[brick] >> cell) & 1) != 0) evidence[cell] = usual_hit_.value();
  }
}

void ScanUpdate::add(const ScanUpdate& other) {
  assert(other.lattice_ == lattice_ && other.miss_ == miss_);
  for (std::size_t i = 0; i < other.used_; ++i) {
    const Page& from = other.pages_[i];
    const std::uint32_t index = page_of(from.lowest);
    for_each_bit(from.bricks, [&](std::size_t brick) {
      mark_missed_in(index, brick, from.missed[brick]);
      if (from.hit[brick] == 0) return;
      const Hits evidence = other.hits(from, brick);
      if (evidence.of_cell == nullptr) {
        mark_hit_in(index, brick, from.hit[brick], evidence.all);
        return;
      }
      for_each_bit(from.hit[brick],
                   [&](std::size_t cell) { mark_hit(index, brick * 64 + cell, LogOdds(evidence.of_cell[cell])); });
    });
  }
}

void ScanUpdate::mark_missed_in(std::uint32_t page, std::span<const std::uint64_t, 64> cells_of_bricks) {
  Page& in = pages_[page];
  std::uint64_t bricks = 0;
  for (std::size_t octant = 0; octant < 64; octant += 8) {  // of a flat scan half have marks
    const auto words = cells_of_bricks.subspan(octant).first<8>();
    if (std::reduce(words.begin(), words.end(), std::uint64_t{0}, std::bit_or()) == 0) continue;
    for (std::size_t i = 0; i < 8; ++i) {
      if (words[i] == 0) continue;
      in.missed[octant + i] |= words[i];
      bricks |= std::uint64_t{1} << (octant + i);
    }
  }
  in.bricks |= bricks;
}

void ScanUpdate::clear() {
  // A scan that was moved from has no pages.
  for (std::size_t i = 0; i < std::min(used_, pages_.size()); ++i) {
    Page& page = pages_[i];
    const std::uint64_t bricks = std::exchange(page.bricks, 0);
    for (std::size_t octant = 0; octant < 8; ++octant) {  // of a flat scan half have marks
      if ((bricks >> (8 * octant) & 0xFF) != 0) std::fill_n(&page.missed[8 * octant], 8, 0);
    }
    for_each_bit(std::exchange(page.bricks_hit, 0), [&](std::size_t brick) { page.hit[brick] = 0; });
  }
  used_ = 0;
  evidence_used_ = 0;
  has_hits_ = false;
  if (hashed_ > 0) std::fill(slots_.begin(), slots_.end(), kFree);
  hashed_ = 0;
}

std::vector<std::uint32_t> ScanUpdate::pages_in_order() const {
  std::vector<std::uint32_t> order(used_);
  std::iota(order.begin(), order.end(), 0U);
  if (lattice_.depth() > kPageBits + 21) {
    std::sort(order.begin(), order.end(),
              [this](std::uint32_t a, std::uint32_t b) { return pages_[a].lowest < pages_[b].lowest; });
    return order;
  }
  std::vector<std::uint64_t> code(used_);
  for (std::size_t i = 0; i < used_; ++i) {
    const WideKey& lowest = pages_[i].lowest;
    code[i] = detail::code_of(WideKey{lowest.x >> kPageBits, lowest.y >> kPageBits, lowest.z >> kPageBits});
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return code[a] < code[b]; });
  return order;
}

}  // namespace pingvox
