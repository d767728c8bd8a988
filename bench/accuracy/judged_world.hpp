#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "accuracy/cell_grid.hpp"
#include "accuracy/map_score.hpp"
#include "accuracy/recording.hpp"
#include "accuracy/true_returns.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/beam_model.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox::bench {

/// Where a map of a world is judged.
enum class Extent {
  kPlane,  ///< the layer of cells that holds z = 0, in which the head turns
  kSpace,  ///< all of the world, and 3 m of what is behind its walls
};

/// The truth of a world in cells of one size, ready to judge maps. What lies behind a side of the world that has no
/// wall (above the surface, out of the harbour's mouth, beyond the seabed's edge) is neither right nor wrong: it is
/// left out.
class JudgedWorld {
 public:
  /// @param visible_m  points on surfaces that could be seen
  static Result<JudgedWorld> make(const Recording& recording, Extent extent, double resolution_m,
                                  const std::vector<Eigen::Vector3d>& visible_m);

  /// REQUIRES a map of this resolution and 16 levels.
  MapScore score(const OccupancyMap& map) const { return score(map, map.options().thresholds); }
  MapScore score(const OccupancyMap& map, const Thresholds& thresholds) const;
  const CellBox& box() const { return box_; }
  const CellGrid& truth() const { return truth_; }
  const CellGrid& visible() const { return visible_; }

 private:
  JudgedWorld(CellBox box, CellGrid truth, CellGrid visible)
      : box_(std::move(box)), truth_(std::move(truth)), visible_(std::move(visible)) {}
  CellBox box_;
  CellGrid truth_, visible_;
};

/// One optional echo for each beam of a recording, in order.
using Echoes = std::vector<std::optional<Echo>>;

Echoes detect(const Recording& recording, const FilterOptions& filter, const EchoOptions& options);

/// The same echoes, each taken to be in the middle of its first bin, as in the paper.
Echoes at_first_bins(Echoes echoes, double bin_length_m);

/// What a perfect detector would find on the axis of each beam.
Echoes true_echoes(const Recording& recording, const std::vector<TrueReturns>& truths, double min_range_m);

/// The map of given echoes: what build_map makes of them. @return kLimit when it would grow too large
Result<OccupancyMap> map_echoes(const Recording& recording, const Echoes& echoes, const BeamModelOptions& model,
                                double resolution_m);

}  // namespace pingvox::bench
