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

/// Reads forward through a stream and holds no more of it than is asked for.
class StreamReader {
 public:
  explicit StreamReader(ByteStream stream) : stream_(std::move(stream)) {}

  const std::string& name() const { return stream_.name(); }
  /// The next `count` bytes, or as many as there are; they stay until the next call.
  Result<std::span<const std::uint8_t>> peek(std::size_t count);
  /// Goes on behind the next `count` bytes. REQUIRES that peek() showed them.
  void skip(std::size_t count);
  /// How many bytes were skipped so far.
  std::uint64_t position() const { return position_; }

  /// Skips the next line and gives it without its LF or CR LF, until the next call; nullopt: there is none. A line of
  /// more than kLongestLine comes in pieces.
  Result<std::optional<std::string_view>> next_line();
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20;
  /// Whether the last line had its end.
  bool line_has_end() const { return line_has_end_; }

  std::optional<double> share_read() const { return stream_.share_read(); }

 private:
  ByteStream stream_;
  std::vector<std::uint8_t> bytes_;
  std::size_t start_ = 0, end_ = 0;  ///< in bytes_: what was read and not skipped
  std::uint64_t position_ = 0;
  bool at_end_ = false;
  bool line_has_end_ = false;
};

}  // namespace pingvox
