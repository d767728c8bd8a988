#include "map/pool.hpp"

#include <algorithm>
#include <limits>
#include <new>

// The thread sanitizer does not follow mremap: addresses that another arena once had look like races to it.
#if defined(__linux__) && !defined(PINGVOX_SANITIZE_THREAD)
#define PINGVOX_ARENA_MREMAP
#include <sys/mman.h>
#endif

namespace pingvox::detail {
namespace {

constexpr std::size_t kPage = 4096;

std::size_t whole_pages(std::size_t size) {
  return (size + kPage - 1) / kPage * kPage;
}

std::size_t room_for(std::size_t size, std::size_t had) {
  if (size > std::numeric_limits<std::size_t>::max() / 4) throw std::bad_alloc();
  return whole_pages(std::max(size, had + had / 2));
}

#ifdef PINGVOX_ARENA_MREMAP
constexpr std::size_t kHugePage = std::size_t{2} << 20;
/// What is filled from end to end is asked for in such steps, which costs a third of a page fault for each page.
constexpr std::size_t kAhead = std::size_t{64} << 10;
#endif

}  // namespace

#ifdef PINGVOX_ARENA_MREMAP

void Arena::grow(std::size_t size) {
  if (size <= size_) return;
  if (size > room_) {
    const std::size_t room = room_for(size, room_);
    void* const place = data_ == nullptr
                            ? mmap(nullptr, room, PROT_READ | PROT_WRITE,
                                   MAP_PRIVATE | MAP_ANONYMOUS | (pages_ == Pages::kSmall ? MAP_NORESERVE : 0), -1, 0)
                            : mremap(data_, room_, room, MREMAP_MAYMOVE);
    if (place == MAP_FAILED) throw std::bad_alloc();
    data_ = static_cast<std::byte*>(place);
    room_ = room;
  }
  if (pages_ == Pages::kSmall) {
    size_ = room_;
  } else if (room_ >= kHugePage) {
    // Only advice, here and below: where it is not taken, nothing is lost but speed.
    madvise(data_, room_, MADV_HUGEPAGE);
    size_ = room_;
  } else {
    const std::size_t ready = std::exchange(size_, std::min(room_, whole_pages(std::max(size, size_ + kAhead))));
#ifdef MADV_POPULATE_WRITE
    madvise(data_ + ready, size_ - ready, MADV_POPULATE_WRITE);
#endif
  }
}

Arena::~Arena() {
  if (data_ != nullptr) munmap(data_, room_);
}

#else

void Arena::grow(std::size_t size) {
  if (size <= size_) return;
  const std::size_t room = room_for(size, size_);
  auto* const place = static_cast<std::byte*>(::operator new(room, std::align_val_t{kPage}));
  if (data_ != nullptr) {
    std::memcpy(place, data_, size_);
    ::operator delete(data_, std::align_val_t{kPage});
  }
  std::memset(place + size_, 0, room - size_);
  data_ = place;
  size_ = room_ = room;
}

Arena::~Arena() {
  ::operator delete(data_, std::align_val_t{kPage});
}

#endif

}  // namespace pingvox::detail
