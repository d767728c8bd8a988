#include "drives/draw_drive.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <ostream>
#include <system_error>
#include <utility>
#include <vector>

#include "pingvox/io/file.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/viewer/side_by_side.hpp"

namespace pingvox::bench {
namespace {

Eigen::Vector2d middle_of(const std::vector<Eigen::Vector2d>& places) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& place : places) sum += place;
  return sum / static_cast<double>(places.size());
}

/// The reference turned and shifted so that its distances from a trajectory have the least sum of squares.
Result<Trajectory> align(const Trajectory& reference, const Trajectory& to) {
  std::vector<StampedPose> poses;
  std::vector<Eigen::Vector2d> from, onto;
  for (const StampedPose& pose : reference.poses()) {
    const auto there = to.at(pose.time_s);
    if (!there) continue;
    poses.push_back(pose);
    from.emplace_back(pose.map_from_body.translation().head<2>());
    onto.emplace_back(there->translation().head<2>());
  }
  if (from.size() < 2)
    return fail(Error::Code::kUnsupported, "the reference has no pose at the time of the trajectory");
  const Eigen::Vector2d from_middle = middle_of(from), onto_middle = middle_of(onto);
  double sine = 0.0, cosine = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector2d a = from[i] - from_middle, b = onto[i] - onto_middle;
    cosine += a.dot(b);
    sine += a.x() * b.y() - a.y() * b.x();
  }
  const Eigen::Rotation2Dd turn(std::atan2(sine, cosine));
  const Eigen::Vector2d shift = onto_middle - turn * from_middle;
  const Pose moved = pose_from_rpy({shift.x(), shift.y(), 0.0}, 0.0, 0.0, turn.angle());
  for (StampedPose& pose : poses) pose.map_from_body = moved * pose.map_from_body;
  return Trajectory::make(std::move(poses));
}

Result<Panel> panel_of(const Drive& drive, const MapPath& path) {
  constexpr double kCell_m = 0.2;
  OccupancyMap map({.resolution_m = kCell_m});
  BeamsInMemory beams(drive.beams);
  BuildOptions build;
  build.model.shape = BeamShape::kRay;
  build.body_from_sensor = drive.body_from_sonar;
  if (const auto built = build_map(beams, path.map_from_body, build, map); !built) return tl::unexpected(built.error());
  Result<Trajectory> reference = align(drive.reference, path.map_from_body);
  if (!reference) return tl::unexpected(reference.error());
  MapPictureOptions picture;
  picture.paths = {path, {"reference", *std::move(reference)}};
  return Panel{render_map(map, picture), "map along " + path.name};
}

}  // namespace

Result<void> draw_drive(const Drive& drive, std::span<const MapPath> trajectories, const std::string& folder,
                        const std::string& file) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(Error::Code::kIo, fmt::format("{}: {}", folder, error.message()));
  std::vector<Panel> panels;
  for (const MapPath& path : trajectories) {
    Result<Panel> panel = panel_of(drive, path);
    if (!panel) return tl::unexpected(panel.error());
    panels.push_back(*std::move(panel));
  }
  const Result<Picture> picture = side_by_side(panels);
  if (!picture) return tl::unexpected(picture.error());
  return write_file((std::filesystem::path(folder) / file).string(),
                    [&](std::ostream& out) { return write_png(*picture, out); });
}

}  // namespace pingvox::bench
