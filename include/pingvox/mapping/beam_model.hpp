#pragma once

#include <optional>

#include "pingvox/geometry/lattice.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/log_odds.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/map/trace_ray.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"
#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox {

/// What a beam is taken to have insonified.
enum class BeamShape {
  kRay,   ///< its axis only: the paper's 2D map
  kFan,   ///< its horizontal width, in the plane of the head
  kCone,  ///< width and height, on the sphere: the echo may come from anywhere on an arc
};

/// Where a hit's evidence comes from.
enum class HitFrom {
  kFixed,      ///< `hit` for each echo
  kIntensity,  ///< as sure as the echo was strong, see `evidence_of_intensity`
};

/// What a beam without an echo says.
enum class Silent {
  kNothing,  ///< nothing: the sound may have been absorbed, or reflected away
  kFree,     ///< its cells are free up to the end of its bins (or to max_range_m)
};

struct BeamModelOptions {
  BeamShape shape = BeamShape::kRay;
  double width_rad = 3.0 * 3.14159265358979323846 / 180.0;    ///< horizontal, full angle; Micron data sheet
  double height_rad = 35.0 * 3.14159265358979323846 / 180.0;  ///< vertical, full angle; Micron data sheet
  RayAlgorithm ray = RayAlgorithm::kDda;
  HitFrom hit_from = HitFrom::kIntensity;
  LogOdds hit = LogOdds::from_probability(0.7);  ///< evidence of an echo; with kIntensity of the strongest possible one
  LogOdds miss = LogOdds::from_probability(0.4);  ///< evidence of sound having passed
  Silent silent = Silent::kNothing;
  double max_range_m = 1e9;  ///< cells farther away are never touched

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Adds to `scan` what one beam says: cells freed up to the echo, cells hit with their share of the evidence.
/// @param map_from_sensor  the head's pose when the beam was heard
/// @return the number of rays left out because an end of them lies outside of the lattice
std::size_t trace_beam(const Lattice& lattice, const Pose& map_from_sensor, const Beam& beam,
                       const std::optional<Echo>& echo, const BeamModelOptions& options, ScanUpdate& scan);

}  // namespace pingvox
