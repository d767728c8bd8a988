#include "pingvox/slam/loop_finder.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <unordered_set>

#include "pingvox/geometry/degree.hpp"
#include "slam/loops/point_field.hpp"

namespace pingvox {
namespace {

/// Key frames to either side of a submap's own.
constexpr std::size_t kAround = 4;
constexpr double kCellsOfReach = 100.0;
/// Lower scores are matches of anything with anything; what is wrong above it disagrees with other loops.
constexpr double kMinScore = 0.35;
constexpr std::size_t kMaxPoints = 300, kMinPoints = 30;
/// Where less of what is seen tells the place along a direction, the match says nothing of it: a standard deviation of
/// so many reaches.
constexpr double kMinShare = 0.03, kUnknown = 0.5;
/// Walls are straight over so much.
constexpr double kStraight_cells = 5.0;
/// Neighbours whose spread across is more than this share of that along are no wall.
constexpr double kMaxFlatness = 0.15;
/// Ways back to a place that are tried for each key frame.
constexpr std::size_t kMaxReturns = 8;
/// 99 % of chi square with three degrees of freedom.
constexpr double kConsistent = 11.3;
/// A loop that the odometry would have had to be so wrong for, in squared standard deviations, is of two places that
/// look the same.
constexpr double kPossible2 = 100.0;

/// What is farther from a key frame than this, in reaches, is left out of its submap.
constexpr double kMaxDistance = 2.0;
constexpr std::size_t kMaxLoops = 4000;

/// The points of key frames `k - 4` to `k + 4` in the frame of k, one in each cell.
std::vector<Eigen::Vector2d> submap(std::span<const KeyFrame> frames, std::span<const Pose2> poses, std::size_t k,
                                    double reach_m) {
  const double cell_m = reach_m / kCellsOfReach;
  const Pose2 k_from_map = poses[k].inverse();
  std::vector<Eigen::Vector2d> points_m;
  std::unordered_set<std::uint64_t> taken;
  const std::size_t first = k < kAround ? 0 : k - kAround, last = std::min(k + kAround, frames.size() - 1);
  for (std::size_t i = first; i <= last; ++i) {
    if (frames[i].pass != frames[k].pass) continue;
    const Pose2 k_from_i = k_from_map * poses[i];
    for (const Eigen::Vector2d& point : frames[i].points_m) {
      const Eigen::Vector2d at = k_from_i * point;
      if (!(at.cwiseAbs().maxCoeff() < kMaxDistance * reach_m)) continue;
      const Eigen::Vector2i cell = (at / cell_m).array().floor().cast<int>();
      const auto key =
          (std::uint64_t{static_cast<std::uint32_t>(cell.x())} << 32) | static_cast<std::uint32_t>(cell.y());
      if (taken.insert(key).second) points_m.push_back(at);
    }
  }
  return points_m;
}

Eigen::Vector2d middle_of(const std::vector<Eigen::Vector2d>& points_m) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points_m) sum += point;
  return sum / static_cast<double>(points_m.size());
}

/// Evenly chosen ones.
std::vector<Eigen::Vector2d> thin(const std::vector<Eigen::Vector2d>& points_m) {
  if (points_m.size() <= kMaxPoints) return points_m;
  std::vector<Eigen::Vector2d> some;
  for (std::size_t i = 0; i < kMaxPoints; ++i) some.push_back(points_m[i * points_m.size() / kMaxPoints]);
  return some;
}

/// Those that are not too far from the key frame.
std::vector<Eigen::Vector2d> near_points(const std::vector<Eigen::Vector2d>& points_m, const LoopOptions& options) {
  const double within_m = options.points_within * options.reach_m;
  std::vector<Eigen::Vector2d> near;
  for (const Eigen::Vector2d& point : points_m) {
    if (point.norm() < within_m) near.push_back(point);
  }
  return near;
}

/// The direction along which points of walls tell worst where they are, and how well: the mean square of the walls'
/// normals along it, 0..0.5. Nearly zero in a straight canal, where any place looks like the next one.
struct Weakest {
  Eigen::Vector2d direction;
  double share = 0.0;
};
/// @param near_m  walls are straight within it
Weakest weakest_direction(const std::vector<Eigen::Vector2d>& points_m, double near_m) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  const std::vector<Eigen::Vector2d> some = thin(points_m);
  for (const Eigen::Vector2d& at : some) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
    double count = 0.0;
    for (const Eigen::Vector2d& point : points_m) {
      const Eigen::Vector2d from = point - at;
      if (from.squaredNorm() > near_m * near_m) continue;
      mean += from;
      squares += from * from.transpose();
      count += 1.0;
    }
    if (count < 4.0) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> spread((squares - mean * mean.transpose() / count).eval());
    if (spread.eigenvalues()[0] > kMaxFlatness * spread.eigenvalues()[1]) continue;
    const Eigen::Vector2d normal = spread.eigenvectors().col(0);
    sum += normal * normal.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> normals(sum / static_cast<double>(some.size()));
  return {normals.eigenvectors().col(0), normals.eigenvalues()[0]};
}

/// Length of the way and sum of the turns from the first key frame to each.
struct Way {
  std::vector<double> moved_m, turned_rad;
};
Way way_along(std::span<const KeyFrame> frames) {
  Way way{{0.0}, {0.0}};
  for (std::size_t k = 1; k < frames.size(); ++k) {
    const Pose2 step = frames[k - 1].odometry.inverse() * frames[k].odometry;
    way.moved_m.push_back(way.moved_m.back() + step.place_m.norm());
    way.turned_rad.push_back(way.turned_rad.back() + std::abs(step.yaw_rad));
  }
  return way;
}

/// Earlier key frames to compare a key frame with: of each time that the way came near, the nearest.
std::vector<std::size_t> returns_to(std::size_t k, const std::vector<Eigen::Vector2d>& middles_m,
                                    const std::vector<double>& moved_m, const LoopOptions& options) {
  const double near_m = 0.4 * options.reach_m + options.window_m;
  struct Return {
    std::size_t frame;
    double distance_m;
  };
  std::vector<Return> returns;
  bool is_near = false;
  for (std::size_t j = 0; j + 2 * kAround < k; ++j) {
    const double distance_m = (middles_m[j] - middles_m[k]).norm();
    if (distance_m > near_m) {
      is_near = false;
      continue;
    }
    // A vehicle that stays near for long is compared once each reach of its way.
    if (is_near && moved_m[j] - moved_m[returns.back().frame] > options.reach_m) is_near = false;
    if (!is_near) {
      returns.push_back({j, distance_m});
    } else if (distance_m < returns.back().distance_m) {
      returns.back() = {j, distance_m};
    }
    is_near = true;
  }
  std::ranges::sort(returns, {}, [](const Return& r) { return std::pair(r.distance_m, r.frame); });
  if (returns.size() > kMaxReturns) returns.resize(kMaxReturns);
  std::vector<std::size_t> chosen;
  for (const Return& r : returns) chosen.push_back(r.frame);
  return chosen;
}

/// Squared standard deviations of the odometry between two key frames: x, y [m], yaw [rad].
Eigen::Vector3d odometry_variance(std::size_t i, std::size_t j, std::span<const KeyFrame> frames, const Way& way,
                                  double reach_m) {
  Eigen::Vector3d deviation = odometry_deviation(std::abs(way.moved_m[i] - way.moved_m[j]),
                                                 std::abs(way.turned_rad[i] - way.turned_rad[j]), reach_m);
  // An error of the yaw moves what is far away.
  deviation.head<2>().array() +=
      0.5 * deviation[2] * (frames[i].odometry.inverse() * frames[j].odometry).place_m.norm();
  return deviation.cwiseAbs2();
}

/// A recognised place, and the covariance of its pose in the frame of a.
struct Loop {
  PoseEdge edge;
  Eigen::Matrix3d covariance;
};

/// Squared length of a small pose in standard deviations.
double squared_length(const Pose2& pose, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d at(pose.place_m.x(), pose.place_m.y(), pose.yaw_rad);
  return at.dot(covariance.llt().solve(at));
}

/// Squared distance, in standard deviations, of going along a loop, the odometry, the other loop, and back.
double disagreement2(const Loop& one, const Loop& other, std::span<const KeyFrame> frames, const Way& way,
                     double reach_m) {
  const std::size_t a = one.edge.a, b = one.edge.b, c = other.edge.a, d = other.edge.b;
  const Pose2 a_to_c = frames[a].odometry.inverse() * frames[c].odometry;
  const Pose2 d_to_b = frames[d].odometry.inverse() * frames[b].odometry;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = rotation2(a_to_c.yaw_rad);
  Eigen::Matrix3d covariance = one.covariance + turn * other.covariance * turn.transpose();
  covariance.diagonal() +=
      odometry_variance(a, c, frames, way, reach_m) + odometry_variance(b, d, frames, way, reach_m);
  return squared_length(a_to_c * other.edge.a_from_b * d_to_b * one.edge.a_from_b.inverse(), covariance);
}

/// Whether the odometry, although much worse than it is taken to be, may have led around the loop.
bool is_possible(const Loop& loop, std::span<const KeyFrame> frames, const Way& way, double reach_m) {
  const auto& [a, b, a_from_b, information] = loop.edge;
  Eigen::Matrix3d covariance = loop.covariance;
  covariance.diagonal() += odometry_variance(a, b, frames, way, reach_m);
  return squared_length(a_from_b * (frames[b].odometry.inverse() * frames[a].odometry), covariance) < kPossible2;
}

/// A set of loops of which each two agree: begins with the one that most agree with.
std::vector<std::size_t> consistent_loops(std::span<const Loop> loops, std::span<const KeyFrame> frames, const Way& way,
                                          double reach_m) {
  const std::size_t count = loops.size();
  std::vector<std::uint8_t> agree(count * count, 0);
  std::vector<std::size_t> degree(count, 0), supported(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (disagreement2(loops[i], loops[j], frames, way, reach_m) > kConsistent) continue;
      agree[i * count + j] = agree[j * count + i] = 1;
      ++degree[i];
      ++degree[j];
      const double apart_m = std::abs(way.moved_m[loops[i].edge.a] - way.moved_m[loops[j].edge.a]) +
                             std::abs(way.moved_m[loops[i].edge.b] - way.moved_m[loops[j].edge.b]);
      if (apart_m < 2.0 * reach_m) {
        ++supported[i];
        ++supported[j];
      }
    }
  }
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < count; ++i) {
    if (supported[i] > 0) order.push_back(i);
  }
  std::ranges::sort(order,
                    [&](std::size_t a, std::size_t b) { return std::pair(degree[b], a) < std::pair(degree[a], b); });
  std::vector<std::size_t> set;
  for (const std::size_t i : order) {
    if (std::ranges::all_of(set, [&](std::size_t j) { return agree[i * count + j] != 0; })) set.push_back(i);
  }
  return set;
}

}  // namespace

Result<void> LoopOptions::validate() const {
  constexpr double kMaxWindow = 10.0;
  std::string broken;
  const auto check = [&](bool holds, const char* what) {
    if (!holds) broken += (broken.empty() ? "" : ", ") + std::string(what);
  };
  check(reach_m > 0.0 && std::isfinite(reach_m), "reach_m: must be finite and above 0");
  check(window_m >= 0.0 && window_m <= kMaxWindow * reach_m, "window_m: must be 0 to 10 reaches");
  check(window_yaw_rad >= 0.0 && window_yaw_rad <= std::numbers::pi, "window_yaw_rad: must be 0 to pi");
  check(points_within > 0.0, "points_within: must be above 0");
  if (!broken.empty()) return fail(Error::Code::kBadOption, broken);
  return {};
}

Eigen::Vector3d odometry_deviation(double moved_m, double turned_rad, double reach_m) {
  // Random, a tenth of a metre after one metre for a sensor of 50 m, and 2 % that go on; yaws 0.5 degrees in a metre.
  const double random_m = 0.014 * std::sqrt(reach_m * moved_m) + 0.02 * moved_m;
  const double yaw_rad = kDegree_rad * (0.5 * std::sqrt(50.0 * moved_m / reach_m) + 0.1) + 0.02 * turned_rad;
  return {random_m + 1e-3 * reach_m, random_m + 1e-3 * reach_m, yaw_rad};
}

Loops find_loops(std::span<const KeyFrame> frames, std::span<const Pose2> poses, const LoopOptions& options) {
  assert(frames.size() == poses.size() && options.validate());
  const double cell_m = options.reach_m / kCellsOfReach;
  const Way way = way_along(frames);
  std::vector<std::vector<Eigen::Vector2d>> points_m(frames.size());
  std::vector<Eigen::Vector2d> middles_m(frames.size(),
                                         Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()));
  for (std::size_t k = 0; k < frames.size(); ++k) {
    points_m[k] = submap(frames, poses, k, options.reach_m);
    if (points_m[k].size() < kMinPoints) continue;
    middles_m[k] = poses[k] * middle_of(points_m[k]);
  }
  const MatchWindow window{static_cast<int>(std::lround(options.window_m / cell_m)), options.window_yaw_rad};
  Loops loops;
  std::vector<Loop> all;
  for (std::size_t k = options.first; k < frames.size(); k += 2) {
    if (!middles_m[k].allFinite()) continue;
    const std::vector<std::size_t> returns = returns_to(k, middles_m, way.moved_m, options);
    if (returns.empty()) continue;
    const PointField field(points_m[k], cell_m, window.cells);
    for (const std::size_t j : returns) {
      const std::vector<Eigen::Vector2d> points = thin(near_points(points_m[j], options));
      if (points.size() < kMinPoints) continue;
      const auto match = field.match(points, poses[k].inverse() * poses[j], window, kMinScore);
      if (!match) continue;
      // Both see what the other sees.
      const PointField other(points_m[j], cell_m, 0);
      const std::vector<Eigen::Vector2d> mine = thin(near_points(points_m[k], options));
      if (mine.size() < kMinPoints) continue;
      if (other.score(mine, match->pose.inverse()) < kMinScore) continue;
      Loop loop{{k, j, match->pose, {}}, match->covariance};
      if (const auto [along, share] = weakest_direction(points_m[j], kStraight_cells * cell_m); share < kMinShare) {
        const Eigen::Vector2d free = kUnknown * options.reach_m * (rotation2(match->pose.yaw_rad) * along);
        loop.covariance.topLeftCorner<2, 2>() += free * free.transpose();
      }
      loop.edge.information = loop.covariance.inverse();
      if (is_possible(loop, frames, way, options.reach_m)) all.push_back(loop);
    }
  }
  loops.found = all.size();
  if (all.size() > kMaxLoops) {
    for (std::size_t i = 0; i < kMaxLoops; ++i) all[i] = all[i * all.size() / kMaxLoops];
    all.resize(kMaxLoops);
  }
  for (const std::size_t i : consistent_loops(all, frames, way, options.reach_m)) loops.kept.push_back(all[i].edge);
  return loops;
}

}  // namespace pingvox
