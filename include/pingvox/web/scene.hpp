#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/map/cell_agreement.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/result.hpp"

/// What the page of `pingvox view` shows, how it is sent to a browser, and the server.
namespace pingvox::web {

struct SceneMap {
  std::string name;
  std::string format;  ///< "bt"; "log" of a map built from logs
  OccupancyMap map;
  MapAxes axes = MapAxes::kUnknown;
  std::vector<CellAgreement> agreement = {};  ///< where echoes were compared with the map (Evaluation::cells)
};

/// Where a vehicle was: map_from_body.
struct ScenePath {
  std::string name;
  Trajectory trajectory;
};

/// Points in the map frame [m].
struct ScenePoints {
  std::string name;
  std::vector<Eigen::Vector3d> points_m;
};

/// One beam of a log, without its intensities.
struct SceneBeam {
  double time_s = 0.0;
  double bearing_rad = 0.0;
  double bin_length_m = 0.0;          ///< of the bins of its row
  std::optional<double> echo_m = {};  ///< range of the first echo
  double echo_probability = 0.5;      ///< of the cells that it hits: the evidence of the echo
  /// Intensity that the detector compared with: its level (Detector::kLevel, kMax), else the filtered intensity of the
  /// echo's first bin, which exceeds the one before by the threshold. nullopt: unknown.
  std::optional<double> threshold = {};
  std::uint32_t sweep = 0;  ///< counted from 0
};

/// A log of beams with its echoes.
struct SceneLog {
  static constexpr std::size_t kMaxBins = 512;

  std::string name;
  double beam_width_rad = 0.0, beam_height_rad = 0.0;
  Pose body_from_sonar = Pose::Identity();
  std::optional<std::size_t> path = {};  ///< index in Scene::paths; nullopt: the vehicle is at the origin
  std::vector<SceneBeam> beams;
  std::size_t bins = 0;                   ///< of each row, at most kMaxBins
  std::vector<std::uint8_t> intensities;  ///< a row for each beam; shorter beams are padded with 0

  std::span<const std::uint8_t> row(std::size_t beam) const {
    return std::span(intensities).subspan(beam * bins, bins);
  }
};

/// What the page shows: maps, paths of vehicles, clouds of points and logs, in one frame.
struct Scene {
  std::string title;
  std::vector<SceneMap> maps;
  std::vector<ScenePath> paths;
  std::vector<ScenePoints> points;
  std::vector<SceneLog> logs;
  std::vector<std::string> notes;  ///< remarks, sentences without a full stop

  /// Subtracted from the coordinates that are sent as floats, so that these are exact to a millimetre: whole metres,
  /// zero unless the scene is far from zero.
  Eigen::Vector3d origin_m() const;
  bool empty() const { return maps.empty() && paths.empty() && points.empty() && logs.empty(); }
};

/// Most points of a cloud that are shown; larger clouds are thinned.
inline constexpr std::size_t kMaxPoints = 2'000'000;

/// Adds a map, the surface of a mesh, a trajectory, or a cloud.
/// @param surface  options of a mesh's map
/// @return kUnsupported for other files; errors of reading, which name the file
Result<void> add_file(const FileBytes& file, const MapOptions& surface, Damage damage, Scene& scene);

/// Adds the path of a vehicle.
void add_path(std::string name, Trajectory trajectory, Scene& scene);

/// Adds the beams of a recording with the echoes that build_map detects, its path, and the points of its scans.
/// @param path   of the recording's vehicle
/// @param build  as for build_map
/// @return errors of reading
Result<void> add_recording(const Recording& recording, const VehiclePath& path, const BuildOptions& build,
                           Scene& scene);

/// Joins each `group` successive bins into one with their maximum; the last one may have fewer.
/// REQUIRES group > 0
std::vector<std::uint8_t> join_bins(std::span<const std::uint8_t> bins, std::size_t group);

/// A log with fewer bins, or fewer intensities: multiples of `step`, rounded up.
/// REQUIRES group > 0, step > 0
SceneLog reduced(const SceneLog& log, std::size_t group, int step);

}  // namespace pingvox::web
