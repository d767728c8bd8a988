#include "draw/render_ray.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "geometry/internal/ray_bresenham.hpp"
#include "geometry/internal/ray_dda.hpp"
#include "viewer/axis.hpp"
#include "viewer/colours.hpp"
#include "viewer/label.hpp"

namespace pingvox::bench {
namespace {

constexpr double kMaxCoordinate = 1099511627776.0;  // 2^40: doubles still resolve a thousandth of a cell
constexpr Rgb kMarkedCell{120, 168, 214}, kBeyondCell{34, 52, 110}, kSegment{20, 20, 20}, kMissedCell{222, 100, 0};

enum class State { kNone, kMarked, kMissed, kBeyond };

/// The drawn part of the grid, with a margin of one cell.
struct Grid {
  std::int64_t x, y, nx, ny;
};

Grid grid_of(const RayFigure& figure) {
  const auto cell = [](double at) { return static_cast<std::int64_t>(std::floor(at)); };
  std::int64_t low_x = cell(std::min(figure.from.x(), figure.to.x()));
  std::int64_t high_x = cell(std::max(figure.from.x(), figure.to.x()));
  std::int64_t low_y = cell(std::min(figure.from.y(), figure.to.y()));
  std::int64_t high_y = cell(std::max(figure.from.y(), figure.to.y()));
  for (const GridCell& c : figure.marked) {
    low_x = std::min(low_x, c.x);
    high_x = std::max(high_x, c.x);
    low_y = std::min(low_y, c.y);
    high_y = std::max(high_y, c.y);
  }
  return {low_x - 1, low_y - 1, high_x - low_x + 3, high_y - low_y + 3};
}

/// Whether the segment crosses the interior of a cell, or ends on one of its lower edges; touching is not enough.
bool crosses(const RayFigure& figure, std::int64_t x, std::int64_t y) {
  if (std::floor(figure.from.x()) == static_cast<double>(x) && std::floor(figure.from.y()) == static_cast<double>(y)) {
    return true;
  }
  if (std::floor(figure.to.x()) == static_cast<double>(x) && std::floor(figure.to.y()) == static_cast<double>(y)) {
    return true;
  }
  constexpr double kGraze = 1e-9;
  double in = 0.0, out = 1.0;
  for (const Eigen::Index axis : {0, 1}) {
    const double along = figure.to[axis] - figure.from[axis];
    const double low = static_cast<double>(axis == 0 ? x : y) + kGraze - figure.from[axis];
    const double high = low + 1.0 - 2.0 * kGraze;
    if (along == 0.0) {
      if (low > 0.0 || high < 0.0) return false;
      continue;
    }
    in = std::max(in, std::min(low / along, high / along));
    out = std::min(out, std::max(low / along, high / along));
  }
  return in < out;
}

void draw_cell(Picture& picture, const Area& cell, State state) {
  if (state == State::kNone) return;
  if (state != State::kMissed) {
    picture.fill(cell.x, cell.y, cell.width, cell.height, state == State::kMarked ? kMarkedCell : kBeyondCell);
    return;
  }
  for (std::ptrdiff_t y = cell.y; y < cell.bottom(); ++y) {
    for (std::ptrdiff_t x = cell.x; x < cell.right(); ++x) {
      if ((x + y) % 8 < 3) picture.set(x, y, kMissedCell);
    }
  }
}

void draw_legend(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y, const std::array<std::size_t, 4>& counts) {
  struct Entry {
    State state;
    std::string_view text;
  };
  for (const auto& [state, text] :
       {Entry{State::kMarked, "crossed and marked"}, Entry{State::kMissed, "crossed, not marked"},
        Entry{State::kBeyond, "marked, not crossed"}}) {
    const Area swatch{x, y, 18, 18};
    draw_cell(picture, swatch, state);
    draw_frame(picture, swatch, 1, kInk);
    draw_label(picture, x + 18 + 8, y + 2, fmt::format("{} {}", counts[static_cast<std::size_t>(state)], text),
               kTextScale, kInk);
    y += 26;
  }
}

}  // namespace

Result<void> RayFigure::validate() const {
  const auto is_near = [](double at) { return std::abs(at) < kMaxCoordinate; };
  if (!is_near(from.x()) || !is_near(from.y()) || !is_near(to.x()) || !is_near(to.y())) {
    return fail(Error::Code::kBadOption, "ray figure: the segment's ends must be numbers below 2^40");
  }
  for (const GridCell& cell : marked) {
    if (!is_near(static_cast<double>(cell.x)) || !is_near(static_cast<double>(cell.y))) {
      return fail(Error::Code::kBadOption, fmt::format("ray figure: cell {}, {} is too far away", cell.x, cell.y));
    }
  }
  const Grid grid = grid_of(*this);
  if (grid.nx > kMaxCells || grid.ny > kMaxCells) {
    return fail(Error::Code::kBadOption,
                fmt::format("ray figure: {} x {} cells, {} along an axis are the most", grid.nx, grid.ny, kMaxCells));
  }
  return {};
}

RayFigure ray_figure(const Eigen::Vector2d& from, const Eigen::Vector2d& to, RayAlgorithm algorithm) {
  using Word = std::uint64_t;
  const Lattice lattice(1.0, kLevelsOf<Word>);
  const Eigen::Vector3d start_m(from.x(), from.y(), 0.5), end_m(to.x(), to.y(), 0.5);
  RayFigure figure{from, to, {}};
  const auto start = lattice.key_of<Word>(start_m), end = lattice.key_of<Word>(end_m);
  if (!start || !end) return figure;
  const auto mark = [&](const BasicKey<Word>& key) {
    constexpr Word kOrigin = Word{1} << (kLevelsOf<Word> - 1);
    figure.marked.push_back({static_cast<std::int64_t>(key.x - kOrigin), static_cast<std::int64_t>(key.y - kOrigin)});
  };
  if (algorithm == RayAlgorithm::kBresenham) {
    for (const BasicKey<Word> key : bresenham(*start, *end)) mark(key);
  } else if (const auto keys = dda<Word>(lattice, start_m, end_m)) {
    for (const BasicKey<Word> key : *keys) mark(key);
  }
  mark(*end);
  return figure;
}

Picture render_ray(const RayFigure& figure, std::size_t target_px) {
  assert(figure.validate());
  assert(target_px >= 64 && target_px <= 3072);
  const Grid grid = grid_of(figure);
  const auto longer = static_cast<std::size_t>(std::max(grid.nx, grid.ny));
  const auto edge = static_cast<std::ptrdiff_t>(std::clamp<std::size_t>(target_px / longer, 4, 64));
  constexpr std::ptrdiff_t kMargin = 24, kLegend = 3 * 26 + 10, kMinWidth = 18 + 8 + 24 * 12;
  const Area area{kMargin, kMargin, grid.nx * edge, grid.ny * edge};
  Picture picture(static_cast<std::size_t>(std::max(area.width, kMinWidth) + 2 * kMargin),
                  static_cast<std::size_t>(area.bottom() + kMargin + kLegend), kPaper);

  const auto count = static_cast<std::size_t>(grid.nx * grid.ny);
  std::vector<State> states(count, State::kNone);
  const auto state_at = [&](std::int64_t x, std::int64_t y) -> State& {
    return states[static_cast<std::size_t>((y - grid.y) * grid.nx + (x - grid.x))];
  };
  for (const GridCell& cell : figure.marked) state_at(cell.x, cell.y) = State::kBeyond;
  for (std::int64_t y = grid.y; y < grid.y + grid.ny; ++y) {
    for (std::int64_t x = grid.x; x < grid.x + grid.nx; ++x) {
      if (!crosses(figure, x, y)) continue;
      State& state = state_at(x, y);
      state = state == State::kBeyond ? State::kMarked : State::kMissed;
    }
  }
  std::array<std::size_t, 4> counts{};
  for (std::int64_t y = 0; y < grid.ny; ++y) {
    for (std::int64_t x = 0; x < grid.nx; ++x) {
      const State state = state_at(grid.x + x, grid.y + y);
      ++counts[static_cast<std::size_t>(state)];
      // y grows upwards.
      const Area cell{area.x + x * edge, area.y + (grid.ny - 1 - y) * edge, edge, edge};
      draw_cell(picture, cell, state);
    }
  }
  for (std::int64_t x = 1; x < grid.nx; ++x) picture.fill(area.x + x * edge, area.y, 1, area.height, kPaleInk);
  for (std::int64_t y = 1; y < grid.ny; ++y) picture.fill(area.x, area.y + y * edge, area.width, 1, kPaleInk);
  draw_frame(picture, area, 2, kInk);

  const auto spot_of = [&](const Eigen::Vector2d& at) {
    const double px = static_cast<double>(edge);
    return Spot{static_cast<double>(area.x) + (at.x() - static_cast<double>(grid.x)) * px,
                static_cast<double>(area.bottom()) - (at.y() - static_cast<double>(grid.y)) * px};
  };
  const Spot from = spot_of(figure.from), to = spot_of(figure.to);
  const double radius = std::clamp(0.22 * static_cast<double>(edge), 3.0, 8.0);
  draw_line(picture, from, to, std::max(0.5 * radius, 1.5), kSegment, area);
  draw_disc(picture, from, radius + 1.5, kPaper);
  draw_disc(picture, from, radius, kSegment);
  draw_marker(picture, Marker::kRing, to, radius + 1.5, kSegment);
  draw_legend(picture, kMargin, area.bottom() + kMargin, counts);
  return picture;
}

}  // namespace pingvox::bench
