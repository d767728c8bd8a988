#include "pingvox/map/scan_window.hpp"

#include <cassert>

#include "map/dense_fan.hpp"
#include "map/tree_order.hpp"

namespace pingvox::detail {

void ScanWindow::open(int bits) {
  assert(bits >= 4 && bits <= kMostBits);
  bits_ = bits;
  const std::size_t bytes = (std::size_t{1} << (3 * bits)) / 8;
  missed_.grow(bytes);
  hit_.grow(bytes);
  asked_.grow(bytes);
  layer_.grow(layer_pages() * 4 * sizeof(std::uint64_t));
  touched_.grow(pages());
  with_hits_.grow(pages());
}

void ScanWindow::touch_layer() {
  if (!layer_z_) return;
  constexpr std::uint64_t kAllZ = kAxisBits[2];
  const std::uint64_t z = *layer_z_ >> kPageCellBits;
  std::uint64_t page = z;
  const std::uint64_t* words = layer();
  for (std::size_t left = layer_pages(); left > 0; --left, words += 4) {
    if ((words[0] | words[1] | words[2] | words[3]) != 0) touched()[page] |= kInLayer;
    page = (((page | kAllZ) + 1) & ~kAllZ) | z;
  }
}

FanRoom& ScanWindow::fan_room() {
  if (!fan_room_) fan_room_ = std::make_shared<FanRoom>();
  return *fan_room_;
}

}  // namespace pingvox::detail
