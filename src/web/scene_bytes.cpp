#include "pingvox/web/scene_bytes.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "base/without_exceptions.hpp"
#include "io/internal/clock.hpp"
#include "io/internal/json.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "web/byte_columns.hpp"
#include "web/cell_places.hpp"
#include "web/scene_objects.hpp"

namespace pingvox::web {
namespace {

constexpr std::uint32_t kVersion = 1;

Error too_far() {
  return {Error::Code::kLimit, "the map reaches farther than 2^31 cells from its origin, which a browser cannot show"};
}
Error too_many(std::string_view what, std::size_t most) {
  return {Error::Code::kLimit, fmt::format("the map has more than {} {}, which a browser cannot show: keep fewer "
                                           "levels of the tree",
                                           most, what)};
}

/// Bricks in the order in which their cells come, with a byte for each cell.
class BrickColumns {
 public:
  /// REQUIRES that the cells of a brick come one after another.
  void add(const CellPlace& cell, std::uint8_t value) {
    const CellPlace brick = {cell.x >> 2, cell.y >> 2, cell.z >> 2};
    if (masks_.empty() || x_.back() != brick.x || y_.back() != brick.y || z_.back() != brick.z) {
      close();
      x_.push_back(static_cast<std::int32_t>(brick.x));
      y_.push_back(static_cast<std::int32_t>(brick.y));
      z_.push_back(static_cast<std::int32_t>(brick.z));
      masks_.push_back(0);
    }
    const auto bit = static_cast<std::size_t>((cell.x & 3) | (cell.y & 3) << 2 | (cell.z & 3) << 4);
    masks_.back() |= std::uint64_t{1} << bit;
    open_[bit] = value;
  }

  std::size_t cells() const { return values_.size(); }

  /// The bytes alone.
  Bytes values() {
    close();
    masks_.clear();
    return std::move(values_);
  }

  Bytes finish(const OccupancyMap& map) {
    close();
    constexpr std::size_t kHeaderBytes = 32, kBrickBytes = 20;
    ByteColumns out;
    out.reserve(kHeaderBytes + masks_.size() * kBrickBytes + values_.size() + 4);
    out.put(kCellsMagic);
    out.put(static_cast<std::uint32_t>(masks_.size()));
    out.put(static_cast<std::uint32_t>(values_.size()));
    out.put(kVersion);
    out.put(static_cast<float>(lowest_probability(map)));
    out.put(static_cast<float>(map.lattice().resolution_m()));
    out.put(std::uint32_t{0});
    out.put(std::uint32_t{0});
    out.put(x_);
    out.put(y_);
    out.put(z_);
    out.put(masks_, [](std::uint64_t mask) { return static_cast<std::uint32_t>(mask); });
    out.put(masks_, [](std::uint64_t mask) { return static_cast<std::uint32_t>(mask >> 32); });
    out.put(values_);
    out.align();
    return out.take();
  }

 private:
  /// Puts the values of the last brick in the order of their bits.
  void close() {
    if (masks_.empty()) return;
    for (std::uint64_t left = masks_.back(); left != 0; left &= left - 1) {
      values_.push_back(open_[static_cast<std::size_t>(std::countr_zero(left))]);
    }
  }

  std::vector<std::int32_t> x_, y_, z_;
  std::vector<std::uint64_t> masks_;
  std::vector<std::uint8_t> values_;
  std::array<std::uint8_t, 64> open_{};  ///< of the last brick, by bits
};

/// Calls f(place) for the cells of a cube, brick by brick.
template <class F>
void for_each_cell(const CellPlace& lowest, std::int64_t edge, F&& f) {
  const std::int64_t piece = std::min(edge, kBrickEdge);
  for (std::int64_t bz = 0; bz < edge; bz += piece) {
    for (std::int64_t by = 0; by < edge; by += piece) {
      for (std::int64_t bx = 0; bx < edge; bx += piece) {
        for (std::int64_t z = bz; z < bz + piece; ++z) {
          for (std::int64_t y = by; y < by + piece; ++y) {
            for (std::int64_t x = bx; x < bx + piece; ++x) f(CellPlace{lowest.x + x, lowest.y + y, lowest.z + z});
          }
        }
      }
    }
  }
}

/// Of a lattice with fewer levels than a brick has, whose bricks do not begin where ours do.
template <class ByteOf>
BrickColumns bricks_of_small(const OccupancyMap& map, LogOdds lowest, ByteOf& byte_of) {
  BrickColumns bricks;
  const std::int64_t half = std::int64_t{1} << (map.lattice().depth() - 1);
  const std::array<std::int64_t, 2> firsts = {-kBrickEdge, 0};
  for (const std::int64_t z : firsts) {
    for (const std::int64_t y : firsts) {
      for (const std::int64_t x : firsts) {
        for_each_cell({x, y, z}, kBrickEdge, [&](const CellPlace& cell) {
          const auto is_in = [half](std::int64_t word) { return word >= -half && word < half; };
          if (!is_in(cell.x) || !is_in(cell.y) || !is_in(cell.z)) return;
          const auto word = [half](std::int64_t from_centre) { return static_cast<std::uint16_t>(from_centre + half); };
          const std::optional<LogOdds> belief = map.at(Key{word(cell.x), word(cell.y), word(cell.z)});
          if (belief && *belief >= lowest) bricks.add(cell, byte_of(cell, *belief));
        });
      }
    }
  }
  return bricks;
}

/// The cells that are sent. @param byte_of  (CellPlace, LogOdds) -> std::uint8_t
template <class ByteOf>
Result<BrickColumns> bricks_of(const OccupancyMap& map, ByteOf byte_of) {
  constexpr int kBrickLevels = 2;
  const LogOdds lowest = LogOdds::from_probability(lowest_probability(map));
  if (map.lattice().depth() <= kBrickLevels) return bricks_of_small(map, lowest, byte_of);
  BrickColumns bricks;
  std::optional<Error> error;
  for_each_leaf(map, [&](const Leaf& leaf) {
    if (error || leaf.belief < lowest) return;
    const std::optional<CellPlace> place = place_of(leaf);
    if (!place) {
      error = too_far();
      return;
    }
    const int levels = map.lattice().depth() - leaf.depth;
    constexpr int kMaxLevels = 9;  // a cube of more cells than kMaxCells
    if (levels > kMaxLevels || bricks.cells() + (std::size_t{1} << (3 * levels)) > kMaxCells) {
      error = too_many("cells that may be occupied", kMaxCells);
      return;
    }
    for_each_cell(*place, std::int64_t{1} << levels,
                  [&](const CellPlace& cell) { bricks.add(cell, byte_of(cell, leaf.belief)); });
  });
  if (error) return tl::unexpected(*error);
  return bricks;
}

struct FreeColumns {
  std::vector<std::int32_t> x, y, z;
  std::vector<std::uint32_t> edge;
};

Result<FreeColumns> free_leaves_of(const OccupancyMap& map) {
  FreeColumns columns;
  std::optional<Error> error;
  for_each_leaf(map, [&](const Leaf& leaf) {
    if (error || classify(leaf.belief, map.options().thresholds) != Occupancy::kFree) return;
    const std::optional<CellPlace> place = place_of(leaf);
    if (!place) error = too_far();
    if (columns.x.size() == kMaxFreeLeaves) error = too_many("free leaves", kMaxFreeLeaves);
    if (error) return;
    columns.x.push_back(static_cast<std::int32_t>(place->x));
    columns.y.push_back(static_cast<std::int32_t>(place->y));
    columns.z.push_back(static_cast<std::int32_t>(place->z));
    columns.edge.push_back(std::uint32_t{1} << (map.lattice().depth() - leaf.depth));
  });
  if (error) return tl::unexpected(*error);
  return columns;
}

std::string_view name_of_x(MapAxes axes) {
  return axes == MapAxes::kEastNorth ? "east" : axes == MapAxes::kUnknown ? "x" : "right";
}
std::string_view name_of_y(MapAxes axes) {
  return axes == MapAxes::kEastNorth ? "north" : axes == MapAxes::kUnknown ? "y" : "ahead";
}

JsonObject json_of(const SceneMap& map, std::size_t id) {
  const MapCounts counts = map.map.counts();
  JsonObject json;
  json.add("id", std::uint64_t{id})
      .add("name", map.name)
      .add("format", map.format)
      .add("resolution_m", map.map.lattice().resolution_m())
      .add("occupancy", map.map.options().thresholds.upper.probability());
  if (const std::optional<Box> bounds = map.map.bounds()) {
    json.add("bounds", JsonObject().add("min", bounds->min).add("max", bounds->max));
  } else {
    json.add_null("bounds");
  }
  json.add("occupied_cells", counts.occupied_cells)
      .add("free_cells", counts.free_cells)
      .add("cells", fmt::format("map/{}/cells", id));
  counts.leaves <= kMaxFreeLeaves ? json.add("free", fmt::format("map/{}/free", id)) : json.add_null("free");
  map.agreement.empty() ? json.add_null("agreement") : json.add("agreement", fmt::format("map/{}/agreement", id));
  return json;
}

JsonObject json_of(const ScenePath& path, std::size_t id) {
  const std::vector<StampedPose>& poses = path.trajectory.poses();
  return JsonObject()
      .add("id", std::uint64_t{id})
      .add("name", path.name)
      .add("poses", std::uint64_t{poses.size()})
      .add("url", fmt::format("path/{}", id))
      .add("clock", date_text(poses.front().time_s).empty() ? "log" : "unix");
}

JsonObject json_of(const ScenePoints& points, std::size_t id) {
  return JsonObject()
      .add("id", std::uint64_t{id})
      .add("name", points.name)
      .add("count", std::uint64_t{points.points_m.size()})
      .add("url", fmt::format("points/{}", id));
}

JsonObject json_of(const SceneLog& log, std::size_t id) {
  return log_json(log, id);
}

template <class Items>
std::vector<JsonObject> json_of_all(const Items& items) {
  std::vector<JsonObject> objects;
  for (std::size_t id = 0; id < items.size(); ++id) objects.push_back(json_of(items[id], id));
  return objects;
}

}  // namespace

JsonObject log_json(const SceneLog& log, std::size_t id) {
  const Eigen::Quaterniond turn(log.body_from_sonar.rotation());
  const std::array<double, 4> quaternion = {turn.x(), turn.y(), turn.z(), turn.w()};
  JsonObject json;
  json.add("id", std::uint64_t{id})
      .add("name", log.name)
      .add("beams", std::uint64_t{log.beams.size()})
      .add("bins", std::uint64_t{log.bins})
      .add("beam_width_deg", log.beam_width_rad / kDegree_rad)
      .add("beam_height_deg", log.beam_height_rad / kDegree_rad)
      .add("mount", JsonObject()
                        .add("position", Eigen::Vector3d(log.body_from_sonar.translation()))
                        .add("quaternion", std::span<const double>(quaternion)));
  log.path ? json.add("path", std::uint64_t{*log.path}) : json.add_null("path");
  return json.add("url", fmt::format("log/{}", id)).add("intensities", fmt::format("log/{}/bins", id));
}

JsonObject axes_json(MapAxes axes) {
  return JsonObject().add("x", name_of_x(axes)).add("y", name_of_y(axes));
}

std::string scene_json(const Scene& scene) {
  const MapAxes axes = scene.maps.empty() ? MapAxes::kUnknown : scene.maps.front().axes;
  return JsonObject()
      .add("title", scene.title)
      .add("version", std::uint64_t{kVersion})
      .add("unit", "m")
      .add("axes", axes_json(axes))
      .add("origin_m", scene.origin_m())
      .add("maps", json_of_all(scene.maps))
      .add("paths", json_of_all(scene.paths))
      .add("points", json_of_all(scene.points))
      .add("logs", json_of_all(scene.logs))
      .add("notes", scene.notes)
      .text();
}

Result<Bytes> cells_bytes(const OccupancyMap& map) {
  return detail::without_exceptions([&]() -> Result<Bytes> {
    ProbabilityByte probability;
    return bricks_of(map, [&](const CellPlace&, LogOdds belief) { return probability.of(belief); })
        .map([&](BrickColumns bricks) { return bricks.finish(map); });
  });
}

Result<Bytes> agreement_bytes(const SceneMap& map) {
  return detail::without_exceptions([&]() -> Result<Bytes> {
    std::vector<std::pair<CellPlace, std::uint8_t>> levels;
    for (const CellAgreement& cell : map.agreement) {
      // Others are not sent either.
      if (const auto place = place_of(cell.cell, 0, map.map.lattice())) levels.emplace_back(*place, cell.level());
    }
    std::ranges::sort(levels);
    return bricks_of(map.map,
                     [&](const CellPlace& cell, LogOdds) {
                       const auto found =
                           std::ranges::lower_bound(levels, cell, {}, &std::pair<CellPlace, std::uint8_t>::first);
                       return found != levels.end() && found->first == cell ? found->second : std::uint8_t{0};
                     })
        .map([](BrickColumns bricks) { return bricks.values(); });
  });
}

Result<Bytes> free_bytes(const OccupancyMap& map) {
  return detail::without_exceptions([&]() -> Result<Bytes> {
    return free_leaves_of(map).map([](const FreeColumns& columns) {
      constexpr std::size_t kHeaderBytes = 16, kLeafBytes = 16;
      ByteColumns out;
      out.reserve(kHeaderBytes + columns.x.size() * kLeafBytes);
      out.put(kFreeMagic);
      out.put(static_cast<std::uint32_t>(columns.x.size()));
      out.put(std::uint32_t{0});
      out.put(std::uint32_t{0});
      out.put(columns.x);
      out.put(columns.y);
      out.put(columns.z);
      out.put(columns.edge);
      return out.take();
    });
  });
}

Bytes path_bytes(const ScenePath& path, const Eigen::Vector3d& origin_m) {
  return pose_bytes(path.trajectory.poses(), origin_m, {});
}

Bytes pose_bytes(std::span<const StampedPose> poses, const Eigen::Vector3d& origin_m, const PartOfPath& part_of_path) {
  ByteColumns out;
  out.put(kPathMagic);
  out.put(static_cast<std::uint32_t>(poses.size()));
  out.put(part_of_path.version);
  out.put(part_of_path.first);
  out.put(poses, [](const StampedPose& pose) { return pose.time_s; });
  for (const int axis : {0, 1, 2}) {
    out.put(poses, [&](const StampedPose& pose) {
      return static_cast<float>(pose.map_from_body.translation()[axis] - origin_m[axis]);
    });
  }
  for (const int part : {0, 1, 2, 3}) {  // x, y, z, w
    out.put(poses, [&](const StampedPose& pose) {
      return static_cast<float>(Eigen::Quaterniond(pose.map_from_body.rotation()).coeffs()[part]);
    });
  }
  return out.take();
}

Bytes points_bytes(const ScenePoints& points, const Eigen::Vector3d& origin_m) {
  ByteColumns out;
  out.put(kPointsMagic);
  out.put(static_cast<std::uint32_t>(points.points_m.size()));
  out.put(std::uint32_t{0});  // they have no value of their own
  out.put(std::uint32_t{0});
  for (const int axis : {0, 1, 2}) {
    out.put(points.points_m,
            [&](const Eigen::Vector3d& point_m) { return static_cast<float>(point_m[axis] - origin_m[axis]); });
  }
  out.put(points.points_m, [](const Eigen::Vector3d&) { return 0.0F; });
  return out.take();
}

Bytes beams_bytes(const SceneLog& log) {
  return beams_bytes(log, 0);
}

Bytes beams_bytes(const SceneLog& log, std::uint32_t first) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const auto or_none = [](const std::optional<double>& value) { return value ? static_cast<float>(*value) : kNone; };
  ByteColumns out;
  out.put(kBeamsMagic);
  out.put(static_cast<std::uint32_t>(log.beams.size()));
  out.put(static_cast<std::uint32_t>(log.bins));
  out.put(first);
  out.put(log.beams, [](const SceneBeam& beam) { return beam.time_s; });
  out.put(log.beams, [](const SceneBeam& beam) { return static_cast<float>(beam.bearing_rad); });
  out.put(log.beams, [](const SceneBeam&) { return 0.0F; });  // the first bin begins at the transducer
  out.put(log.beams, [](const SceneBeam& beam) { return static_cast<float>(beam.bin_length_m); });
  out.put(log.beams, [&](const SceneBeam& beam) { return or_none(beam.echo_m); });
  out.put(log.beams, [](const SceneBeam& beam) { return static_cast<float>(beam.echo_probability); });
  out.put(log.beams, [&](const SceneBeam& beam) { return or_none(beam.threshold); });
  out.put(log.beams, [](const SceneBeam& beam) { return beam.sweep; });
  return out.take();
}

}  // namespace pingvox::web
