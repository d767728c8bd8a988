#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/support/exact_segment.hpp"

namespace pingvox::bench {

/// Cells of a traversal compared with those that the segment crosses by exact arithmetic. Cells touched within 1e-9 of
/// a cell of a face, edge or corner are not counted.
struct RayJudgement {
  std::size_t crossed = 0;   ///< cells before the end cell that the segment crosses
  std::size_t missed = 0;    ///< of these, not in the traversal
  std::size_t walked = 0;    ///< cells of the traversal
  std::size_t strayed = 0;   ///< of these, not crossed
  std::size_t diagonal = 0;  ///< steps that change more than one component
  void add(const test::ExactSegment& segment, const std::vector<test::ExactSegment::Cell>& cells);
};

/// A random segment, ends within 100 cells of the origin and exact as doubles.
struct RandomSegment {
  test::ExactSegment::Point from, to;  ///< in 2^-40 of a cell
  Eigen::Vector3d from_cells() const;
  Eigen::Vector3d to_cells() const;
};

/// @param dimensions  2: both ends in the plane z = 0.5
std::vector<RandomSegment> random_segments(std::size_t count, int dimensions, std::uint64_t seed);

/// Cells of 1 m, counted from the origin.
std::vector<test::ExactSegment::Cell> dda_cells(const Eigen::Vector3d& from, const Eigen::Vector3d& to);
std::vector<test::ExactSegment::Cell> bresenham_cells(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace pingvox::bench
