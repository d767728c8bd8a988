#include "pingvox/map/scan_window.hpp"

#include <cassert>

#include "map/dense_fan.hpp"

namespace pingvox::detail {

void ScanWindow::open(int bits) {
  assert(bits >= 4 && bits <= kMostBits);
  bits_ = bits;
  const std::size_t bytes = (std::size_t{1} << (3 * bits)) / 8;
  missed_.grow(bytes);
  hit_.grow(bytes);
  asked_.grow(bytes);
  touched_.grow(pages());
  with_hits_.grow(pages());
}

FanRoom& ScanWindow::fan_room() {
  if (!fan_room_) fan_room_ = std::make_shared<FanRoom>();
  return *fan_room_;
}

}  // namespace pingvox::detail
