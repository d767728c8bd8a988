#include "cloud/scan_window.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cassert>
#include <new>

namespace pingvox::detail {

void Unmap::operator()(void* memory) const {
  munmap(memory, bytes);
}

void ScanWindow::open(int bits) {
  assert(bits >= 4 && bits <= kMaxBits);
  if (bits > room_bits_) {
    drop();
    const std::size_t words = std::size_t{1} << (3 * bits - 6);
    // A few bytes at least: take_touched looks at eight at once.
    const std::size_t pages = std::max<std::size_t>((words * 64) >> kPageCellBits, 8);
    const std::size_t bytes = 2 * (words * sizeof(std::uint64_t) + pages);
    void* const memory =
        mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    memory_ = std::unique_ptr<void, Unmap>(memory, Unmap{bytes});
    missed_ = static_cast<std::uint64_t*>(memory);
    hit_ = missed_ + words;
    touched_ = reinterpret_cast<std::uint8_t*>(hit_ + words);
    with_hits_ = touched_ + pages;
    room_bits_ = bits;
  }
  bits_ = bits;
}

}  // namespace pingvox::detail
