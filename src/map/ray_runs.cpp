#include "map/ray_runs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "map/tree_order.hpp"

namespace pingvox::detail {
namespace {

/// Rays of a run at most: there is a bit for each.
constexpr std::size_t kMostOfRun = 32;
/// What single precision may be off, and more [cells].
constexpr double kMargin = 1e-3;
constexpr float kFar = std::numeric_limits<float>::max();
constexpr float kTiny = std::numeric_limits<float>::min();
constexpr std::int16_t kMostSteps = std::numeric_limits<std::int16_t>::max();
/// Bounds of no rays: not in view from anywhere.
constexpr Aim kNoRays{kMostSteps, kMostSteps, kMostSteps, 0, kMostSteps, kMostSteps, kMostSteps, 0};

Aim least_of(const Aim& a, const Aim& b) {
  return a < b ? a : b;
}

constexpr double kBrickEdge = 4.0;
Eigen::Vector3d corner_in_brick(std::uint32_t cell) {
  const BasicKey<std::uint64_t> at = key_of_code(cell);
  return {static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)};
}

}  // namespace

void RayRuns::begin(Lanes lanes, const RayFan& fan, std::uint32_t squares) {
  lanes_ = lanes;
  fan_ = &fan;
  per_edge_ = squares;
  rays_ = 0;
  outside_.clear();
  faces_.fill(kNoRays);
  columns_.assign(std::size_t{kFaces} * squares, {});
  index_.assign(std::size_t{kFaces} * squares * squares, 0);
  squares_.clear();
  runs_.clear();
  square_of_run_.clear();
}

void RayRuns::add(const AimedRays& aimed, std::size_t count) {
  for (std::size_t i = 0; i < count;) {
    const std::uint32_t square = aimed.square[i];
    const auto first = static_cast<std::uint32_t>(rays_ + i);
    if (square == kNoSquare) {
      outside_.push_back(first);
      ++i;
      continue;
    }
    const std::size_t end = std::min(count, i + kMostOfRun);
    Aim bounds = aimed.aim[i];
    for (++i; i < end && aimed.square[i] == square; ++i) bounds = least_of(bounds, aimed.aim[i]);
    add_run(square, {bounds, 0, first, static_cast<std::uint32_t>(rays_ + i) - first});
  }
  rays_ += count;
}

void RayRuns::add_run(std::uint32_t square, const Run& run) {
  std::uint32_t& index = index_[square];
  if (index == 0) {
    squares_.push_back({run.bounds, square, 0, 0});
    index = static_cast<std::uint32_t>(squares_.size());
    Columns& columns = columns_[square / per_edge_];
    columns.first = std::min(columns.first, square % per_edge_);
    columns.last = std::max(columns.last, square % per_edge_);
  }
  runs_.push_back(run);
  square_of_run_.push_back(index - 1);
  Square& all = squares_[index - 1];
  ++all.end;
  all.bounds = least_of(all.bounds, run.bounds);
}

std::size_t RayRuns::border() const {
  std::size_t border = 0;
  for (const Square& square : squares_) {
    const std::uint32_t column = square.number % per_edge_, row = square.number / per_edge_ % per_edge_;
    const auto is_open = [&](bool is_on_face, std::uint32_t neighbour) {
      return is_on_face && index_[neighbour] == 0 ? 1U : 0U;
    };
    border += is_open(column > 0, square.number - 1) + is_open(column + 1 < per_edge_, square.number + 1) +
              is_open(row > 0, square.number - per_edge_) + is_open(row + 1 < per_edge_, square.number + per_edge_);
  }
  return border;
}

void RayRuns::sort() {
  std::uint32_t begin = 0;
  for (Square& square : squares_) {
    Aim& face = faces_[square.number / (per_edge_ * per_edge_)];
    face = least_of(face, square.bounds);
    square.begin = begin;
    begin += std::exchange(square.end, begin);
  }
  sorted_.resize(runs_.size());
  for (std::size_t i = 0; i < runs_.size(); ++i) sorted_[squares_[square_of_run_[i]].end++] = runs_[i];
  runs_.swap(sorted_);
}

void RayRuns::take_one_of_each_square(std::vector<std::uint32_t>& taken) {
  taken.clear();
  for (const Square& square : squares_) {
    const std::span<Run> runs = std::span(runs_).subspan(square.begin, square.end - square.begin);
    Run& run = *std::max_element(runs.begin(), runs.end(), [](const Run& a, const Run& b) {
      return a.bounds[kReach + kNegated] > b.bounds[kReach + kNegated];
    });
    const std::uint32_t middle = run.count / 2;
    run.taken |= 1U << middle;
    taken.push_back(run.first + middle);
  }
}

std::optional<RayRuns::View> RayRuns::view(std::uint32_t face, const Eigen::Vector3d& lowest, double edge) const {
  const int axis = static_cast<int>(face / 2), next = (axis + 1) % 3, after = (axis + 2) % 3;
  const Eigen::Vector3d highest = lowest.array() + edge;
  // A ray never turns back along an axis. That is told exactly: near its start it touches cells that it never enters.
  if (face % 2 == 0 ? highest[axis] <= 0.0 : lowest[axis] >= 0.0) return std::nullopt;
  const double end = (face % 2 == 0 ? highest[axis] : -lowest[axis]) + kMargin;
  const auto far = static_cast<float>(end), near = static_cast<float>(std::max(0.0, end - edge - 2 * kMargin));
  const auto across = static_cast<float>(lowest[next] + 0.5 * edge),
             up = static_cast<float>(lowest[after] + 0.5 * edge);
  const auto half_width = static_cast<float>(0.5 * edge + kMargin);
  if (std::abs(across) - half_width > far || std::abs(up) - half_width > far) return std::nullopt;
  // Aims of rays that are in the cube somewhere from near to far.
  const float in = 1.0F / std::max(near, 5e-4F), out = 1.0F / far;
  const auto least = [&](float low, int a) {
    const float ahead = lowest[a] > 0.0 ? kTiny : (lowest[a] < 0.0 ? -kFar : 0.0F);
    return std::max(ahead, low * (low < 0.0F ? in : out));
  };
  const auto most = [&](float high, int a) {
    return std::min(highest[a] <= 0.0 ? -kTiny : kFar, high * (high < 0.0F ? out : in));
  };
  const float left = least(across - half_width, next), right = most(across + half_width, next);
  const float below = least(up - half_width, after), above = most(up + half_width, after);
  const FourSteps gains = in_steps(FourNumbers{right, above, -left, -below} * kStepsOfGain);
  const FourSteps reach = in_steps(FourNumbers{-near} * kStepsOfReach);
  const auto step = [](std::int32_t number) { return static_cast<std::int16_t>(number); };
  const Aim greatest{step(gains[0]), step(gains[1]), kMostSteps, 0, step(gains[2]), step(gains[3]), step(reach[0]), 0};
  if (is_any_greater(faces_[face], greatest)) return std::nullopt;
  return View{{near, far, across, up, half_width},
              greatest,
              face * per_edge_ + square_along(below, per_edge_),
              face * per_edge_ + square_along(above, per_edge_),
              square_along(left, per_edge_),
              square_along(right, per_edge_)};
}

template <class F>
bool RayRuns::any_square(const View& view, F&& f) const {
  for (std::uint32_t row = view.first_row; row <= view.last_row; ++row) {
    const std::uint32_t last = std::min(view.last_column, columns_[row].last);
    for (std::uint32_t column = std::max(view.first_column, columns_[row].first); column <= last; ++column) {
      const std::uint32_t index = index_[row * per_edge_ + column];
      if (index == 0 || is_any_greater(squares_[index - 1].bounds, view.most)) continue;
      if (f(squares_[index - 1])) return true;
    }
  }
  return false;
}

bool RayRuns::may_cross(std::uint32_t face, const Eigen::Vector3d& lowest, double edge) const {
  const auto cube = view(face, lowest, edge);
  return cube && any_square(*cube, [](const Square&) { return true; });
}

bool RayRuns::may_cross(const Eigen::Vector3d& lowest, double edge) const {
  for (std::uint32_t face = 0; face < kFaces; ++face) {
    if (may_cross(face, lowest, edge)) return true;
  }
  return false;
}

template <class Point>
std::uint64_t RayRuns::take_some_across(const Eigen::Vector3d& lowest, std::uint64_t cells,
                                        std::span<const Point> ends_m, std::vector<std::uint32_t>& taken) {
  // Step by step for all cells, so that what the next step looks at is on its way from memory.
  squares_to_ask_.clear();
  for (std::uint32_t face = 0; face < kFaces; ++face) {
    if (!may_cross(face, lowest, kBrickEdge)) continue;
    for (std::uint64_t left = cells; left != 0; left &= left - 1) {
      const auto number = static_cast<std::uint32_t>(std::countr_zero(left));
      const auto cell = view(face, lowest + corner_in_brick(number), 1.0);
      if (!cell) continue;
      any_square(*cell, [&](const Square& square) {
        squares_to_ask_.push_back({*cell, &square, number});
        __builtin_prefetch(&runs_[square.begin]);
        return false;
      });
    }
  }
  runs_to_ask_.clear();
  for (const SquareToAsk& ask : squares_to_ask_) {
    for (std::uint32_t run = ask.square->begin; run < ask.square->end; ++run) {
      if (is_any_greater(runs_[run].bounds, ask.cell.most)) continue;
      runs_to_ask_.push_back({ask.cell.cube, run, ask.number});
      const auto* const ends = reinterpret_cast<const std::byte*>(&ends_m[runs_[run].first]);
      for (std::size_t line = 0; line < runs_[run].count * sizeof(Point); line += 64) {
        __builtin_prefetch(ends + line);
      }
    }
  }
  for (const RunToAsk& ask : runs_to_ask_) {
    if (((cells >> ask.number) & 1) == 0) continue;  // a ray was found
    Run& run = runs_[ask.run];
    const std::size_t i =
        first_that_may_cross(lanes_, *fan_, ask.cell, ends_m.subspan(run.first), run.count, run.taken);
    if (i == run.count) continue;
    run.taken |= 1U << i;
    taken.push_back(run.first + static_cast<std::uint32_t>(i));
    cells &= ~(std::uint64_t{1} << ask.number);
  }
  return cells;
}
template std::uint64_t RayRuns::take_some_across(const Eigen::Vector3d&, std::uint64_t,
                                                 std::span<const Eigen::Vector3d>, std::vector<std::uint32_t>&);
template std::uint64_t RayRuns::take_some_across(const Eigen::Vector3d&, std::uint64_t,
                                                 std::span<const Eigen::Vector3f>, std::vector<std::uint32_t>&);

}  // namespace pingvox::detail
