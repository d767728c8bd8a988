#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "io/clouds/cloud.hpp"
#include "io/clouds/ply_header.hpp"
#include "io/readers.hpp"

// The vertices of a PLY file as points (docs/formats.md).
namespace pingvox {
namespace {

constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};

/// Size of one element; nullopt if it has lists.
std::optional<std::uint64_t> bytes_of(const PlyElement& element) {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    if (property.list_count) return std::nullopt;
    bytes += bytes_of(property.type);
  }
  return bytes;
}

}  // namespace

Result<std::unique_ptr<ScanSource>> open_ply_cloud(FileBytes file, Damage damage, const CloudOrigin& origin_m) {
  const Result<PlyHeader> header = read_ply_header(file.name, file.view());
  if (!header) return tl::unexpected(header.error());
  const auto error = [&file](Error::Code code, std::string_view what) {
    return fail(code, fmt::format("{}: {}", file.name, what));
  };
  const auto vertices = std::find_if(header->elements.begin(), header->elements.end(),
                                     [](const PlyElement& element) { return element.name == "vertex"; });
  if (vertices == header->elements.end()) return error(Error::Code::kCorrupt, "has no vertices");
  std::array<std::optional<std::size_t>, 3> place;  // of x, y, z among the properties
  for (std::size_t i = 0; i < vertices->properties.size(); ++i) {
    const PlyProperty& property = vertices->properties[i];
    if (property.list_count) return error(Error::Code::kUnsupported, "vertices with lists are not read");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (property.name == kAxes[axis]) place[axis] = i;
    }
  }
  if (!place[0] || !place[1] || !place[2]) return error(Error::Code::kCorrupt, "its vertices have no x, y and z");
  const Eigen::Vector3d origin = origin_m.value_or(Eigen::Vector3d::Zero());

  if (header->format == PlyFormat::kText) {
    TextCloud cloud;
    cloud.points = vertices->count;
    cloud.is_last = vertices + 1 == header->elements.end();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cloud.xyz[axis] = {*place[axis], vertices->properties[*place[axis]].type};
    }
    Lines lines(text_of(file.view()));
    for (std::size_t i = 0; i < header->lines; ++i) lines.next();
    for (auto before = header->elements.begin(); before != vertices; ++before) {
      if (before->properties.empty()) continue;
      for (std::uint64_t n = 0; n < before->count && lines.next_with_content(); ++n) {
      }
    }
    return text_cloud(std::move(file), lines, cloud, damage, origin);
  }

  std::uint64_t at = header->size;
  const std::uint64_t size = file.bytes.size();
  for (auto before = header->elements.begin(); before != vertices; ++before) {
    const auto bytes = bytes_of(*before);
    if (!bytes) return error(Error::Code::kUnsupported, "lists before the vertices are not read");
    if (*bytes > 0 && before->count > (size - at) / *bytes) {
      return error(Error::Code::kCorrupt, "ends before its vertices");
    }
    at += before->count * *bytes;
  }
  const std::uint64_t step = bytes_of(*vertices).value_or(0);
  if (vertices->count > (size - at) / step) {
    return error(Error::Code::kCorrupt, fmt::format("byte {}: {} vertices of {} bytes do not fit into the {} left", at,
                                                    vertices->count, step, size - at));
  }
  const std::uint64_t vertices_end = at + vertices->count * step;
  ByteCloud cloud;
  cloud.points = static_cast<std::size_t>(vertices->count);
  cloud.order = header->format == PlyFormat::kBig ? std::endian::big : std::endian::little;
  for (std::size_t i = 0; i < vertices->properties.size(); ++i) {
    const Scalar type = vertices->properties[i].type;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (place[axis] == i) cloud.xyz[axis] = {static_cast<std::size_t>(at), static_cast<std::size_t>(step), type};
    }
    at += bytes_of(type);
  }
  if (vertices + 1 == header->elements.end()) {
    cloud.bytes_behind = bytes_like_points(file.view().subspan(static_cast<std::size_t>(vertices_end)), step);
  }
  std::string name = file.name;
  return byte_cloud(std::move(name), std::move(file.bytes), cloud, damage, origin);
}

}  // namespace pingvox
