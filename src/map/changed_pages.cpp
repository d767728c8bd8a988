#include "pingvox/map/changed_pages.hpp"

#include <cstdint>

#include "pingvox/map/scan_update.hpp"

namespace pingvox {

void ChangedPages::add(const ScanUpdate& scan) {
  if (all_) return;
  for (const std::uint32_t index : scan.pages_in_order()) lowest_.insert(scan.page(index).lowest);
}

void ChangedPages::add_all() {
  all_ = true;
  lowest_.clear();
}

ChangedPages::Taken ChangedPages::take() {
  Taken taken{std::exchange(all_, false), {lowest_.begin(), lowest_.end()}};
  lowest_.clear();
  return taken;
}

std::size_t ChangedPages::Hash::operator()(const WideKey& key) const {
  constexpr std::uint64_t kX = 0x9E3779B97F4A7C15, kY = 0xC2B2AE3D27D4EB4F, kZ = 0x165667B19E3779F9;
  const auto page = [](WideWord word) { return static_cast<std::uint64_t>(word >> ScanUpdate::kPageBits); };
  const std::uint64_t mixed = page(key.x) * kX ^ page(key.y) * kY ^ page(key.z) * kZ;
  return static_cast<std::size_t>(mixed ^ mixed >> 32);
}

}  // namespace pingvox
