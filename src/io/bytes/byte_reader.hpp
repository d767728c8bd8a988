#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <type_traits>

namespace pingvox {

/// Decodes an arithmetic value. REQUIRES sizeof(T) bytes.
template <class T>
  requires std::is_arithmetic_v<T>
T value_from(std::span<const std::uint8_t> bytes, std::endian order) {
  std::array<std::uint8_t, sizeof(T)> raw;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    raw[i] = bytes[order == std::endian::native ? i : sizeof(T) - 1 - i];
  }
  T value;
  std::memcpy(&value, raw.data(), sizeof(T));
  return value;
}

/// A little-endian value inside of bytes. REQUIRES at least place + 2 bytes.
inline std::uint16_t u16_at(std::span<const std::uint8_t> bytes, std::size_t place) {
  return value_from<std::uint16_t>(bytes.subspan(place, 2), std::endian::little);
}

/// Reads forward through bytes, with bounds checks.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes, std::endian order = std::endian::little)
      : bytes_(bytes), order_(order) {}

  std::size_t position() const { return position_; }
  std::size_t left() const { return bytes_.size() - position_; }

  /// The next `count` bytes; nullopt, and nothing read, when there are fewer.
  std::optional<std::span<const std::uint8_t>> take(std::uint64_t count) {
    if (count > left()) return std::nullopt;
    const auto taken = bytes_.subspan(position_, static_cast<std::size_t>(count));
    position_ += taken.size();
    return taken;
  }

  /// The next value; nullopt, and nothing read, when too few bytes are left.
  template <class T>
  std::optional<T> read() {
    const auto bytes = take(sizeof(T));
    if (!bytes) return std::nullopt;
    return value_from<T>(*bytes, order_);
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::endian order_;
  std::size_t position_ = 0;
};

}  // namespace pingvox
