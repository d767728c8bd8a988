#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/log_odds.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/map/trace_ray.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {

/// Volume that a beam is assumed to insonify.
enum class BeamShape {
  kRay,   ///< its axis only: the paper's 2D map
  kFan,   ///< its horizontal width, in the plane of the head
  kCone,  ///< width and height, on the sphere: the echo may come from anywhere on an arc
};

/// Evidence of a hit.
enum class HitFrom {
  kFixed,      ///< `hit` for each echo
  kIntensity,  ///< by the intensity of the echo, see `evidence_of_intensity`
};

/// Meaning of a beam without an echo.
enum class Silent {
  kNothing,  ///< nothing: the sound may have been absorbed, or reflected away
  kFree,     ///< its cells are free up to the end of its bins
};

/// How fan and cone find the cells in their volume.
enum class Tracing {
  kGeometry,  ///< from the volume's closed form (insonified_volume.hpp)
  kBundle,    ///< by rays as dense as the far end needs: slower, to check the first
};

struct BeamModelOptions {
  BeamShape shape = BeamShape::kCone;
  Tracing tracing = Tracing::kGeometry;
  double width_rad = 3.0 * kDegree_rad;    ///< horizontal, full angle; Micron data sheet
  double height_rad = 35.0 * kDegree_rad;  ///< vertical, full angle; Micron data sheet
  /// Central fraction of width and height that frees cells. Width and height are those of half power one way; within
  /// 0.72 of them (of sin(u) / u) it is half power both ways. Objects farther out return less than half and may not be
  /// detected. Hits use the whole beam nevertheless.
  double free_share = 0.72;
  RayAlgorithm ray = RayAlgorithm::kDda;
  HitFrom hit_from = HitFrom::kIntensity;
  LogOdds hit = LogOdds::from_probability(0.7);  ///< evidence of an echo; with kIntensity of the strongest possible one
  Silent silent = Silent::kNothing;

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Options with the width and height of a head's beam, as its maker says; unchanged for nullptr, a head that is not
/// known. As in `beam_of_head(source.device())` for the head that a log names.
BeamModelOptions beam_of_head(const DeviceProfile* head, BeamModelOptions options = {});

/// Evidence of an echo by its strength: half of `hit` for the faintest that a detector lets through, all of it at 255,
/// linear in between. Monotone, and never more than `hit`.
LogOdds evidence_of_intensity(std::uint8_t intensity, LogOdds hit);

/// Share of an echo's evidence for a cell of its arc. The arc is `cells_on_arc` cells long and the echo came from at
/// least one of them, so the evidence is divided by the fourth root of their number (a compromise between 1, as if it
/// came from all, and n, as if from one; docs/decisions.md), and weighted by the vertical beam pattern: half at the
/// edge, where the beam is 3 dB weaker. A cell on the edge may have its middle beyond it.
double share_on_arc(double elevation_rad, double height_rad, double cells_on_arc);

/// Directions (unit, sensor frame) that fill the beam so densely that each cell whose centre lies in the insonified
/// volume within `range_m` is crossed by one: neighbours are at most resolution / sqrt(2) apart at that range.
struct BundleRay {
  Eigen::Vector3d direction;
  double share = 1.0;  ///< of the echo's evidence, for the cell where the ray ends
};
std::vector<BundleRay> beam_bundle(const BeamModelOptions& options, double bearing_rad, double range_m,
                                   double resolution_m);

/// Approximate number of cells in a beam up to a range [m].
double cells_in_beam(const BeamModelOptions& options, double range_m, double resolution_m);

/// Maximum for one beam in `build_map`: such a scan needs some hundred megabytes.
inline constexpr double kMaxCellsInBeam = 3e8;

/// Adds one beam to `scan`: cells missed up to the first bin of the echo, and cells hit at its range with their share
/// of the evidence. Cells between the two are not updated.
/// @param map_from_sensor  pose of the head at the beam's time
/// @return the number of rays left out because an end of them lies outside of the scan's lattice
std::size_t trace_beam(const Pose& map_from_sensor, const Beam& beam, const std::optional<Echo>& echo,
                       const BeamModelOptions& options, ScanUpdate& scan);

}  // namespace pingvox
