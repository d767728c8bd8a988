#include "ray_cells.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "geometry/internal/ray_bresenham.hpp"
#include "geometry/internal/ray_dda.hpp"

namespace pingvox::bench {
namespace {

using test::ExactSegment;
using Cell = ExactSegment::Cell;

Eigen::Vector3d cells_of(const ExactSegment::Point& point) {
  const auto axis = [&](std::size_t i) { return std::ldexp(static_cast<double>(point[i]), -ExactSegment::kShift); };
  return {axis(0), axis(1), axis(2)};
}

template <class Keys>
std::vector<Cell> list_cells(const Keys& keys) {
  std::vector<Cell> cells;
  for (const Key key : keys) {
    cells.push_back({std::int64_t{key.x} - 32768, std::int64_t{key.y} - 32768, std::int64_t{key.z} - 32768});
  }
  return cells;
}

}  // namespace

void RayJudgement::add(const ExactSegment& segment, const std::vector<Cell>& cells) {
  const std::set<Cell> on_ray(cells.begin(), cells.end());
  for (const Cell& cell : segment.cells()) {
    if (!segment.meets(cell, -ExactSegment::kGraze)) continue;
    ++crossed;
    missed += on_ray.contains(cell) ? 0U : 1U;
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ++walked;
    strayed += segment.meets(cells[i], ExactSegment::kGraze) ? 0U : 1U;
    if (i == 0) continue;
    const auto differs = [&](std::size_t axis) { return cells[i][axis] != cells[i - 1][axis] ? 1 : 0; };
    diagonal += differs(0) + differs(1) + differs(2) > 1 ? 1U : 0U;
  }
}

Eigen::Vector3d RandomSegment::from_cells() const {
  return cells_of(from);
}
Eigen::Vector3d RandomSegment::to_cells() const {
  return cells_of(to);
}

std::vector<RandomSegment> random_segments(std::size_t count, int dimensions, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  constexpr std::int64_t kReach = 100;
  const auto axis = [&] {
    return static_cast<std::int64_t>(random() % (2 * static_cast<std::uint64_t>(kReach) << ExactSegment::kShift)) -
           (kReach << ExactSegment::kShift);
  };
  const auto end = [&]() -> ExactSegment::Point {
    const std::int64_t x = axis(), y = axis(), z = axis();
    return {x, y, dimensions == 2 ? ExactSegment::kUnit / 2 : z};
  };
  std::vector<RandomSegment> segments;
  segments.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const ExactSegment::Point from = end(), to = end();
    segments.push_back({from, to});
  }
  return segments;
}

std::vector<Cell> dda_cells(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const auto ray = dda<std::uint16_t>(Lattice(1.0), from, to);
  return ray ? list_cells(*ray) : std::vector<Cell>();
}

std::vector<Cell> bresenham_cells(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Lattice lattice(1.0);
  const auto start = lattice.key_of(from), end = lattice.key_of(to);
  return start && end ? list_cells(bresenham(*start, *end)) : std::vector<Cell>();
}

}  // namespace pingvox::bench
