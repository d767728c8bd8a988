#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

#include "pingvox/web/scene_bytes.hpp"

namespace pingvox::web {

/// The first numbers of answers (docs/view.md).
inline constexpr std::uint32_t kCellsMagic = 0x43585650, kFreeMagic = 0x46585650, kPathMagic = 0x50585650,
                               kPointsMagic = 0x58585650, kBeamsMagic = 0x4c585650;

/// Appends numbers, little-endian.
class ByteColumns {
 public:
  template <class T>
    requires std::is_arithmetic_v<T>
  void put(T value) {
    std::array<std::uint8_t, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    if constexpr (std::endian::native != std::endian::little) std::ranges::reverse(raw);
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
  }
  template <class T>
  void put(const std::vector<T>& column) {
    for (const T value : column) put(value);
  }
  /// A column of numbers of the items.
  template <class Items, class Number>
  void put(const Items& items, Number&& number_of) {
    for (const auto& item : items) put(number_of(item));
  }
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  /// Pads to a multiple of four bytes.
  void align() {
    while (bytes_.size() % 4 != 0) bytes_.push_back(0);
  }
  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

}  // namespace pingvox::web
