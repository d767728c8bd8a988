#include "pingvox/io/mesh.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/without_exceptions.hpp"
#include "io/bytes/byte_reader.hpp"
#include "io/bytes/byte_writer.hpp"
#include "io/bytes/text.hpp"
#include "io/clouds/ply_header.hpp"
#include "io/readers.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;
using Bytes = std::span<const std::uint8_t>;

tl::unexpected<Error> corrupt(const std::string& file, std::string_view place, std::string_view what) {
  return fail(Error::Code::kCorrupt, fmt::format("{}: {}: {}", file, place, what));
}

/// Adds a face as a fan of triangles around its first corner.
/// @return its error
std::optional<std::string> add_face(const std::vector<std::uint64_t>& corners, TriangleMesh& mesh) {
  if (corners.size() < 3) return fmt::format("a face of {} corners", corners.size());
  for (const std::uint64_t corner : corners) {
    if (corner >= mesh.vertices_m.size()) {
      return fmt::format("corner {} of {} vertices", corner, mesh.vertices_m.size());
    }
  }
  const auto at = [&corners](std::size_t i) { return static_cast<std::uint32_t>(corners[i]); };
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) mesh.triangles.push_back({at(0), at(i), at(i + 1)});
  return std::nullopt;
}

/// Indices have 32 bits.
bool is_full(const TriangleMesh& mesh) {
  return mesh.vertices_m.size() > std::numeric_limits<std::uint32_t>::max() - 3;
}

// --- Text: words in any number of lines.

class Words {
 public:
  explicit Words(Lines lines) : lines_(lines) {}

  std::optional<std::string_view> next() {
    for (;;) {
      if (const auto word = cut_word(line_)) {
        if (!word->starts_with('#')) return word;
      }
      const auto line = lines_.next_with_content();
      if (!line) return std::nullopt;
      line_ = *line;
    }
  }
  std::string place() const { return fmt::format("line {}", lines_.number()); }

  std::optional<Vector3d> point() {
    Vector3d point;
    for (double& value : point) {
      const auto word = next();
      const auto number = word ? number_in(*word) : std::nullopt;
      if (!number) return std::nullopt;
      value = *number;
    }
    return point;
  }
  /// Skips the rest of the line.
  void skip_line() { line_ = {}; }

 private:
  Lines lines_;
  std::string_view line_;
};

Result<TriangleMesh> read_off(const FileBytes& file) {
  Words words{Lines(text_of(file.view()))};
  words.next();  // OFF, sometimes on the line of the counts
  std::array<std::uint64_t, 3> counts{};
  for (std::uint64_t& count : counts) {
    const auto word = words.next();
    const auto number = word ? count_in(*word) : std::nullopt;
    if (!number) return corrupt(file.name, words.place(), "the numbers of vertices, faces and edges are missing");
    count = *number;
  }
  TriangleMesh mesh;
  for (std::uint64_t n = 0; n < counts[0]; ++n) {
    const auto point = words.point();
    if (!point || is_full(mesh)) return corrupt(file.name, words.place(), fmt::format("vertex {} is broken", n));
    words.skip_line();
    mesh.vertices_m.push_back(*point);
  }
  std::vector<std::uint64_t> corners;
  for (std::uint64_t n = 0; n < counts[1]; ++n) {
    const auto word = words.next();
    const auto count = word ? count_in(*word) : std::nullopt;
    if (!count) return corrupt(file.name, words.place(), fmt::format("face {} is missing", n));
    corners.clear();
    for (std::uint64_t i = 0; i < *count; ++i) {
      const auto index_word = words.next();
      const auto index = index_word ? count_in(*index_word) : std::nullopt;
      if (!index) return corrupt(file.name, words.place(), fmt::format("face {} is broken", n));
      corners.push_back(*index);
    }
    if (const auto wrong = add_face(corners, mesh)) return corrupt(file.name, words.place(), *wrong);
    words.skip_line();
  }
  return mesh;
}

Result<TriangleMesh> read_stl_text(const FileBytes& file) {
  Words words{Lines(text_of(file.view()))};
  TriangleMesh mesh;
  std::size_t corners = 0;
  words.next();
  words.skip_line();  // solid, and its name
  while (const auto word = words.next()) {
    if (*word == "vertex") {
      const auto point = words.point();
      if (!point || is_full(mesh)) return corrupt(file.name, words.place(), "a vertex is broken");
      mesh.vertices_m.push_back(*point);
      ++corners;
    } else if (*word == "endloop") {
      if (corners != 3) return corrupt(file.name, words.place(), fmt::format("a facet of {} corners", corners));
      const auto end = static_cast<std::uint32_t>(mesh.vertices_m.size());
      mesh.triangles.push_back({end - 3, end - 2, end - 1});
      corners = 0;
    } else if (*word == "facet" || *word == "solid" || *word == "endsolid") {
      words.skip_line();  // a normal, a name
    } else if (*word != "outer" && *word != "loop" && *word != "endfacet") {
      return corrupt(file.name, words.place(), fmt::format("unknown word '{}' in an STL file", printable(*word)));
    }
  }
  if (corners != 0) return corrupt(file.name, words.place(), "the file ends within a facet");
  return mesh;
}

// --- Binary STL: 80 bytes of header, the number of facets, 50 bytes each.

constexpr std::size_t kStlHead = 80, kStlFacet = 50;

Result<TriangleMesh> read_stl_binary(const FileBytes& file) {
  ByteReader reader(file.view());
  reader.take(kStlHead + 4);
  TriangleMesh mesh;
  while (reader.left() >= kStlFacet) {
    const std::size_t at = reader.position();
    reader.take(12);  // the normal
    for (int corner = 0; corner < 3; ++corner) {
      Vector3d point;
      for (double& value : point) value = static_cast<double>(reader.read<float>().value_or(0.0F));
      if (!point.allFinite() || is_full(mesh)) return corrupt(file.name, fmt::format("byte {}", at), "a broken facet");
      mesh.vertices_m.push_back(point);
    }
    reader.take(2);  // attributes
    const auto end = static_cast<std::uint32_t>(mesh.vertices_m.size());
    mesh.triangles.push_back({end - 3, end - 2, end - 1});
  }
  return mesh;
}

// --- PLY.

/// Reads the values of a PLY file, text or binary.
class PlyValues {
 public:
  PlyValues(Bytes bytes, const PlyHeader& header)
      : is_text_(header.format == PlyFormat::kText),
        words_(Lines(is_text_ ? text_of(bytes.subspan(header.size)) : std::string_view())),
        reader_(bytes.subspan(header.size), header.format == PlyFormat::kBig ? std::endian::big : std::endian::little) {
  }

  std::optional<double> next(Scalar type) {
    if (is_text_) {
      const auto word = words_.next();
      return word ? number_in(*word) : std::nullopt;
    }
    return with_scalar(type, [this]<class T>() -> std::optional<double> {
      const auto value = reader_.read<T>();
      if (!value) return std::nullopt;
      return static_cast<double>(*value);
    });
  }
  /// The next value as an integer from 0 to 2^32 - 1.
  std::optional<std::uint64_t> next_count(Scalar type) {
    const auto value = next(type);
    if (!value || !(*value >= 0.0 && *value < 0x1p32) || *value != std::floor(*value)) return std::nullopt;
    return static_cast<std::uint64_t>(*value);
  }

 private:
  bool is_text_;
  Words words_;
  ByteReader reader_;
};

Result<TriangleMesh> read_ply(const FileBytes& file) {
  const Result<PlyHeader> header = read_ply_header(file.name, file.view());
  if (!header) return tl::unexpected(header.error());
  PlyValues values(file.view(), *header);
  TriangleMesh mesh;
  std::vector<std::uint64_t> corners;
  for (const PlyElement& element : header->elements) {
    const bool is_vertex = element.name == "vertex";
    const bool is_face = element.name == "face";
    if (element.properties.empty()) continue;  // no bytes to read
    for (std::uint64_t n = 0; n < element.count; ++n) {
      const auto off = [&](std::string_view what) {
        return corrupt(file.name, fmt::format("{} {}", printable(element.name), n), what);
      };
      Vector3d point = Vector3d::Zero();
      for (const PlyProperty& property : element.properties) {
        if (property.list_count) {
          const auto count = values.next_count(*property.list_count);
          if (!count) return off("a length is missing or broken");
          const bool is_corners = is_face && (property.name == "vertex_indices" || property.name == "vertex_index");
          corners.clear();
          for (std::uint64_t i = 0; i < *count; ++i) {
            const auto value = values.next(property.type);
            if (!value) return off("the list ends early");
            if (!is_corners) continue;
            if (!(*value >= 0.0 && *value < 0x1p32)) return off("a corner that does not exist");
            corners.push_back(static_cast<std::uint64_t>(*value));
          }
          if (!is_corners) continue;
          if (const auto wrong = add_face(corners, mesh)) return off(*wrong);
          continue;
        }
        const auto value = values.next(property.type);
        if (!value) return off("a value is missing or broken");
        if (property.name == "x") point.x() = *value;
        if (property.name == "y") point.y() = *value;
        if (property.name == "z") point.z() = *value;
      }
      if (!is_vertex) continue;
      if (!point.allFinite() || is_full(mesh)) return off("its place is not finite");
      mesh.vertices_m.push_back(point);
    }
  }
  return mesh;
}

}  // namespace

bool looks_like_binary_stl(Bytes bytes) {
  if (bytes.size() < kStlHead + 4) return false;
  const auto count = value_from<std::uint32_t>(bytes.subspan(kStlHead, 4), std::endian::little);
  return count > 0 && bytes.size() - kStlHead - 4 == std::uint64_t{count} * kStlFacet;
}

bool may_begin_binary_stl(Bytes beginning) {
  if (beginning.size() < kStlHead + 4) return false;
  const auto count = value_from<std::uint32_t>(beginning.subspan(kStlHead, 4), std::endian::little);
  Bytes facets = beginning.subspan(kStlHead + 4);
  if (std::uint64_t{count} * kStlFacet <= facets.size() || std::ranges::find(facets, 0) == facets.end()) return false;
  for (; facets.size() >= kStlFacet; facets = facets.subspan(kStlFacet)) {
    for (std::size_t i = 0; i < 12; ++i) {
      if (!std::isfinite(value_from<float>(facets.subspan(4 * i, 4), std::endian::little))) return false;
    }
  }
  return true;
}

bool looks_like_stl_text(Bytes bytes) {
  Lines lines(text_of(bytes));
  std::string_view first = lines.next_with_content().value_or(""), second = lines.next_with_content().value_or("");
  const std::string_view word = cut_word(second).value_or("");
  return cut_word(first) == "solid" && (word == "facet" || word == "endsolid");
}

bool looks_like_off(Bytes bytes) {
  Lines lines(text_of(bytes));
  std::string_view first = lines.next_with_content().value_or("");
  return cut_word(first) == "OFF";
}

Result<TriangleMesh> read_mesh(const FileBytes& file) {
  return detail::without_exceptions(file.name, [&]() -> Result<TriangleMesh> {
    const std::string_view text = text_of(file.view());
    const auto read = [&]() -> Result<TriangleMesh> {
      if (looks_like_ply(file.view())) return read_ply(file);
      if (looks_like_binary_stl(file.view())) return read_stl_binary(file);
      if (text.starts_with("solid") || looks_like_stl_text(file.view())) return read_stl_text(file);
      if (looks_like_off(file.view())) return read_off(file);
      return fail(Error::Code::kUnsupported, fmt::format("{}: is not an OFF, PLY or STL mesh", file.name));
    };
    Result<TriangleMesh> mesh = read();
    if (mesh && mesh->triangles.empty()) {
      return fail(Error::Code::kCorrupt, fmt::format("{}: holds no triangle", file.name));
    }
    return mesh;
  });
}

Result<void> write_mesh_ply(const TriangleMesh& mesh, std::ostream& out) {
  ByteWriter writer(out);
  writer.put(
      fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\n"
                  "property double y\nproperty double z\nelement face {}\n"
                  "property list uchar uint vertex_indices\nend_header\n",
                  mesh.vertices_m.size(), mesh.triangles.size()));
  for (const Vector3d& vertex : mesh.vertices_m) {
    for (const double value : vertex) writer.put(value);
  }
  for (const auto& triangle : mesh.triangles) {
    writer.put(std::uint8_t{3});
    for (const std::uint32_t corner : triangle) writer.put(corner);
  }
  return writer.finish();
}

}  // namespace pingvox
