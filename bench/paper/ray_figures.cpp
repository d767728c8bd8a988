#include "ray_figures.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "letter_dda.hpp"
#include "pingvox/viewer/render_ray.hpp"
#include "pingvox/viewer/side_by_side.hpp"

namespace pingvox::bench {
namespace {

constexpr std::size_t kPanel_px = 420;
constexpr double kCell_m = 0.1;

/// A ray from the origin to a corner of cells, by the letter: with the cell it is to end in, which is hit in any case.
RayFigure letter_figure(const Eigen::Vector2d& to, LetterStop stop) {
  RayFigure figure{.from = {0.0, 0.0}, .to = to, .marked = {}};
  const Eigen::Vector3d to_m(to.x() / 10.0, to.y() / 10.0, 0.0);
  for (const auto& cell : letter_dda<double>(Eigen::Vector3d::Zero(), to_m, kCell_m, stop)) {
    figure.marked.push_back({cell[0], cell[1]});
  }
  figure.marked.push_back({static_cast<std::int64_t>(to.x()), static_cast<std::int64_t>(to.y())});
  return figure;
}

/// The length of the jump from the last cell but one to the end cell, in cells; 1 is as it should be.
double last_jump(const RayFigure& figure) {
  if (figure.marked.size() < 2) return 1.0;
  const GridCell &end = figure.marked.back(), &before = figure.marked[figure.marked.size() - 2];
  return static_cast<double>(std::abs(end.x - before.x) + std::abs(end.y - before.y));
}

/// The shortest ray to a corner whose end is lost the most.
Eigen::Vector2d worst_end(LetterStop stop) {
  Eigen::Vector2d worst(1.0, 1.0);
  double most = 0.0;
  for (int x = 4; x <= 14; ++x) {
    for (int y = 2; y < x; ++y) {
      const Eigen::Vector2d to(x, y);
      const double jump = last_jump(letter_figure(to, stop));
      if (jump > most) most = jump, worst = to;
    }
  }
  return worst;
}

Panel panel(const RayFigure& figure, std::string caption) {
  return {render_ray(figure, kPanel_px), std::move(caption)};
}

}  // namespace

Result<Picture> diagonal_rays() {
  const Eigen::Vector2d from(0.5, 0.5), to(11.5, 11.5), slant(11.5, 7.5);
  const std::array panels = {
      panel(ray_figure(from, to, RayAlgorithm::kBresenham), "9: a diagonal by Bresenham: cells touch at corners only"),
      panel(ray_figure(from, to, RayAlgorithm::kDda), "10: by DDA: it goes from face to face"),
      panel(ray_figure(from, slant, RayAlgorithm::kBresenham), "Bresenham on a slant misses cells that are crossed"),
      panel(ray_figure(from, slant, RayAlgorithm::kDda), "DDA misses none")};
  return side_by_side(panels);
}

Result<Picture> lost_ends() {
  const Eigen::Vector2d missing = worst_end(LetterStop::kBeyondLength), snapping = worst_end(LetterStop::kTravelled);
  const std::array panels = {panel(letter_figure(missing, LetterStop::kBeyondLength),
                                   "11: the paper's DDA, stopped beyond the length: the last cells are missing"),
                             panel(ray_figure({0.0, 0.0}, missing, RayAlgorithm::kDda), "ours"),
                             panel(letter_figure(snapping, LetterStop::kTravelled),
                                   "12: stopped by the distance travelled: it snaps at the end"),
                             panel(ray_figure({0.0, 0.0}, snapping, RayAlgorithm::kDda), "ours")};
  return side_by_side(panels);
}

}  // namespace pingvox::bench
