#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox {

/// Appends a value in little-endian order.
template <class T>
  requires std::is_arithmetic_v<T>
void append_little_endian(std::string& bytes, T value) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes.push_back(raw[std::endian::native == std::endian::little ? i : sizeof(T) - 1 - i]);
  }
}

/// What a channel of an MCAP file is made of.
struct McapChannel {
  std::string topic;
  std::string schema, schema_encoding, schema_data;
  std::string message_encoding;
  std::vector<std::pair<std::string, std::string>> metadata;
};

/// Writes an MCAP file: chunks compressed with zstd, an index of each, and a summary at the end.
class McapWriter {
 public:
  /// @param profile  "ros2", or empty
  McapWriter(std::ostream& out, std::string_view profile);

  /// @return its number, for `add`
  std::uint16_t add_channel(const McapChannel& channel);
  /// @param time_ns  when the message was made: since 1970, or on another clock that all messages share
  /// @return kNoMemory
  Result<void> add(std::uint16_t channel, std::uint64_t time_ns, std::string_view message);
  /// @return kIo when the stream failed
  Result<void> finish();

 private:
  struct ChunkPlace {
    std::uint64_t first_ns = 0, last_ns = 0, at = 0, bytes = 0, index_bytes = 0, compressed = 0, uncompressed = 0;
    std::map<std::uint16_t, std::uint64_t> indexes;
  };

  void write(std::string_view bytes);
  Result<void> finish_chunk();
  void write_summary();

  std::ostream& out_;
  std::uint64_t at_ = 0;
  std::uint32_t crc_ = 0;
  std::string chunk_;
  std::uint64_t first_ns_ = 0, last_ns_ = 0;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index_;  ///< times and offsets
  std::vector<ChunkPlace> chunks_;
  std::string schemas_, channels_;  ///< records, for the summary
  std::vector<std::uint64_t> messages_;
};

}  // namespace pingvox
