#include "pingvox/web/scene.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <utility>

#include "pingvox/analysis/surface_map.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/mesh.hpp"
#include "pingvox/io/open_log.hpp"
#include "pingvox/io/tum.hpp"
#include "web/point_collector.hpp"

namespace pingvox::web {
namespace {

std::string file_name_of(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

Result<void> add_map(const FileBytes& file, Scene& scene) {
  return read_map(file).map([&](MapFile read) {
    scene.maps.push_back({file_name_of(file.name), std::string(name_of(read.format)), std::move(read.map), read.axes});
  });
}

Result<void> add_mesh(const FileBytes& file, Format format, const MapOptions& options, Scene& scene) {
  const Result<TriangleMesh> mesh = read_mesh(file);
  if (!mesh) return tl::unexpected(mesh.error());
  Result<OccupancyMap> map = surface_map(*mesh, options);
  if (!map) return fail(map.error().code, fmt::format("{}: {}", file.name, map.error().message));
  scene.maps.push_back({file_name_of(file.name), std::string(name_of(format)), *std::move(map)});
  return {};
}

Result<void> add_cloud(const FileBytes& file, Damage damage, Scene& scene) {
  const Result<std::unique_ptr<ScanSource>> scans = open_scans(file, damage);
  if (!scans) return tl::unexpected(scans.error());
  PointCollector points;
  for (;;) {
    const Result<std::optional<PointScan>> scan = (*scans)->next();
    if (!scan) return tl::unexpected(scan.error());
    if (!*scan) break;
    for (const Eigen::Vector3d& point_m : (*scan)->points_m) points.add(point_m);
  }
  points.finish(file_name_of(file.name), scene);
  return {};
}

/// The box around all that has coordinates; nullopt: nothing has.
std::optional<Box> bounds_of(const Scene& scene) {
  std::optional<Box> bounds;
  const auto add = [&](const Eigen::Vector3d& point_m) {
    if (!bounds) bounds = Box{point_m, point_m};
    bounds->min = bounds->min.cwiseMin(point_m);
    bounds->max = bounds->max.cwiseMax(point_m);
  };
  for (const SceneMap& map : scene.maps) {
    const std::optional<Box> box = map.map.bounds();
    if (!box) continue;
    add(box->min);
    add(box->max);
  }
  for (const ScenePath& path : scene.paths) {
    for (const StampedPose& pose : path.trajectory.poses()) add(pose.map_from_body.translation());
  }
  for (const ScenePoints& cloud : scene.points) {
    for (const Eigen::Vector3d& point_m : cloud.points_m) add(point_m);
  }
  return bounds;
}

}  // namespace

Eigen::Vector3d Scene::origin_m() const {
  constexpr double kFar_m = 5000.0;  // up to there a float is exact to half a millimetre
  const std::optional<Box> bounds = bounds_of(*this);
  if (!bounds || (bounds->min.cwiseAbs().maxCoeff() < kFar_m && bounds->max.cwiseAbs().maxCoeff() < kFar_m)) {
    return Eigen::Vector3d::Zero();
  }
  const Eigen::Vector3d middle_m = 0.5 * (bounds->min + bounds->max);
  return middle_m.array().round();
}

Result<void> add_file(const FileBytes& file, const MapOptions& surface, Damage damage, Scene& scene) {
  const Result<Format> format = identify_format(file);
  if (!format) return tl::unexpected(format.error());
  switch (kind_of(*format)) {
    case FormatKind::kMap:
      return add_map(file, scene);
    case FormatKind::kMesh:
      return add_mesh(file, *format, surface, scene);
    case FormatKind::kCloud:
      return add_cloud(file, damage, scene);
    case FormatKind::kTrajectory:
      return read_tum(file).map([&](Trajectory path) { add_path(file_name_of(file.name), std::move(path), scene); });
    default:
      return fail(Error::Code::kUnsupported,
                  fmt::format("{}: is {}, which cannot be shown", file.name, description_of(*format)));
  }
}

void add_path(std::string name, Trajectory trajectory, Scene& scene) {
  scene.paths.push_back({std::move(name), std::move(trajectory)});
}

std::vector<std::uint8_t> join_bins(std::span<const std::uint8_t> bins, std::size_t group) {
  assert(group > 0);
  std::vector<std::uint8_t> joined;
  joined.reserve((bins.size() + group - 1) / group);
  for (std::size_t first = 0; first < bins.size(); first += group) {
    joined.push_back(std::ranges::max(bins.subspan(first, std::min(group, bins.size() - first))));
  }
  return joined;
}

SceneLog reduced(const SceneLog& log, std::size_t group, int step) {
  assert(group > 0 && step > 0);
  SceneLog less = log;
  less.bins = (log.bins + group - 1) / group;
  less.intensities.clear();
  less.intensities.reserve(less.bins * log.beams.size());
  for (std::size_t i = 0; i < log.beams.size(); ++i) {
    less.beams[i].bin_length_m *= static_cast<double>(group);
    for (const int intensity : join_bins(log.row(i), group)) {
      less.intensities.push_back(static_cast<std::uint8_t>(std::min((intensity + step - 1) / step * step, 255)));
    }
  }
  return less;
}

}  // namespace pingvox::web
