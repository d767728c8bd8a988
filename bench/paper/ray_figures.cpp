#include "ray_figures.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/draw/render_ray.hpp"
#include "geometry/internal/ray_dda.hpp"
#include "paper_dda.hpp"
#include "pingvox/viewer/side_by_side.hpp"

namespace pingvox::bench {
namespace {

constexpr std::size_t kPanel_px = 360;
constexpr double kCell_m = 0.1;
using Cell = std::array<std::int64_t, 3>;

/// Metres of a point in cells of 0.1 m.
Eigen::Vector3d metres(const Eigen::Vector3d& cells) {
  return cells / 10.0;
}

/// The paper's traversal plus the end cell, which is always hit.
std::vector<Cell> paper_cells(const Eigen::Vector3d& from, const Eigen::Vector3d& to, PaperStop stop) {
  std::vector<Cell> cells = paper_dda<double>(metres(from), metres(to), kCell_m, stop);
  const auto axis = [&](int i) { return static_cast<std::int64_t>(std::floor(to[i])); };
  cells.push_back({axis(0), axis(1), axis(2)});
  return cells;
}

/// Distance from the last cell to the end cell; 1 is correct.
std::int64_t last_jump(const std::vector<Cell>& cells) {
  if (cells.size() < 2) return 1;
  const Cell &end = cells.back(), &before = cells[cells.size() - 2];
  return std::abs(end[0] - before[0]) + std::abs(end[1] - before[1]) + std::abs(end[2] - before[2]);
}

/// The ray with the largest last jump.
template <class Ends>
Eigen::Vector3d worst_end(const Ends& ends, const Eigen::Vector3d& from, PaperStop stop) {
  Eigen::Vector3d worst = ends.front();
  for (const Eigen::Vector3d& to : ends) {
    if (last_jump(paper_cells(from, to, stop)) > last_jump(paper_cells(from, worst, stop))) worst = to;
  }
  return worst;
}

/// Cells and segment seen from above.
RayFigure figure_of(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const std::vector<Cell>& cells) {
  RayFigure figure{.from = from.head<2>(), .to = to.head<2>(), .marked = {}};
  for (const Cell& cell : cells) figure.marked.push_back({cell[0], cell[1]});
  return figure;
}

/// Cells of our DDA, including the end cell.
std::vector<Cell> our_cells(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Lattice lattice(kCell_m);
  std::vector<Cell> cells;
  const auto add = [&](const Key& key) { cells.push_back({key.x - 32768, key.y - 32768, key.z - 32768}); };
  const auto ray = dda<std::uint16_t>(lattice, metres(from), metres(to));
  const auto end = lattice.key_of(metres(to));
  if (!ray || !end) return cells;
  for (const Key key : *ray) add(key);
  add(*end);
  return cells;
}

Panel panel(const RayFigure& figure, std::string caption) {
  return {render_ray(figure, kPanel_px), std::move(caption)};
}

}  // namespace

Result<Picture> diagonal_rays() {
  // Not through corners, where rounding decides.
  const Eigen::Vector2d from(0.5, 0.3), to(11.5, 11.3), slant(11.5, 7.1);
  const std::array panels = {
      panel(ray_figure(from, to, RayAlgorithm::kBresenham), "9: a diagonal by Bresenham: cells touch at corners only"),
      panel(ray_figure(from, to, RayAlgorithm::kDda), "10: by DDA: it goes from face to face"),
      panel(ray_figure(from, slant, RayAlgorithm::kBresenham), "Bresenham on a slant misses cells that are crossed"),
      panel(ray_figure(from, slant, RayAlgorithm::kDda), "DDA misses none")};
  return side_by_side(panels);
}

Result<Picture> lost_ends() {
  // To the middle of a face, and to a corner with one component falling: the end cell is entered through one face and
  // left through another at the same place.
  std::vector<Eigen::Vector3d> on_faces, on_corners;
  for (int x = 6; x <= 12; ++x) {
    for (int y = 3; y < x; ++y) {
      on_faces.emplace_back(x, y + 0.5, 0.5);
      on_corners.emplace_back(x, -y, 0.5);
    }
  }
  const Eigen::Vector3d from(0.5, 0.5, 0.5);
  const Eigen::Vector3d missing = worst_end(on_faces, from, PaperStop::kBeyondLength);
  const Eigen::Vector3d snapping = worst_end(on_corners, from, PaperStop::kTravelled);
  const std::array panels = {panel(figure_of(from, missing, paper_cells(from, missing, PaperStop::kBeyondLength)),
                                   "11: the paper's DDA, stopped beyond the length: its last cell is missing"),
                             panel(figure_of(from, missing, our_cells(from, missing)), "ours"),
                             panel(figure_of(from, snapping, paper_cells(from, snapping, PaperStop::kTravelled)),
                                   "12: stopped by the distance travelled: past its end, and snapping back"),
                             panel(figure_of(from, snapping, our_cells(from, snapping)), "ours")};
  return side_by_side(panels);
}

}  // namespace pingvox::bench
