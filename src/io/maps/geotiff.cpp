#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/without_exceptions.hpp"
#include "io/bytes/byte_writer.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/grids.hpp"
#include "pingvox/nav/nav_trajectory.hpp"

// docs/formats.md: a header, strips of rows, then the directory of tags.
namespace pingvox {
namespace {

using TiffBytes = std::vector<std::uint8_t>;
template <class T>
void append(TiffBytes& bytes, T value) {
  std::array<std::uint8_t, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(raw);
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// A tag: what its number means and the type of its values are of the specification.
struct Tag {
  std::uint16_t number = 0, type = 0;
  std::uint32_t count = 0;
  TiffBytes bytes;
};

template <class T>
Tag tag_of(std::uint16_t number, const std::vector<T>& values) {
  constexpr std::uint16_t kAscii = 2, kShort = 3, kLong = 4, kDouble = 12;
  constexpr std::uint16_t kType = std::is_same_v<T, char>            ? kAscii
                                  : std::is_same_v<T, std::uint16_t> ? kShort
                                  : std::is_same_v<T, std::uint32_t> ? kLong
                                                                     : kDouble;
  Tag tag{number, kType, static_cast<std::uint32_t>(values.size()), {}};
  for (const T value : values) append(tag.bytes, value);
  return tag;
}
Tag tag_of(std::uint16_t number, std::string_view text) {
  std::vector<char> ended(text.begin(), text.end());
  ended.push_back('\0');
  return tag_of(number, ended);
}
Tag short_tag(std::uint16_t number, std::uint16_t value) {
  return tag_of(number, std::vector{value});
}
Tag long_tag(std::uint16_t number, std::size_t value) {
  return tag_of(number, std::vector{static_cast<std::uint32_t>(value)});
}

constexpr std::size_t kTiffHeader = 8;

/// The directory of a file whose strips end at `at`; the values that do not fit into it come behind it.
TiffBytes directory_of(const std::vector<Tag>& tags, std::size_t at) {
  constexpr std::size_t kEntry = 12, kFits = 4;
  TiffBytes entries, behind;
  append(entries, static_cast<std::uint16_t>(tags.size()));
  const std::size_t behind_at = at + 2 + tags.size() * kEntry + 4;
  for (const Tag& tag : tags) {
    TiffBytes values = tag.bytes;
    append(entries, tag.number);
    append(entries, tag.type);
    append(entries, tag.count);
    const bool fits = values.size() <= kFits;
    values.resize(fits ? kFits : (values.size() + 1) / 2 * 2);
    if (!fits) append(entries, static_cast<std::uint32_t>(behind_at + behind.size()));
    TiffBytes& place = fits ? entries : behind;
    place.insert(place.end(), values.begin(), values.end());
  }
  append(entries, std::uint32_t{0});  // no other picture
  entries.insert(entries.end(), behind.begin(), behind.end());
  return entries;
}

/// Rows from the top, compressed.
Result<TiffBytes> strip_of(const Raster<float>& raster, std::size_t first, std::size_t rows) {
  TiffBytes plain;
  plain.reserve(rows * raster.columns * sizeof(float));
  for (std::size_t row = first; row < first + rows; ++row) {
    for (std::size_t column = 0; column < raster.columns; ++column) {
      append(plain, raster.at(column, raster.rows - 1 - row));
    }
  }
  uLongf size = compressBound(static_cast<uLong>(plain.size()));
  TiffBytes packed(size);
  if (compress(packed.data(), &size, plain.data(), static_cast<uLong>(plain.size())) != Z_OK) {
    return fail(Error::Code::kNoMemory, "out of memory: the raster was not written");
  }
  packed.resize(size);
  return packed;
}

/// Tags that place the raster.
std::vector<Tag> place_of(const Raster<float>& raster, const std::optional<Eigen::Vector3d>& origin_fix) {
  constexpr std::uint16_t kPixelScale = 33550, kTiePoint = 33922, kGeoKeys = 34735;
  const Eigen::Vector2d upper_left_m =
      raster.corner_m + Eigen::Vector2d(0.0, static_cast<double>(raster.rows) * raster.cell_m);
  if (!origin_fix) {
    return {tag_of(kPixelScale, std::vector{raster.cell_m, raster.cell_m, 0.0}),
            tag_of(kTiePoint, std::vector{0.0, 0.0, 0.0, upper_left_m.x(), upper_left_m.y(), 0.0})};
  }
  // From longitude 0, so that a raster may reach beyond the longitude of 180 degrees.
  const Eigen::Vector3d origin(origin_fix->x(), 0.0, 0.0);
  const auto place = [&](const Eigen::Vector2d& at_m) -> Eigen::Vector3d {
    return fix_of_position({at_m.x(), at_m.y(), 0.0}, origin) / kDegree_rad;
  };
  const Eigen::Vector3d cell = place({raster.cell_m, raster.cell_m}) - origin / kDegree_rad;
  const Eigen::Vector3d upper_left = place(upper_left_m);
  // A directory of version 1.1.0 with four keys: what the model is, that pixels are areas, WGS 84, degrees.
  const double west = upper_left.y() + origin_fix->y() / kDegree_rad;
  return {tag_of(kPixelScale, std::vector{cell.y(), cell.x(), 0.0}),
          tag_of(kTiePoint, std::vector{0.0, 0.0, 0.0, west, upper_left.x(), 0.0}),
          tag_of(kGeoKeys, std::vector<std::uint16_t>{1, 1, 0,    4, 1024, 0,    1,    2, 1025, 0,
                                                      1, 1, 2048, 0, 1,    4326, 2054, 0, 1,    9102})};
}

}  // namespace

Result<void> write_geotiff(const Raster<float>& raster, const std::optional<Eigen::Vector3d>& origin_fix,
                           std::string_view what, std::ostream& out) {
  return detail::without_exceptions([&]() -> Result<void> {
    constexpr std::size_t kBytesOfStrip = std::size_t{1} << 18;
    const std::size_t rows_of_strip = std::max<std::size_t>(1, kBytesOfStrip / (raster.columns * sizeof(float)));
    std::vector<TiffBytes> strips;
    std::vector<std::uint32_t> places, sizes;
    std::size_t end = kTiffHeader;
    for (std::size_t row = 0; row < raster.rows; row += rows_of_strip) {
      Result<TiffBytes> strip = strip_of(raster, row, std::min(rows_of_strip, raster.rows - row));
      if (!strip) return tl::unexpected(strip.error());
      places.push_back(static_cast<std::uint32_t>(end));
      sizes.push_back(static_cast<std::uint32_t>(strip->size()));
      end += strip->size();
      strips.push_back(*std::move(strip));
    }
    const bool is_odd = end % 2 != 0;
    if (is_odd) ++end;

    constexpr std::uint16_t kDeflate = 8, kFloatSample = 3, kBits = 32, kBlackIsZero = 1;
    std::vector<Tag> tags = {long_tag(256, raster.columns), long_tag(257, raster.rows),
                             short_tag(258, kBits),         short_tag(259, kDeflate),
                             short_tag(262, kBlackIsZero),  tag_of(270, what),
                             tag_of(273, places),           short_tag(277, 1),
                             long_tag(278, rows_of_strip),  tag_of(279, sizes),
                             tag_of(305, "pingvox"),        short_tag(339, kFloatSample)};
    for (Tag& tag : place_of(raster, origin_fix)) tags.push_back(std::move(tag));
    constexpr std::uint16_t kNoData = 42113;  // GDAL's own
    tags.push_back(tag_of(kNoData, "nan"));

    ByteWriter writer(out);
    writer.put(std::string_view("II*\0", 4));
    writer.put(static_cast<std::uint32_t>(end));
    for (const TiffBytes& strip : strips) {
      for (const std::uint8_t byte : strip) writer.put(byte);
    }
    if (is_odd) writer.put(std::uint8_t{0});
    for (const std::uint8_t byte : directory_of(tags, end)) writer.put(byte);
    return writer.finish();
  });
}

}  // namespace pingvox
