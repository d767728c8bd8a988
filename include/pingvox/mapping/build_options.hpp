#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/log_odds.hpp"
#include "pingvox/mapping/beam_model.hpp"
#include "pingvox/mapping/sweep_coverage.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"

namespace pingvox {

/// How often a cell is updated.
enum class Vote {
  kPerSweep,  ///< once per sweep, a hit beats a miss: liboctomap's insertPointCloud
  kPerBeam,   ///< once per beam
};

/// When a beam goes into the map.
enum class Timing {
  kBySweep,  ///< with its sweep, when that is complete: the least work, and beams in the order of recording
  kByBeam,   ///< as soon as the neighbours that affect its echo are there; needs Vote::kPerBeam
};

struct BuildOptions {
  FilterOptions filter;
  EchoOptions echo;  ///< its max_range_m: no cell farther away is touched, by rays of points neither
  BeamModelOptions model;
  LogOdds miss = LogOdds::from_probability(0.4);  ///< evidence of a beam that passed through a cell
  Vote vote = Vote::kPerSweep;
  Timing timing = Timing::kBySweep;
  Pose body_from_sensor = Pose::Identity();  ///< the mount
  std::size_t threads = 1;                   ///< that trace a sweep (or scan) together, 1..256; the map is the same
  double sound_speed_ratio = 1.0;            ///< true sound speed / the one the device assumed: scales every range

  Result<void> validate() const;  ///< kBadOption names every broken field at once
  /// The same for scans of points, which are neither filtered nor searched for echoes and have no blanking range.
  Result<void> validate_for_points() const;
};

/// Beams (or points) that were left out for one reason.
struct LeftOut {
  std::size_t count = 0;
  std::optional<double> first_s;  ///< time of the first one; unknown for points

  void add(double time_s) {
    if (count++ == 0) first_s = time_s;
  }
};

/// Counts of what was read and mapped.
struct BuildReport {
  std::size_t beams = 0;    ///< mapped, those of incomplete sweeps included
  std::size_t sweeps = 0;   ///< complete ones whose beams were all mapped (or point scans)
  std::size_t echoes = 0;   ///< within max_range_m; of point scans all points
  std::size_t skipped = 0;  ///< damaged, without a pose, blocked, too long, or outside
  LeftOut no_pose;          ///< of those skipped, those at times without a pose
  LeftOut blocked;          ///< of those skipped, those with an obstacle of the map nearer than the blanking range
  LeftOut too_long;  ///< of those skipped, those of ten times the usual range of the beams around, or of too many cells
  LeftOut outside;   ///< of those skipped, those that are partly outside of the lattice; they count as mapped too
  std::optional<int> min_threshold, max_threshold;  ///< that echoes were detected with; nullopt: no echoes
  std::optional<double> first_s, last_s;            ///< least and greatest time of a beam, mapped or not
  std::uint64_t cells_freed = 0, cells_hit = 0;     ///< cell updates, summed over scans
  SweepCoverage coverage;                           ///< of beams, when build_map is done; else nothing
  struct Seconds {
    double read = 0, detect = 0, trace = 0, apply = 0;
  } seconds;
};

}  // namespace pingvox
