#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/io/byte_stream.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Reads forward through a stream, buffering only what is requested.
class StreamReader {
 public:
  explicit StreamReader(ByteStream stream) : stream_(std::move(stream)) {}

  const std::string& name() const { return stream_.name(); }
  /// The next `count` bytes, or fewer at the end; valid until the next call.
  Result<std::span<const std::uint8_t>> peek(std::size_t count);
  /// Skips `count` bytes. REQUIRES that peek() returned them.
  void skip(std::size_t count);
  /// As ByteStream::read_at().
  Result<std::size_t> read_at(std::uint64_t position, std::span<std::uint8_t> to) const {
    return stream_.read_at(position, to);
  }
  /// Number of bytes skipped so far.
  std::uint64_t position() const { return position_; }

  /// Skips and returns the next line without its LF or CR LF, valid until the next call; nullopt at the end. A line of
  /// more than kMaxLine bytes is returned in pieces.
  Result<std::optional<std::string_view>> next_line();
  static constexpr std::size_t kMaxLine = std::size_t{1} << 20;
  /// Whether the last line was terminated.
  bool line_has_end() const { return line_has_end_; }

  std::optional<double> share_read() const { return stream_.share_read(); }

 private:
  ByteStream stream_;
  std::vector<std::uint8_t> bytes_;
  std::size_t start_ = 0, end_ = 0;  ///< buffered part of bytes_
  std::uint64_t position_ = 0;
  bool at_end_ = false;
  bool line_has_end_ = false;
};

}  // namespace pingvox
