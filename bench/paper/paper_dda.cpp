#include "paper_dda.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pingvox::bench {

template <class Real>
std::vector<std::array<std::int64_t, 3>> paper_dda(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                                   double resolution_m, PaperStop stop) {
  using Cell = std::array<std::int64_t, 3>;
  // As for keys: multiply by the inverse.
  const auto cell_of = [&](const Eigen::Vector3d& point) {
    const double cells_per_m = 1.0 / resolution_m;
    const auto axis = [&](int i) { return static_cast<std::int64_t>(std::floor(point[i] * cells_per_m)); };
    return Cell{axis(0), axis(1), axis(2)};
  };
  const Cell start = cell_of(from), end = cell_of(to);
  const auto cells_from_start = [&](const Cell& cell) {
    return std::hypot(static_cast<Real>(cell[0] - start[0]), static_cast<Real>(cell[1] - start[1]),
                      static_cast<Real>(cell[2] - start[2]));
  };
  const auto edge = static_cast<Real>(resolution_m);
  const Eigen::Matrix<Real, 3, 1> way = (to - from).cast<Real>();
  const Real length = way.norm();
  std::array<Real, 3> next{}, apart{};
  std::array<std::int64_t, 3> step{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Real direction = way[axis] / length;
    step[i] = direction > 0 ? 1 : -1;
    const Real border = static_cast<Real>(start[i] + (direction > 0 ? 1 : 0)) * edge;
    next[i] = direction == 0 ? std::numeric_limits<Real>::max() : (border - static_cast<Real>(from[axis])) / direction;
    apart[i] = direction == 0 ? Real{0} : edge / std::abs(direction);
  }
  std::vector<Cell> cells;
  for (Cell at = start; at != end;) {
    const auto i = static_cast<std::size_t>(std::min_element(next.begin(), next.end()) - next.begin());
    if (stop == PaperStop::kBeyondLength && next[i] > length) break;
    if (stop == PaperStop::kTravelled && cells_from_start(at) > cells_from_start(end)) break;
    cells.push_back(at);
    at[i] += step[i];
    next[i] += apart[i];
  }
  return cells;
}

template std::vector<std::array<std::int64_t, 3>> paper_dda<float>(const Eigen::Vector3d&, const Eigen::Vector3d&,
                                                                   double, PaperStop);
template std::vector<std::array<std::int64_t, 3>> paper_dda<double>(const Eigen::Vector3d&, const Eigen::Vector3d&,
                                                                    double, PaperStop);

}  // namespace pingvox::bench
