#include "pingvox/map/scan_window.hpp"

#include <cassert>

namespace pingvox::detail {

void ScanWindow::open(int bits) {
  assert(bits >= 4 && bits <= kMostBits);
  bits_ = bits;
  const std::size_t bytes = (std::size_t{1} << (3 * bits)) / 8;
  missed_.grow(bytes);
  hit_.grow(bytes);
  asked_.grow(bytes);
  touched_.grow(pages());
}

}  // namespace pingvox::detail
