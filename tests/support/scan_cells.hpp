#pragma once

#include <cstddef>
#include <cstdint>
#include <map>

#include "pingvox/map/scan_update.hpp"

namespace pingvox::test {

/// What a scan says of its cells: true where it hit, false where it only missed.
inline std::map<WideKey, bool> cells_of(const ScanUpdate& scan) {
  std::map<WideKey, bool> cells;
  for (const std::uint32_t index : scan.pages_in_order()) {
    const ScanUpdate::Page& page = scan.page(index);
    for (unsigned n = 0; n < 4096; ++n) {
      const WideKey key{page.lowest.x + n / 256, page.lowest.y + n / 16 % 16, page.lowest.z + n % 16};
      const std::size_t cell = ScanUpdate::cell_in_page(key);
      const std::uint64_t bit = std::uint64_t{1} << (cell % 64);
      const bool is_hit = (page.hit[cell / 64] & bit) != 0;
      if (is_hit || (page.missed[cell / 64] & bit) != 0) cells[key] = is_hit;
    }
  }
  return cells;
}

}  // namespace pingvox::test
