#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pingvox/map/trace_ray.hpp"
#include "pingvox/result.hpp"
#include "pingvox/viewer/picture.hpp"

namespace pingvox::bench {

/// A cell of a plane grid: (0, 0) covers 0..1 along both axes.
struct GridCell {
  std::int64_t x = 0, y = 0;
  friend bool operator==(const GridCell&, const GridCell&) = default;
};

/// A ray on a grid (paper, figures 9 to 12): its exact segment, and the cells that a traversal marks.
struct RayFigure {
  Eigen::Vector2d from{0.5, 0.5}, to{0.5, 0.5};  ///< ends of the segment, in cells; finite, below 2^40
  std::vector<GridCell> marked;

  /// kBadOption: an end that is not finite or too far away, or a grid of more than kMaxCells along an axis
  Result<void> validate() const;
  static constexpr std::int64_t kMaxCells = 400;
};

/// The cells that one of the library's traversals marks between two points, the last one included.
/// REQUIRES ends below 2^40
RayFigure ray_figure(const Eigen::Vector2d& from, const Eigen::Vector2d& to, RayAlgorithm algorithm);

/// Draws the segment (start: disc, end: ring) and three kinds of cells: crossed and marked, crossed but not marked
/// (missed by the traversal), and marked but not crossed. `side_by_side` puts two figures beside each other.
/// @param target_px  approximate length of the longer side of the grid, 64..3072
/// REQUIRES a valid figure
Picture render_ray(const RayFigure& figure, std::size_t target_px = 600);

}  // namespace pingvox::bench
