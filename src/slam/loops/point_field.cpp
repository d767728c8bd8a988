#include "slam/loops/point_field.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <tuple>
#include <utility>

#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

constexpr int kLevels = 6;
constexpr double kSigma_cells = 2.0;
constexpr int kReach_cells = 6;  ///< three sigma: farther away the field is zero
constexpr double kYawStep_rad = 2.0 * kDegree_rad;
/// Two poses nearer than this, in cells and in steps of yaw, are of one peak.
constexpr int kPeak_cells = 6, kPeakSteps = 3;
/// A second peak this high, as a share of the first, makes a match ambiguous.
constexpr double kRivalShare = 0.92;
/// A pose whose score is so much lower than the peak's is one standard deviation away.
constexpr double kScoreDeviation = 0.03;

/// Maxima over windows of twice the size: of each cell with those `step` farther to the right and up. At the end of a
/// row it also takes cells of the next one, which only makes a bound looser.
std::vector<std::uint8_t> widen(const std::vector<std::uint8_t>& field, std::size_t width, std::size_t step) {
  std::vector<std::uint8_t> wide = field;
  for (const std::size_t offset : {step, step * width}) {
    const std::size_t count = wide.size() - std::min(offset, wide.size());
    for (std::size_t i = 0; i < count; ++i) wide[i] = std::max(wide[i], wide[i + offset]);
  }
  return wide;
}

}  // namespace

PointField::PointField(std::span<const Eigen::Vector2d> points_m, double cell_m, int margin_cells) : cell_m_(cell_m) {
  assert(!points_m.empty() && cell_m > 0.0);
  Eigen::Vector2d low = points_m.front(), high = points_m.front();
  for (const Eigen::Vector2d& point : points_m) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  // A block of the coarsest level may begin that far below the first cell.
  const double margin_m = (margin_cells + (1 << (kLevels - 1)) + kReach_cells) * cell_m;
  origin_m_ = low.array() - margin_m;
  const Eigen::Vector2d cells = (high.array() + margin_m - origin_m_.array()) / cell_m;
  width_ = static_cast<int>(std::ceil(cells.x())) + 1;
  height_ = static_cast<int>(std::ceil(cells.y())) + 1;
  levels_.assign(1, std::vector<std::uint8_t>(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)));
  constexpr int kSide = 2 * kReach_cells + 1;
  std::array<std::uint8_t, std::size_t{kSide} * kSide> kernel;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double squared = std::pow(x - kReach_cells, 2) + std::pow(y - kReach_cells, 2);
      kernel[static_cast<std::size_t>(y * kSide + x)] =
          static_cast<std::uint8_t>(std::lround(255.0 * std::exp(-squared / (2.0 * kSigma_cells * kSigma_cells))));
    }
  }
  for (const Eigen::Vector2d& point : points_m) {
    const Eigen::Vector2i cell = ((point - origin_m_) / cell_m).array().floor().cast<int>();
    for (int y = 0; y < kSide; ++y) {
      std::uint8_t* row = levels_[0].data() + static_cast<std::ptrdiff_t>(cell.y() + y - kReach_cells) * width_ +
                          cell.x() - kReach_cells;
      for (int x = 0; x < kSide; ++x) row[x] = std::max(row[x], kernel[static_cast<std::size_t>(y * kSide + x)]);
    }
  }
  if (margin_cells == 0) return;
  for (int level = 1; level < kLevels; ++level) {
    levels_.push_back(widen(levels_.back(), static_cast<std::size_t>(width_), std::size_t{1} << (level - 1)));
  }
}

double PointField::score(std::span<const Eigen::Vector2d> points_m, const Pose2& pose) const {
  const Eigen::Matrix2d turn = rotation2(pose.yaw_rad);
  double sum = 0.0;
  for (const Eigen::Vector2d& point : points_m) {
    // Linear between the middles of cells.
    const Eigen::Vector2d at = (turn * point + pose.place_m - origin_m_) / cell_m_ - Eigen::Vector2d(0.5, 0.5);
    if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < width_ - 1 && at.y() < height_ - 1)) continue;
    const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
    const double right = at.x() - x, up = at.y() - y;
    const std::uint8_t* cell = levels_[0].data() + static_cast<std::ptrdiff_t>(y) * width_ + x;
    sum += (1.0 - up) * ((1.0 - right) * cell[0] + right * cell[1]) +
           up * ((1.0 - right) * cell[width_] + right * cell[width_ + 1]);
  }
  return sum / (255.0 * static_cast<double>(points_m.size()));
}

int PointField::sum_at(std::span<const Eigen::Vector2i> cells, int level, int x, int y) const {
  const std::vector<std::uint8_t>& field = levels_[static_cast<std::size_t>(level)];
  const auto width = static_cast<unsigned>(width_), height = static_cast<unsigned>(height_);
  int sum = 0;
  for (const Eigen::Vector2i& cell : cells) {
    // What is negative is a large number.
    const auto column = static_cast<unsigned>(cell.x() + x), row = static_cast<unsigned>(cell.y() + y);
    if (column < width && row < height) sum += field[std::size_t{row} * width + column];
  }
  return sum;
}

std::optional<PointField::Candidate> PointField::search(const std::vector<std::vector<Eigen::Vector2i>>& turned,
                                                        int half_width_cells, int min_sum,
                                                        const std::optional<Candidate>& other) const {
  std::optional<Candidate> best;
  int highest = min_sum;
  const auto is_of_same_peak = [&](const Candidate& c) {
    return other && std::abs(c.x - other->x) <= kPeak_cells && std::abs(c.y - other->y) <= kPeak_cells &&
           std::abs(c.yaw - other->yaw) <= kPeakSteps;
  };
  // Depth first, the most promising block first.
  struct Block {
    Candidate candidate;
    int level;
  };
  std::vector<Block> open;
  constexpr int kTop = kLevels - 1, kTopSize = 1 << kTop;
  for (std::size_t yaw = 0; yaw < turned.size(); ++yaw) {
    for (int y = -half_width_cells; y <= half_width_cells; y += kTopSize) {
      for (int x = -half_width_cells; x <= half_width_cells; x += kTopSize) {
        open.push_back({{static_cast<int>(yaw), x, y, sum_at(turned[yaw], kTop, x, y)}, kTop});
      }
    }
  }
  const auto sum_of = [](const Block& block) {
    const Candidate& c = block.candidate;
    return std::tuple(c.sum, c.yaw, c.y, c.x);
  };
  std::ranges::sort(open, {}, sum_of);
  while (!open.empty()) {
    const Block block = open.back();
    open.pop_back();
    if (block.candidate.sum <= highest) continue;
    if (block.level == 0) {
      if (is_of_same_peak(block.candidate)) continue;
      highest = block.candidate.sum;
      best = block.candidate;
      continue;
    }
    const int level = block.level - 1, size = 1 << level;
    const auto parts = static_cast<std::ptrdiff_t>(open.size());
    for (const auto& [right, up] : {std::pair(0, 0), std::pair(size, 0), std::pair(0, size), std::pair(size, size)}) {
      Candidate part = block.candidate;
      part.x += right;
      part.y += up;
      if (part.x > half_width_cells || part.y > half_width_cells) continue;
      part.sum = sum_at(turned[static_cast<std::size_t>(part.yaw)], level, part.x, part.y);
      if (part.sum > highest) open.push_back({part, level});
    }
    std::ranges::sort(open.begin() + parts, open.end(), {}, sum_of);
  }
  return best;
}

std::optional<FieldMatch> PointField::match(std::span<const Eigen::Vector2d> points_m, const Pose2& expected,
                                            const MatchWindow& window, double min_score) const {
  assert(!points_m.empty());
  // About their middle, so that turning them does not move them.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points_m) middle += point;
  middle /= static_cast<double>(points_m.size());
  const Eigen::Vector2d expected_middle = expected * middle;
  const int steps = static_cast<int>(std::floor(window.yaw_rad / kYawStep_rad + 1e-9));
  const auto pose_of = [&](double yaw_steps, double x_cells, double y_cells) {
    const double yaw = expected.yaw_rad + yaw_steps * kYawStep_rad;
    return Pose2{expected_middle + cell_m_ * Eigen::Vector2d(x_cells, y_cells) - rotation2(yaw) * middle, yaw};
  };
  std::vector<std::vector<Eigen::Vector2i>> turned;
  for (int step = -steps; step <= steps; ++step) {
    const Pose2 pose = pose_of(step, 0.0, 0.0);
    const Eigen::Matrix2d turn = rotation2(pose.yaw_rad);
    std::vector<Eigen::Vector2i>& cells = turned.emplace_back();
    cells.reserve(points_m.size());
    for (const Eigen::Vector2d& point : points_m) {
      cells.emplace_back(((turn * point + pose.place_m - origin_m_) / cell_m_).array().floor().cast<int>());
    }
  }
  const int whole = 255 * static_cast<int>(points_m.size());
  const auto best = search(turned, window.cells, static_cast<int>(min_score * whole), std::nullopt);
  if (!best) return std::nullopt;
  if (search(turned, window.cells, static_cast<int>(kRivalShare * best->sum), best)) return std::nullopt;

  // Between the steps.
  Eigen::Vector3d at(best->yaw - steps, best->x, best->y);
  const auto score_at = [&](const Eigen::Vector3d& a) { return score(points_m, pose_of(a[0], a[1], a[2])); };
  double highest = score_at(at);
  for (double step = 0.5; step > 0.05; step /= 2.0) {
    for (bool is_moved = true; is_moved;) {
      is_moved = false;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
          Eigen::Vector3d next = at;
          next[axis] += sign * step;
          const double here = score_at(next);
          if (here <= highest + 1e-9) continue;
          highest = here;
          at = next;
          is_moved = true;
        }
      }
    }
  }
  const Pose2 pose = pose_of(at[0], at[1], at[2]);
  return FieldMatch{pose, highest, covariance_at(points_m, pose, highest)};
}

Eigen::Matrix3d PointField::covariance_at(std::span<const Eigen::Vector2d> points_m, const Pose2& pose,
                                          double score) const {
  // Spread of the poses around the peak, weighted by how little lower their scores are; not less than a cell and a
  // degree, since neighbouring submaps share points and their errors.
  constexpr int kSteps = 4;
  const double yaw_step_rad = kYawStep_rad / 2.0;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double weights = 0.0;
  for (int yaw = -kSteps; yaw <= kSteps; ++yaw) {
    for (int y = -kSteps; y <= kSteps; ++y) {
      for (int x = -kSteps; x <= kSteps; ++x) {
        const Eigen::Vector3d offset(x * cell_m_, y * cell_m_, yaw * yaw_step_rad);
        const double lower = score - this->score(points_m, {pose.place_m + offset.head<2>(), pose.yaw_rad + offset[2]});
        const double weight = std::exp(-std::max(0.0, lower) / kScoreDeviation);
        sum += weight * offset * offset.transpose();
        weights += weight;
      }
    }
  }
  const Eigen::Vector3d smallest(cell_m_, cell_m_, yaw_step_rad);
  return sum / weights + Eigen::Matrix3d(smallest.cwiseAbs2().asDiagonal());
}

}  // namespace pingvox
