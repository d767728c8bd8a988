#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/point_scan.hpp"
#include "pingvox/mapping/beam_model.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"

namespace pingvox {

/// How the beams of one sweep vote on a cell.
enum class Vote {
  kPerSweep,  ///< one vote a cell and sweep, a hit beats a miss: liboctomap's insertPointCloud
  kPerBeam,   ///< each beam votes
};

struct BuildOptions {
  FilterOptions filter;
  EchoOptions echo;
  BeamModelOptions model;
  Vote vote = Vote::kPerSweep;
  Pose body_from_sensor = Pose::Identity();  ///< the mount
  std::size_t threads = 1;                   ///< that trace a sweep (or scan) together, 1..256; the map is the same
  double sound_speed_ratio = 1.0;            ///< true sound speed / the one the device assumed: scales every range

  Result<void> validate() const;  ///< kBadOption names every broken field at once

  /// What echoes are looked for: `echo`, and none beyond the model's max_range_m. kBadOption when that lies within the
  /// blanking range, which point scans do not have.
  Result<EchoOptions> echo_within_range() const;
};

/// What was read and what became of it.
struct BuildReport {
  std::size_t beams = 0;    ///< mapped, those of incomplete sweeps included
  std::size_t sweeps = 0;   ///< complete ones (or point scans)
  std::size_t echoes = 0;   ///< within the model's range; of point scans all points
  std::size_t skipped = 0;  ///< damaged, outside of the trajectory's time, or outside of the lattice
  std::size_t outside = 0;  ///< of those skipped, the ones that a part of lies outside of the lattice
  std::uint64_t cells_freed = 0, cells_hit = 0;  ///< votes, summed over scans
  struct Seconds {
    double read = 0, detect = 0, trace = 0, apply = 0;
  } seconds;
};

/// Called after each scan with the beams so far, so that a caller can show how far it is.
using Progress = std::function<void(const BuildReport&)>;

/// From beams to a map: the program in one function (docs/architecture.md). Echoes are those within the model's
/// max_range_m; a beam that heard only what is beyond frees its cells up to there.
/// @param map_from_body  where the vehicle was; beams outside of its time are left out and counted
/// @return kBadOption when max_range_m is not beyond the blanking range, the source's error when it fails, kLimit when
///         the map would grow too large. The map keeps what was applied.
Result<BuildReport> build_map(BeamSource& source, const Trajectory& map_from_body, const BuildOptions& options,
                              OccupancyMap& map, const Progress& progress = {});

/// The same for scans of end points: of the options only `model` matters (ray, hit, miss, max_range_m).
Result<BuildReport> build_map(ScanSource& source, const BuildOptions& options, OccupancyMap& map,
                              const Progress& progress = {});

}  // namespace pingvox
