#pragma once

#include <zlib.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ostream>
#include <string_view>
#include <type_traits>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox {

/// Writes little-endian values to a stream, buffered.
class ByteWriter {
 public:
  explicit ByteWriter(std::ostream& out) : out_(out) { buffer_.reserve(kPiece + 64); }

  template <class T>
    requires std::is_arithmetic_v<T>
  void put(T value) {
    std::array<std::uint8_t, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      buffer_.push_back(raw[std::endian::native == std::endian::little ? i : sizeof(T) - 1 - i]);
    }
    if (buffer_.size() >= kPiece) drain();
  }
  void put(std::string_view text) {
    drain();
    buffer_.assign(text.begin(), text.end());
    drain();
  }

  /// CRC-32 (zlib) of all bytes so far.
  std::uint32_t crc32() {
    drain();
    return static_cast<std::uint32_t>(crc_);
  }

  /// @return kIo when the stream failed
  Result<void> finish() {
    drain();
    out_.flush();
    if (!out_) return fail(Error::Code::kIo, "the map could not be written");
    return {};
  }

 private:
  static constexpr std::size_t kPiece = std::size_t{1} << 16;

  void drain() {
    crc_ = crc32_z(crc_, buffer_.data(), buffer_.size());
    out_.write(reinterpret_cast<const char*>(buffer_.data()), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }

  std::ostream& out_;
  std::vector<std::uint8_t> buffer_;
  uLong crc_ = crc32_z(0, nullptr, 0);
};

}  // namespace pingvox
