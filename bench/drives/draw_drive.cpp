#include "drives/draw_drive.hpp"

#include <fmt/core.h>

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

/// The part of the reference at whose times the trajectory is known, turned and shifted onto it.
Result<Trajectory> aligned_reference(const Trajectory& reference, const Trajectory& to) {
  std::vector<StampedPose> poses;
  for (const StampedPose& pose : reference.poses()) {
    if (to.at(pose.time_s)) poses.push_back(pose);
  }
  const Result<Pose> by = align(reference, to);
  if (!by) return tl::unexpected(by.error());
  for (StampedPose& pose : poses) pose.map_from_body = *by * pose.map_from_body;
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
  Result<Trajectory> reference = aligned_reference(drive.reference, path.map_from_body);
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
