#include "pingvox/io/glb.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "base/without_exceptions.hpp"
#include "io/bytes/byte_writer.hpp"
#include "io/maps/map_files.hpp"
#include "io/maps/occupied_leaves.hpp"
#include "io/maps/shades.hpp"
#include "pingvox/map/tree_view.hpp"

// docs/formats.md: a header, a chunk of JSON, a chunk of positions, colours and indices.
namespace pingvox {
namespace {

constexpr std::size_t kCorners = 4, kIndicesOfRectangle = 6, kShades = 256;

/// Part of the surface, in cells from the lowest occupied one: from u0 to u1 and v0 to v1 along the two axes after
/// `axis`, in the plane that is `plane` cells along it.
struct MeshRectangle {
  std::int32_t plane = 0, u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  std::uint8_t axis = 0;
  bool faces_up = false;  ///< along the axis, else against it
  std::uint8_t shade = 0;

  std::int32_t size() const { return v1 - v0; }
};

/// What the occupied cells span.
struct OccupiedSpan {
  WideKey lowest;
  std::array<WideWord, 3> extent{};  ///< in cells
  double low = 0.0, high = 0.0;      ///< of what the colours show
};

double shown_value(const Leaf& leaf, MeshColours colours) {
  return colours == MeshColours::kHeight ? leaf.centre_m().z() : leaf.belief.probability();
}

WideWord& part(WideKey& key, std::size_t axis) {
  return axis == 0 ? key.x : axis == 1 ? key.y : key.z;
}
WideWord part(const WideKey& key, std::size_t axis) {
  return axis == 0 ? key.x : axis == 1 ? key.y : key.z;
}

std::optional<OccupiedSpan> span_of(const OccupancyMap& map, MeshColours colours) {
  std::optional<OccupiedSpan> span;
  WideKey highest;
  for_each_occupied(map, [&](const Leaf& leaf) {
    const double value = shown_value(leaf, colours);
    if (!span) {
      span = OccupiedSpan{leaf.key, {}, value, value};
      highest = leaf.key;
    }
    const WideWord last = (WideWord{1} << (leaf.lattice->depth() - leaf.depth)) - 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      part(span->lowest, axis) = std::min(part(span->lowest, axis), part(leaf.key, axis));
      part(highest, axis) = std::max(part(highest, axis), part(leaf.key, axis) + last);
    }
    span->low = std::min(span->low, value);
    span->high = std::max(span->high, value);
  });
  for (std::size_t axis = 0; span && axis < 3; ++axis) {
    span->extent[axis] = part(highest, axis) - part(span->lowest, axis);
  }
  return span;
}

/// The parts of the surface that look in one direction.
class FacesOfOneSide {
 public:
  FacesOfOneSide(const OccupancyMap& map, const OccupiedSpan& span, std::uint8_t axis, bool faces_up)
      : map_(map), span_(span), levels_(map.lattice().depth()), axis_(axis), faces_up_(faces_up) {}

  void add(const Leaf& leaf, std::uint8_t shade) {
    shade_ = shade;
    WideKey across = leaf.key;
    const WideWord edge = WideWord{1} << (levels_ - leaf.depth);
    part(across, axis_) += faces_up_ ? edge : -edge;
    // Beyond the lattice nothing is known.
    const WideWord last = static_cast<WideWord>(WideWord{1} << (levels_ - 1)) * 2 - 1;
    const bool is_within = faces_up_ ? part(leaf.key, axis_) <= last - edge : part(leaf.key, axis_) >= edge;
    add_uncovered(is_within ? map_.node_at(across, leaf.depth) : std::nullopt, across, leaf.depth);
  }

  /// Joins the squares of equal size, plane and colour: along u, then along v.
  std::vector<MeshRectangle> joined() && {
    using R = MeshRectangle;
    std::ranges::sort(squares_, {}, [](const R& r) { return std::tuple(r.plane, r.size(), r.shade, r.v0, r.u0); });
    join([](const R& a, const R& b) {
      return std::tuple(a.plane, a.v0, a.v1, a.shade, a.u1) == std::tuple(b.plane, b.v0, b.v1, b.shade, b.u0);
    });
    std::ranges::sort(squares_, {}, [](const R& r) { return std::tuple(r.plane, r.shade, r.u0, r.u1, r.v0); });
    join([](const R& a, const R& b) {
      return std::tuple(a.plane, a.u0, a.u1, a.shade, a.v1) == std::tuple(b.plane, b.u0, b.u1, b.shade, b.v0);
    });
    return std::move(squares_);
  }

 private:
  /// Adds what is not occupied of the side of a node that touches the face.
  void add_uncovered(const std::optional<NodeView>& node, const WideKey& key, int depth) {
    if (!node || node->is_leaf()) {
      const bool is_covered = node && classify(node->belief(), map_.options().thresholds) == Occupancy::kOccupied;
      if (!is_covered) add_square(key, depth);
      return;
    }
    for (int octant = 0; octant < 8; ++octant) {
      const bool is_far = ((octant >> axis_) & 1) == (faces_up_ ? 1 : 0);
      if (!is_far) add_uncovered(node->child(octant), child_key(key, depth, levels_, octant), depth + 1);
    }
  }

  void add_square(const WideKey& across, int depth) {
    const WideWord edge = WideWord{1} << (levels_ - depth);
    const auto offset = [&](std::size_t axis, WideWord further) {
      return static_cast<std::int32_t>(part(across, axis) + further - part(span_.lowest, axis));
    };
    const std::size_t u = (axis_ + 1U) % 3, v = (axis_ + 2U) % 3;
    squares_.push_back({offset(axis_, faces_up_ ? 0 : edge), offset(u, 0), offset(u, edge), offset(v, 0),
                        offset(v, edge), axis_, faces_up_, shade_});
  }

  template <class Touches>
  void join(Touches touches) {
    std::size_t kept = 0;
    for (const MeshRectangle& next : squares_) {
      if (kept > 0 && touches(squares_[kept - 1], next)) {
        squares_[kept - 1].u1 = next.u1;
        squares_[kept - 1].v1 = next.v1;
      } else {
        squares_[kept++] = next;
      }
    }
    squares_.resize(kept);
  }

  const OccupancyMap& map_;
  const OccupiedSpan& span_;
  int levels_;
  std::uint8_t axis_;
  bool faces_up_;
  std::uint8_t shade_ = 0;
  std::vector<MeshRectangle> squares_;
};

Result<std::vector<MeshRectangle>> surface_of(const OccupancyMap& map, const OccupiedSpan& span, MeshColours colours) {
  const double range = span.high - span.low;
  const auto shade_of = [&](const Leaf& leaf) {
    const double share = range > 0.0 ? (shown_value(leaf, colours) - span.low) / range : 1.0;
    return static_cast<std::uint8_t>(std::lround(share * (kShades - 1)));
  };
  std::vector<MeshRectangle> surface;
  for (std::uint8_t axis = 0; axis < 3; ++axis) {
    for (const bool faces_up : {false, true}) {
      FacesOfOneSide faces(map, span, axis, faces_up);
      for_each_occupied(map, [&](const Leaf& leaf) { faces.add(leaf, shade_of(leaf)); });
      const std::vector<MeshRectangle> side = std::move(faces).joined();
      if (side.size() > kMaxMeshRectangles - surface.size()) {
        return fail(Error::Code::kLimit, fmt::format("its surface has more than {} faces", kMaxMeshRectangles));
      }
      surface.insert(surface.end(), side.begin(), side.end());
    }
  }
  return surface;
}

/// The corners in metres from the lowest occupied corner, in glTF's axes; counter-clockwise from outside.
std::array<Eigen::Vector3f, kCorners> corners_of(const MeshRectangle& face, double cell_m) {
  const std::size_t u = (face.axis + 1U) % 3, v = (face.axis + 2U) % 3;
  const auto corner = [&](std::int32_t at_u, std::int32_t at_v) -> Eigen::Vector3f {
    std::array<double, 3> at{};
    at[face.axis] = face.plane * cell_m;
    at[u] = at_u * cell_m;
    at[v] = at_v * cell_m;
    return Eigen::Vector3d(at[0], at[2], 0.0 - at[1]).cast<float>();  // not -0
  };
  if (face.faces_up) {
    return {corner(face.u0, face.v0), corner(face.u1, face.v0), corner(face.u1, face.v1), corner(face.u0, face.v1)};
  }
  return {corner(face.u0, face.v0), corner(face.u0, face.v1), corner(face.u1, face.v1), corner(face.u1, face.v0)};
}

/// Linear, as glTF has colours of vertices.
std::array<std::uint8_t, 4> colour_of(std::uint8_t shade) {
  constexpr double kWhite = 255.0;
  std::array<std::uint8_t, 4> colour{0, 0, 0, 255};
  const std::array<double, 3> srgb = shade_at(shade / (kShades - 1.0));
  for (std::size_t channel = 0; channel < srgb.size(); ++channel) {
    const double part = srgb[channel];
    const double linear = part <= 0.04045 ? part / 12.92 : std::pow((part + 0.055) / 1.055, 2.4);
    colour[channel] = static_cast<std::uint8_t>(std::lround(linear * kWhite));
  }
  return colour;
}

std::string json_of(const std::vector<MeshRectangle>& surface, const OccupancyMap& map, const OccupiedSpan& span,
                    MeshColours colours) {
  const double cell_m = map.lattice().resolution_m();
  Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity()), high = -low;
  for (const MeshRectangle& face : surface) {
    for (const Eigen::Vector3f& corner : corners_of(face, cell_m)) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  const auto numbers = [](const auto& vector) {
    return fmt::format("[{},{},{}]", static_cast<double>(vector.x()), static_cast<double>(vector.y()),
                       static_cast<double>(vector.z()));
  };
  const Eigen::Vector3d corner_m = map.lattice().lowest_corner_of(span.lowest, map.lattice().depth());
  const std::size_t vertices = surface.size() * kCorners;
  const std::size_t positions = vertices * 3 * sizeof(float), shades = vertices * 4;
  const std::size_t indices = surface.size() * kIndicesOfRectangle;
  const std::string shown = colours == MeshColours::kHeight
                                ? fmt::format("height {:.6g} to {:.6g} m", span.low, span.high)
                                : fmt::format("probability {:.4g} to {:.4g}", span.low, span.high);
  return fmt::format(
      R"({{"asset":{{"version":"2.0","generator":"pingvox"}},"scene":0,"scenes":[{{"name":"map","nodes":[0]}}],)"
      R"("nodes":[{{"name":"occupied cells of {} m, metres","mesh":0,"translation":{}}}],)"
      R"("meshes":[{{"name":"{}","primitives":[{{"attributes":{{"POSITION":0,"COLOR_0":1}},"indices":2,"material":0}}]}}],)"
      R"("materials":[{{"name":"cells","pbrMetallicRoughness":{{"metallicFactor":0,"roughnessFactor":1}}}}],)"
      R"("accessors":[)"
      R"({{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3","min":{},"max":{}}},)"
      R"({{"bufferView":1,"componentType":5121,"normalized":true,"count":{},"type":"VEC4"}},)"
      R"({{"bufferView":2,"componentType":5125,"count":{},"type":"SCALAR"}}],)"
      R"("bufferViews":[)"
      R"({{"buffer":0,"byteOffset":0,"byteLength":{},"target":34962}},)"
      R"({{"buffer":0,"byteOffset":{},"byteLength":{},"target":34962}},)"
      R"({{"buffer":0,"byteOffset":{},"byteLength":{},"target":34963}}],)"
      R"("buffers":[{{"byteLength":{}}}]}})",
      cell_m, numbers(Eigen::Vector3d(corner_m.x(), corner_m.z(), 0.0 - corner_m.y())), shown, vertices, numbers(low),
      numbers(high), vertices, indices, positions, positions, shades, positions + shades, indices * 4,
      positions + shades + indices * 4);
}

}  // namespace

Result<std::size_t> write_glb(const OccupancyMap& map, MeshColours colours, std::ostream& out) {
  return detail::without_exceptions([&]() -> Result<std::size_t> {
    const std::optional<OccupiedSpan> span = span_of(map, colours);
    if (!span) return fail(Error::Code::kUnsupported, "no cell is occupied: there is nothing to make a mesh of");
    constexpr WideWord kLongest = std::numeric_limits<std::int32_t>::max();
    if (std::ranges::any_of(span->extent, [](WideWord cells) { return cells >= kLongest; })) {
      return fail(Error::Code::kLimit, "its occupied cells are more than 2^31 cells apart");
    }
    const Result<std::vector<MeshRectangle>> surface = surface_of(map, *span, colours);
    if (!surface) return tl::unexpected(surface.error());

    std::string json = json_of(*surface, map, *span, colours);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    constexpr std::size_t kBytesOfRectangle = kCorners * (3 * sizeof(float) + 4) + kIndicesOfRectangle * 4;
    const std::size_t binary = surface->size() * kBytesOfRectangle;
    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    constexpr std::uint32_t kVersion = 2;
    ByteWriter writer(out);
    writer.put("glTF");
    writer.put(kVersion);
    writer.put(static_cast<std::uint32_t>(kHeader + 2 * kChunkHeader + json.size() + binary));
    writer.put(static_cast<std::uint32_t>(json.size()));
    writer.put("JSON");
    writer.put(json);
    writer.put(static_cast<std::uint32_t>(binary));
    writer.put(std::string_view("BIN\0", 4));
    for (const MeshRectangle& face : *surface) {
      for (const Eigen::Vector3f& corner : corners_of(face, map.lattice().resolution_m())) {
        for (const float number : corner) writer.put(number);
      }
    }
    for (const MeshRectangle& face : *surface) {
      const std::array<std::uint8_t, 4> colour = colour_of(face.shade);
      for (std::size_t corner = 0; corner < kCorners; ++corner) {
        for (const std::uint8_t channel : colour) writer.put(channel);
      }
    }
    for (std::uint32_t face = 0; face < surface->size(); ++face) {
      for (const std::uint32_t corner : {0U, 1U, 2U, 0U, 2U, 3U}) {
        writer.put(static_cast<std::uint32_t>(face * kCorners + corner));
      }
    }
    if (const auto written = writer.finish(); !written) return tl::unexpected(written.error());
    return surface->size();
  });
}

}  // namespace pingvox
