#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pingvox::bench {

/// A straight wall: the segment that fits its echoes best (total least squares).
struct WallLine {
  Eigen::Vector2d from_m, to_m;
  double deviation_m = 0.0;  ///< standard deviation of its echoes across
  std::uint32_t echoes = 0;
};

/// Where two walls meet.
struct Corner {
  Eigen::Vector2d place_m;
  std::uint32_t line, other_line;  ///< indices
};

/// The feature map of the paper's section 3.2, in the plane of the head.
struct LineMap {
  std::vector<WallLine> lines;
  std::vector<Corner> corners;

  std::size_t memory_bytes() const { return lines.size() * sizeof(lines[0]) + corners.size() * sizeof(corners[0]); }
};

struct LineOptions {
  double max_gap_m = 1.0;      ///< between neighbouring echoes of a line, and between lines that are made one
  double max_across_m = 0.15;  ///< of an echo from the chord, and of the ends of two lines from their common one
  double min_length_m = 0.7;
  std::size_t min_echoes = 6;   ///< of one sweep
  double max_corner_m = 0.4;    ///< from the end of a line to the corner with another one
  double min_corner_rad = 0.5;  ///< between two walls that make a corner
};

/// Lines by split-and-merge (Nguyen et al. 2005, A comparison of line extraction algorithms using 2D laser
/// rangefinder): each sweep's echoes are split at gaps, and at the echo that is farthest from the chord, until none is
/// far. Lines of all sweeps are merged where one line fits both, by adding up their moments. What only one of several
/// sweeps saw is left out: a pile is an arc of the beam's width, another one from each place. Walls that end near their
/// intersection end in it, since the corner itself is seldom heard.
/// @param sweeps  echoes [m, map frame] in the order of their bearings; finite
LineMap extract_lines(std::span<const std::vector<Eigen::Vector2d>> sweeps, const LineOptions& options);

}  // namespace pingvox::bench
