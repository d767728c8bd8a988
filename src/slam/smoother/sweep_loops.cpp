#include "slam/smoother/sweep_loops.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "base/median.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/slam/loop_finder.hpp"

namespace pingvox {
namespace {

/// Half of a window of the search as a share of the sonar's reach, and how often it is searched at most: as long as
/// each time brings more loops.
struct Window {
  double share;
  std::size_t searches;
};
constexpr std::array<Window, 2> kWindows = {{{0.6, 3}, {0.2, 1}}};
constexpr double kWindow_rad = 10.0 * kDegree_rad;
/// See LoopOptions: canals go on beyond what the sonar hears.
constexpr double kPointsWithin = 0.8;
/// Gauss-Newton steps after each search.
constexpr int kSteps = 4;

/// On board: so many of the newest sweeps are compared with earlier ones; of those that left the problem with all that
/// are within so many reaches. Sweeps without echoes do not end a pass.
constexpr std::size_t kNewest = 16, kMaxSilent = 4;
constexpr double kNearby = 1.2;
/// Pairs of echoes lead back from here.
constexpr double kReachOfPairs_m = 1.5;

std::vector<Pose2> knot_poses(const SlamSolver& solver) {
  std::vector<Pose2> poses;
  for (std::size_t k = 0; k < solver.problem().knots(); ++k) poses.push_back(solver.pose_of_knot(k));
  return poses;
}

/// Sweeps as key frames: those that left the problem, then those with knots.
struct SweepFrames {
  std::vector<KeyFrame> frames;
  std::vector<Pose2> poses;
  std::vector<std::size_t> knots;  ///< of the last ones

  std::size_t fixed() const { return frames.size() - knots.size(); }
  void add(const Pose2& pose, const Pose2& reckoned, std::span<const Eigen::Vector2d> ground_m, std::size_t pass) {
    const Pose2 frame_from_map = pose.inverse();
    KeyFrame frame{reckoned, {}, pass};
    for (const Eigen::Vector2d& at : ground_m) frame.points_m.push_back(frame_from_map * at);
    frames.push_back(std::move(frame));
    poses.push_back(pose);
  }
};

/// @param reckoned  the poses of the knots by dead reckoning, which loops must not contradict
void add_sweeps(const SlamSolver& solver, std::span<const Pose2> reckoned, std::size_t pass, SweepFrames& frames) {
  std::vector<Eigen::Vector2d> ground_m;
  for (const EchoOnGround& echo : solver.ground()) ground_m.push_back(echo.at);
  const std::size_t fixed = solver.sweeps().size() - 1 - solver.sweep_middles().size();
  for (std::size_t s = 0; s < solver.sweep_middles().size(); ++s) {
    const std::size_t first = solver.sweeps()[fixed + s], end = solver.sweeps()[fixed + s + 1];
    if (first == end) continue;
    // The knot nearest to the middle of the sweep.
    const auto [before, share] = solver.sweep_middles()[s];
    const std::size_t knot = share < 0.5 ? before : before + 1;
    frames.add(solver.pose_of_knot(knot), reckoned[knot], std::span(ground_m).subspan(first, end - first), pass);
    frames.knots.push_back(knot);
  }
}

/// Sweeps that left the problem, near a place, pass by pass.
void add_fixed_sweeps(const SlamSolver& solver, const Eigen::Vector2d& place_m, SweepFrames& frames) {
  if (solver.before().fixed == nullptr) return;
  std::size_t last = 0;
  for (const auto& sweep : solver.before().fixed->near(place_m, kNearby * solver.reach_m())) {
    if (sweep->echoes.empty()) continue;
    const bool goes_on = !frames.frames.empty() && sweep->place.number <= last + kMaxSilent;
    const std::size_t pass = frames.frames.empty() ? 0 : frames.frames.back().pass + (goes_on ? 0 : 1);
    last = sweep->place.number;
    const Pose2& pose = *sweep->echoes[sweep->echoes.size() / 2].fixed;
    frames.add(pose, pose, solver.ground_of(*sweep), pass);
  }
}

}  // namespace

std::optional<SweepLoops> close_sweep_loops(SlamSolver& solver) {
  const double reach_m = solver.reach_m();
  SweepLoops closed;
  if (!(reach_m > 0.0)) return closed;
  const std::vector<Pose2> reckoned = knot_poses(solver);
  for (const auto& [share, searches] : kWindows) {
    const LoopOptions options{reach_m, share * reach_m, kWindow_rad, kPointsWithin};
    for (std::size_t i = 0, before = 0; i < searches; ++i) {
      SweepFrames frames;
      add_sweeps(solver, reckoned, 0, frames);
      Loops loops = find_loops(frames.frames, frames.poses, options);
      for (PoseEdge& edge : loops.kept) {
        edge.a = frames.knots[edge.a];
        edge.b = frames.knots[edge.b];
      }
      closed = {loops.found, loops.kept.size()};
      // Those that are found no longer lead nowhere: then back to dead reckoning.
      if (loops.kept.empty() && solver.loops().empty()) break;
      solver.set_loops(std::move(loops.kept));
      for (int step = 0; step < kSteps; ++step) {
        if (!solver.step(std::nullopt)) return std::nullopt;
      }
      if (closed.kept <= before) break;
      before = closed.kept;
    }
    // What is not found in the largest window is in none.
    if (closed.kept == 0) break;
  }
  solver.set_loops({});
  return closed;
}

std::optional<SweepLoops> close_new_loops(SlamSolver& solver) {
  const double reach_m = solver.reach_m();
  if (!(reach_m > 0.0)) return SweepLoops();
  const std::vector<Pose2> poses = knot_poses(solver);
  SweepFrames frames;
  add_fixed_sweeps(solver, poses.back().place_m, frames);
  add_sweeps(solver, poses, frames.frames.empty() ? 0 : frames.frames.back().pass + 1, frames);
  const LoopOptions options{reach_m, kWindows.front().share * reach_m, kWindow_rad, kPointsWithin,
                            frames.frames.size() - std::min(kNewest, frames.knots.size())};
  const Loops loops = find_loops(frames.frames, frames.poses, options);
  if (loops.kept.empty()) return SweepLoops();
  std::vector<PoseEdge> of_knots;
  std::vector<FixedLoop> of_held;
  std::vector<double> distances_m;
  for (PoseEdge edge : loops.kept) {
    const Pose2 &a = frames.poses[edge.a], &b = frames.poses[edge.b];
    distances_m.push_back(residual_of(edge, a, b).head<2>().norm());
    edge.a = frames.knots[edge.a - frames.fixed()];
    if (edge.b < frames.fixed()) {
      of_held.push_back({edge, b});
    } else {
      edge.b = frames.knots[edge.b - frames.fixed()];
      of_knots.push_back(edge);
    }
  }
  if (median(std::move(distances_m)) < kReachOfPairs_m) return SweepLoops();
  solver.set_loops(std::move(of_knots), std::move(of_held));
  for (int step = 0; step < kSteps; ++step) {
    if (!solver.step(std::nullopt)) return std::nullopt;
  }
  return SweepLoops{loops.found, loops.kept.size()};
}

}  // namespace pingvox
