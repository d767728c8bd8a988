#include "cloud/scan_window.hpp"

#include <algorithm>
#include <cassert>
#include <new>

namespace pingvox::detail {

template <class T>
ScanWindow::Zeroed<T> ScanWindow::allocate_zeroed(std::size_t count) {
  auto* const memory = static_cast<T*>(std::calloc(count, sizeof(T)));  // NOLINT(cppcoreguidelines-no-malloc)
  if (memory == nullptr) throw std::bad_alloc();
  return Zeroed<T>(memory);
}

void ScanWindow::open(int bits) {
  assert(bits >= 4 && bits <= kMaxBits);
  if (bits > room_bits_) {
    drop();
    const std::size_t cells = std::size_t{1} << (3 * bits);
    // A few bytes at least: take_touched looks at eight at once.
    const std::size_t pages = std::max<std::size_t>(cells >> kPageCellBits, 8);
    missed_ = allocate_zeroed<std::uint64_t>(cells / 64);
    hit_ = allocate_zeroed<std::uint64_t>(cells / 64);
    touched_ = allocate_zeroed<std::uint8_t>(pages);
    with_hits_ = allocate_zeroed<std::uint8_t>(pages);
    room_bits_ = bits;
  }
  bits_ = bits;
}

}  // namespace pingvox::detail
