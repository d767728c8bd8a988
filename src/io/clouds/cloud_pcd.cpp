#include <fmt/core.h>

#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "io/bytes/byte_reader.hpp"
#include "io/clouds/cloud.hpp"
#include "io/clouds/lzf.hpp"
#include "io/readers.hpp"

// PCD files of the Point Cloud Library, up to version 0.7 (docs/formats.md).
namespace pingvox {
namespace {

struct Field {
  std::string name;
  std::uint64_t size = 4;
  char type = 'F';
  std::uint64_t count = 1;
};

enum class PcdData { kText, kBinary, kCompressed };

struct PcdHeader {
  std::vector<Field> fields;
  std::optional<std::uint64_t> width, height, points;
  std::optional<Eigen::Vector3d> viewpoint_m;
  std::optional<PcdData> data;
  std::size_t size = 0;  ///< bytes
  Lines rest{""};        ///< lines after the header
};

std::vector<std::string_view> words_in(std::string_view line) {
  std::vector<std::string_view> words;
  while (const auto word = cut_word(line)) words.push_back(*word);
  return words;
}

std::optional<Scalar> scalar_of(const Field& field) {
  const auto of_size = [&field](std::array<std::optional<Scalar>, 4> types) -> std::optional<Scalar> {
    return field.size == 1   ? types[0]
           : field.size == 2 ? types[1]
           : field.size == 4 ? types[2]
           : field.size == 8 ? types[3]
                             : std::nullopt;
  };
  if (field.type == 'F') return of_size({std::nullopt, std::nullopt, Scalar::kFloat, Scalar::kDouble});
  if (field.type == 'I') return of_size({Scalar::kInt8, Scalar::kInt16, Scalar::kInt32, Scalar::kInt64});
  if (field.type == 'U') return of_size({Scalar::kUint8, Scalar::kUint16, Scalar::kUint32, Scalar::kUint64});
  return std::nullopt;
}

/// Parses a line of the header.
/// @return its error; empty: none
std::string_view take_line(const std::vector<std::string_view>& words, PcdHeader& header) {
  if (words.empty()) return "is an unknown header line";  // only commas
  const std::string_view key = words.front();
  const std::size_t values = words.size() - 1;
  const auto take_count = [&](std::optional<std::uint64_t>& target) -> std::string_view {
    if (values == 1) target = count_in(words[1]);
    return values == 1 && target ? "" : "must be one whole number";
  };
  const auto for_each_field = [&](auto take) -> std::string_view {
    if (values != header.fields.size()) return "must say as much as FIELDS";
    for (std::size_t i = 0; i < values; ++i) {
      if (!take(header.fields[i], words[i + 1])) return "is not what it should be";
    }
    return "";
  };
  // Sizes and counts are bounded, so that sums cannot overflow.
  const auto is_small = [](const std::optional<std::uint64_t>& count) {
    return count && *count <= std::numeric_limits<std::uint16_t>::max();
  };
  if (key == "FIELDS" || key == "COLUMNS") {
    if (!header.fields.empty()) return "is there twice";
    for (std::size_t i = 1; i < words.size(); ++i) header.fields.push_back({std::string(words[i])});
  } else if (key == "SIZE") {
    return for_each_field([&](Field& field, std::string_view word) {
      const auto size = count_in(word);
      field.size = size.value_or(0);
      return is_small(size) && *size > 0;
    });
  } else if (key == "TYPE") {
    return for_each_field([](Field& field, std::string_view word) {
      field.type = word.front();
      return word.size() == 1;
    });
  } else if (key == "COUNT") {  // 0 is of a field of no bytes, as PCL writes for padding
    return for_each_field([&](Field& field, std::string_view word) {
      const auto count = count_in(word);
      field.count = count.value_or(0);
      return is_small(count);
    });
  } else if (key == "WIDTH") {
    return take_count(header.width);
  } else if (key == "HEIGHT") {
    return take_count(header.height);
  } else if (key == "POINTS") {
    return take_count(header.points);
  } else if (key == "VIEWPOINT") {
    Eigen::Vector3d place;
    if (values != 7) return "must be seven numbers: x y z, and a quaternion";
    for (std::size_t i = 0; i < 3; ++i) {
      const auto number = number_in(words[i + 1]);
      if (!number) return "contains an invalid number";
      place[static_cast<Eigen::Index>(i)] = *number;
    }
    header.viewpoint_m = place;
  } else if (key == "DATA") {
    const std::string_view how = values == 1 ? words[1] : "";
    if (how == "ascii") header.data = PcdData::kText;
    if (how == "binary") header.data = PcdData::kBinary;
    if (how == "binary_compressed") header.data = PcdData::kCompressed;
    if (!header.data) return "must be ascii, binary or binary_compressed";
  } else if (key != "VERSION") {
    return "is an unknown header line";
  }
  return "";
}

tl::unexpected<Error> corrupt(const std::string& file, std::string_view what) {
  return fail(Error::Code::kCorrupt, fmt::format("{}: {}", file, what));
}

Result<PcdHeader> read_header(const FileBytes& file) {
  PcdHeader header;
  Lines lines(text_of(file.view()));
  while (!header.data) {
    const auto line = lines.next_with_content();
    if (!line) return corrupt(file.name, "its header has no line DATA");
    const std::string_view wrong = take_line(words_in(*line), header);
    if (!wrong.empty()) {
      return corrupt(file.name, fmt::format("line {}: '{}' {}", lines.number(), printable(*line), wrong));
    }
  }
  header.size = file.bytes.size() - lines.left();
  header.rest = lines;
  if (header.width) {
    const std::uint64_t height = header.height.value_or(1);
    if (height > 0 && *header.width > std::numeric_limits<std::uint64_t>::max() / height) {
      return corrupt(file.name, "WIDTH times HEIGHT is not a valid number of points");
    }
    if (!header.points) header.points = *header.width * height;
    // Old versions have zeros here and only POINTS.
    const bool is_said = *header.width > 0 && height > 0;
    if (is_said && *header.points != *header.width * height) {
      return corrupt(file.name,
                     fmt::format("{} POINTS are not WIDTH {} times HEIGHT {}", *header.points, *header.width, height));
    }
  }
  if (!header.points) return corrupt(file.name, "does not say how many POINTS it has");
  return header;
}

/// Indices of x, y and z among the fields.
Result<std::array<std::size_t, 3>> fields_of_xyz(const std::string& file, const std::vector<Field>& fields) {
  constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
  std::array<std::optional<std::size_t>, 3> found;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (fields[i].name == kAxes[axis]) found[axis] = i;
    }
  }
  if (!found[0] || !found[1] || !found[2]) return corrupt(file, "its FIELDS have no x, y and z");
  for (const auto& index : found) {
    const Field& field = fields[*index];
    if (!scalar_of(field) || field.count != 1) {
      return corrupt(file, fmt::format("the field {} is of no type of number", field.name));
    }
  }
  return std::array{*found[0], *found[1], *found[2]};
}

/// The decompressed bytes after the header.
Result<std::vector<std::uint8_t>> decompress_points(const FileBytes& file, const PcdHeader& header,
                                                    std::uint64_t wanted) {
  ByteReader reader(file.view().subspan(header.size));
  const auto compressed_size = reader.read<std::uint32_t>();
  const auto size = reader.read<std::uint32_t>();
  if (!compressed_size || !size) return corrupt(file.name, "ends before its points");
  const auto compressed = reader.take(*compressed_size);
  if (!compressed) {
    return corrupt(file.name, fmt::format("byte {}: {} compressed bytes do not fit into the {} left", header.size,
                                          *compressed_size, reader.left()));
  }
  if (*size != wanted) {
    return corrupt(file.name, fmt::format("byte {}: {} bytes of points instead of {}", header.size + 4, *size, wanted));
  }
  const auto broken = [&] { return corrupt(file.name, fmt::format("byte {}: broken LZF data", header.size + 8)); };
  if (*size / kLzfMaxExpansion > compressed->size()) return broken();
  std::vector<std::uint8_t> bytes(*size);
  if (!lzf_decompress(*compressed, bytes)) return broken();
  return bytes;
}

}  // namespace

bool looks_like_pcd(std::span<const std::uint8_t> bytes) {
  if (text_of(bytes).starts_with("# .PCD")) return true;
  Lines lines(text_of(bytes));
  std::string_view line = lines.next_with_content().value_or("");
  const std::string_view first = cut_word(line).value_or("");
  if (first == "VERSION") {
    line = lines.next_with_content().value_or("");
    const std::string_view second = cut_word(line).value_or("");
    return second == "FIELDS" || second == "COLUMNS";
  }
  if (first != "FIELDS" && first != "COLUMNS") return false;
  line = lines.next_with_content().value_or("");
  return cut_word(line) == "SIZE";
}

Result<std::unique_ptr<ScanSource>> open_pcd(FileBytes file, Damage damage, const CloudOrigin& origin_m) {
  const Result<PcdHeader> header = read_header(file);
  if (!header) return tl::unexpected(header.error());
  const std::vector<Field>& fields = header->fields;
  const auto xyz = fields_of_xyz(file.name, fields);
  if (!xyz) return tl::unexpected(xyz.error());
  const std::uint64_t points = *header->points;
  const Eigen::Vector3d origin = origin_m.value_or(header->viewpoint_m.value_or(Eigen::Vector3d::Zero()));

  if (*header->data == PcdData::kText) {
    TextCloud cloud{.xyz = {}, .points = points, .is_last = true, .nan = NanPoint::kNoReturn};
    std::size_t words = 0;
    for (std::size_t i = 0; i < fields.size(); words += fields[i].count, ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if ((*xyz)[axis] == i) cloud.xyz[axis] = {words, *scalar_of(fields[i])};
      }
    }
    return text_cloud(std::move(file), header->rest, cloud, damage, origin);
  }

  // Binary data hold point after point; compressed data hold field after field, without the padding named `_`.
  const bool is_compressed = *header->data == PcdData::kCompressed;
  const auto bytes_in = [&](const Field& field) -> std::uint64_t {
    return is_compressed && field.name == "_" ? 0 : field.size * field.count;
  };
  std::uint64_t record = 0;
  for (const Field& field : fields) record += bytes_in(field);
  const std::uint64_t left = file.bytes.size() - header->size;
  const std::uint64_t most = is_compressed ? left * kLzfMaxExpansion : left;
  if (points > most / record) {
    return corrupt(file.name, fmt::format("byte {}: {} points of {} bytes do not fit into the {} left", header->size,
                                          points, record, left));
  }
  ByteCloud cloud;
  cloud.points = static_cast<std::size_t>(points);
  cloud.nan = NanPoint::kNoReturn;
  std::uint64_t at = is_compressed ? 0 : header->size;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::uint64_t step = is_compressed ? bytes_in(fields[i]) : record;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if ((*xyz)[axis] != i) continue;
      cloud.xyz[axis] = {static_cast<std::size_t>(at), static_cast<std::size_t>(step), *scalar_of(fields[i])};
    }
    at += is_compressed ? points * bytes_in(fields[i]) : bytes_in(fields[i]);
  }
  if (!is_compressed) {
    const auto end = static_cast<std::size_t>(header->size + points * record);
    cloud.bytes_behind = bytes_like_points(file.view().subspan(end), record);
    std::string name = file.name;
    return byte_cloud(std::move(name), std::move(file.bytes), cloud, damage, origin);
  }
  auto bytes = decompress_points(file, *header, points * record);
  if (!bytes) return tl::unexpected(bytes.error());
  return byte_cloud(file.name, *std::move(bytes), cloud, damage, origin);
}

}  // namespace pingvox
