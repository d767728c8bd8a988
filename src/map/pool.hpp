#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <new>
#include <type_traits>
#include <utility>

namespace pingvox::detail {

/// A growing array of bytes, page-aligned and zeroed. Growing keeps the content and may move it; reserved bytes that
/// were never touched take no memory, except a step of 64 KB that is populated in advance. On Linux it asks for huge
/// pages and grows without copying.
class Arena {
 public:
  enum class Pages {
    kHuge,   ///< for arrays that are filled from end to end
    kSmall,  ///< for arrays that are touched sparsely
  };

  explicit Arena(Pages pages = Pages::kHuge) : pages_(pages) {}
  Arena(Arena&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)),
        size_(std::exchange(other.size_, 0)),
        room_(std::exchange(other.room_, 0)),
        pages_(other.pages_) {}
  Arena& operator=(Arena&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(room_, other.room_);
    std::swap(pages_, other.pages_);
    return *this;
  }
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;
  ~Arena();

  std::byte* data() const { return data_; }
  std::size_t size() const { return size_; }
  /// Makes it at least `size` bytes. Throws std::bad_alloc.
  void grow(std::size_t size);

 private:
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;  ///< that may be used
  std::size_t room_ = 0;  ///< of addresses: what is behind size_ was never touched
  Pages pages_;
};

/// Fixed-size records addressed by 32-bit index from 2 on (0 and 1 mean something else to Entry). Freed ones are
/// reused. References last until the next allocate().
template <class T>
class Pool {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) >= sizeof(std::uint32_t));

 public:
  static constexpr std::uint32_t kFirst = 2;

  Pool() = default;
  Pool(const Pool& other) : used_(other.used_), free_(other.free_), free_count_(other.free_count_) {
    if (other.used_ == kFirst) return;
    arena_.grow(used_ * sizeof(T));
    std::memcpy(arena_.data(), other.arena_.data(), used_ * sizeof(T));
  }
  Pool(Pool&& other) noexcept
      : arena_(std::move(other.arena_)),
        used_(std::exchange(other.used_, kFirst)),
        free_(std::exchange(other.free_, 0)),
        free_count_(std::exchange(other.free_count_, 0)) {}
  Pool& operator=(Pool other) noexcept {
    arena_ = std::move(other.arena_);
    used_ = other.used_;
    free_ = other.free_;
    free_count_ = other.free_count_;
    return *this;
  }
  ~Pool() = default;

  T& operator[](std::uint32_t index) {
    assert(index >= kFirst && index < used_);
    return reinterpret_cast<T*>(arena_.data())[index];
  }
  const T& operator[](std::uint32_t index) const {
    assert(index >= kFirst && index < used_);
    return reinterpret_cast<const T*>(arena_.data())[index];
  }

  /// The records by index; the first kFirst are none.
  const T* data() const { return reinterpret_cast<const T*>(arena_.data()); }

  /// A new record with this content. Throws std::bad_alloc.
  std::uint32_t allocate(const T& content) {
    std::uint32_t index = free_;
    if (index != 0) {
      std::memcpy(&free_, &(*this)[index], sizeof free_);
      --free_count_;
    } else {
      if (used_ == std::numeric_limits<std::uint32_t>::max()) throw std::bad_alloc();
      const std::size_t needed = (std::size_t{used_} + 1) * sizeof(T);
      if (needed > arena_.size()) arena_.grow(needed);
      index = used_++;
    }
    (*this)[index] = content;
    return index;
  }

  void release(std::uint32_t index) {
    std::memcpy(static_cast<void*>(&(*this)[index]), &free_, sizeof free_);
    free_ = index;
    ++free_count_;
  }

  /// Records that `allocate` would hand out without growing.
  std::size_t spare() const { return free_count_; }
  /// Bytes of records that were ever handed out: the memory that the pool really takes.
  std::size_t bytes() const { return (used_ - kFirst) * sizeof(T); }

 private:
  Arena arena_;
  std::uint32_t used_ = kFirst;
  std::uint32_t free_ = 0;  ///< head of the list of freed records, linked through their first bytes
  std::size_t free_count_ = 0;
};

}  // namespace pingvox::detail
