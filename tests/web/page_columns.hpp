#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

// Reads what the page reads, by the documented layout alone (docs/view.md).
namespace pingvox::test {

/// Takes numbers off bytes, one after the other.
class NumberReader {
 public:
  explicit NumberReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <class T>
  T take() {
    T value{};
    if (at_ + sizeof(T) > bytes_.size()) {
      ADD_FAILURE() << "the bytes end at " << at_;
      return value;
    }
    std::array<std::uint8_t, sizeof(T)> raw;
    for (std::size_t i = 0; i < sizeof(T); ++i) raw[i] = bytes_[at_ + i];
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    std::memcpy(&value, raw.data(), sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  template <class T>
  std::vector<T> take(std::size_t count) {
    EXPECT_EQ(at_ % 4, 0U) << "typed arrays need aligned columns";
    std::vector<T> column;
    for (std::size_t i = 0; i < count && at_ < bytes_.size(); ++i) column.push_back(take<T>());
    EXPECT_EQ(column.size(), count);
    return column;
  }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

using CellIndex = std::tuple<std::int64_t, std::int64_t, std::int64_t>;

struct ReadCells {
  std::uint32_t bricks = 0;
  float lowest = 0.0F, resolution_m = 0.0F;
  std::map<CellIndex, int> probability;  ///< by cell, counted from the origin
};

inline ReadCells read_cells(std::span<const std::uint8_t> bytes) {
  NumberReader in(bytes);
  EXPECT_EQ(in.take<std::uint32_t>(), 0x43585650U);
  ReadCells read;
  read.bricks = in.take<std::uint32_t>();
  const auto cells = in.take<std::uint32_t>();
  EXPECT_EQ(in.take<std::uint32_t>(), 1U);
  read.lowest = in.take<float>();
  read.resolution_m = in.take<float>();
  in.take<std::uint64_t>();
  const auto x = in.take<std::int32_t>(read.bricks), y = in.take<std::int32_t>(read.bricks),
             z = in.take<std::int32_t>(read.bricks);
  const auto low = in.take<std::uint32_t>(read.bricks), high = in.take<std::uint32_t>(read.bricks);
  const auto probability = in.take<std::uint8_t>(cells);
  std::size_t next = 0;
  for (std::size_t b = 0; b < read.bricks; ++b) {
    for (std::int64_t bit = 0; bit < 64; ++bit) {
      const std::uint32_t word = bit < 32 ? low[b] : high[b];
      if ((word >> (bit % 32) & 1) == 0) continue;
      const CellIndex cell{4 * std::int64_t{x[b]} + bit % 4, 4 * std::int64_t{y[b]} + bit / 4 % 4,
                           4 * std::int64_t{z[b]} + bit / 16};
      EXPECT_TRUE(read.probability.emplace(cell, probability.at(next)).second) << "a cell twice";
      ++next;
    }
  }
  EXPECT_EQ(next, cells);
  EXPECT_EQ(bytes.size() % 4, 0U);
  EXPECT_LT(in.left(), 4U);
  return read;
}

struct ReadCube {
  std::int64_t x, y, z, edge;
};

inline std::vector<ReadCube> read_cubes(std::span<const std::uint8_t> bytes) {
  NumberReader in(bytes);
  EXPECT_EQ(in.take<std::uint32_t>(), 0x46585650U);
  const auto count = in.take<std::uint32_t>();
  in.take<std::uint64_t>();
  const auto x = in.take<std::int32_t>(count), y = in.take<std::int32_t>(count), z = in.take<std::int32_t>(count);
  const auto edge = in.take<std::uint32_t>(count);
  EXPECT_EQ(in.left(), 0U);
  std::vector<ReadCube> cubes;
  for (std::size_t i = 0; i < count; ++i) cubes.push_back({x[i], y[i], z[i], edge[i]});
  return cubes;
}

/// An answer in an exported page, unpacked; empty: it is not there.
inline std::vector<std::uint8_t> answer_in_page(const std::string& html, const std::string& url) {
  const std::string begin = "<script type=\"application/octet-stream\" id=\"" + url + "\">";
  const std::size_t at = html.find(begin);
  if (at == std::string::npos) return {};
  const std::size_t end = html.find("</script>", at);
  const std::string_view text = std::string_view(html).substr(at + begin.size(), end - at - begin.size());
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> packed;
  std::uint32_t word = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    word = word << 6 | static_cast<std::uint32_t>(kDigits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    packed.push_back(static_cast<std::uint8_t>(word >> bits & 0xFF));
  }
  std::vector<std::uint8_t> bytes(std::size_t{1} << 26);
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, -15), Z_OK);
  stream.next_in = packed.data();
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = bytes.data();
  stream.avail_out = static_cast<uInt>(bytes.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END) << url;
  bytes.resize(stream.total_out);
  inflateEnd(&stream);
  return bytes;
}

}  // namespace pingvox::test
