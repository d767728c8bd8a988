#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "accuracy/recording.hpp"
#include "accuracy/true_returns.hpp"
#include "pingvox/analysis/map_agreement.hpp"
#include "pingvox/analysis/visible_cells.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/beam_model.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox::bench {

/// The part of a world in which maps are scored.
enum class Extent {
  kPlane,  ///< the layer of cells at z = 0, in which the head turns
  kSpace,  ///< all of the world, and 3 m behind its walls
};

/// The ground truth of a world in cells of one size, ready to judge maps as `pingvox compare --visible-from` does: what
/// lies beyond a side without a wall is left out, and only what could be seen from where the head was is to be found.
class GroundTruth {
 public:
  static Result<GroundTruth> make(const Recording& recording, Extent extent, double resolution_m, double min_range_m);
  /// @param map_from_sensor  poses of the head, at least one
  static Result<GroundTruth> make(const Scene& scene, std::span<const Pose> map_from_sensor, const ViewOptions& view,
                                  Extent extent, double resolution_m);

  /// REQUIRES a map of this resolution and 16 levels. @return kUnsupported when nothing is known in the plane
  Result<MapAgreement> score(const OccupancyMap& map) const { return score(map, map.options().thresholds); }
  Result<MapAgreement> score(const OccupancyMap& map, const Thresholds& thresholds, std::uint32_t near_cells = 1) const;

 private:
  GroundTruth(Extent extent, OccupancyMap truth, OccupancyMap visible)
      : extent_(extent), truth_(std::move(truth)), visible_(std::move(visible)) {}
  Extent extent_;
  OccupancyMap truth_, visible_;
};

/// One optional echo for each beam of a recording, in order.
using Echoes = std::vector<std::optional<Echo>>;

Echoes detect(const Recording& recording, const FilterOptions& filter, const EchoOptions& options);

/// The same echoes with the range of the centre of their first bin, as in the paper.
Echoes at_first_bins(Echoes echoes, double bin_length_m);

/// Echoes of a perfect detector on the axis of each beam.
Echoes true_echoes(const Recording& recording, const std::vector<TrueReturns>& truths, double min_range_m);

/// The map that build_map makes of given echoes. @return kLimit when it would grow too large
Result<OccupancyMap> map_echoes(const Recording& recording, const Echoes& echoes, const BeamModelOptions& model,
                                double resolution_m);

}  // namespace pingvox::bench
