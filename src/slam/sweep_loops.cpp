#include "slam/sweep_loops.hpp"

#include <array>
#include <numbers>
#include <span>
#include <utility>

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
constexpr double kWindow_rad = 10.0 * std::numbers::pi / 180.0;
/// See LoopOptions: canals go on beyond what the sonar hears.
constexpr double kPointsWithin = 0.8;
/// Gauss-Newton steps after each search.
constexpr int kSteps = 4;

std::vector<Pose2> knot_poses(const SlamSolver& solver) {
  std::vector<Pose2> poses;
  for (std::size_t k = 0; k < solver.problem().knots(); ++k) poses.push_back(solver.pose_of_knot(k));
  return poses;
}

/// @param reckoned  the poses of the knots by dead reckoning, which loops must not contradict
SweepLoops find_loops(const SlamSolver& solver, std::span<const Pose2> reckoned, const LoopOptions& options) {
  const std::vector<EchoOnGround> ground = solver.ground();
  std::vector<KeyFrame> frames;
  std::vector<Pose2> poses;
  std::vector<std::size_t> knots;
  for (std::size_t s = 0; s + 1 < solver.sweeps().size(); ++s) {
    const std::size_t first = solver.sweeps()[s], end = solver.sweeps()[s + 1];
    if (first == end) continue;
    // The knot nearest to the middle of the sweep.
    const auto [before, share] = solver.sweep_middles()[s];
    const std::size_t knot = share < 0.5 ? before : before + 1;
    const Pose2 pose = solver.pose_of_knot(knot), knot_from_map = pose.inverse();
    KeyFrame frame{reckoned[knot], {}};
    for (std::size_t i = first; i < end; ++i) frame.points_m.push_back(knot_from_map * ground[i].at);
    frames.push_back(std::move(frame));
    poses.push_back(pose);
    knots.push_back(knot);
  }
  Loops loops = find_loops(frames, poses, options);
  for (PoseEdge& edge : loops.kept) {
    edge.a = knots[edge.a];
    edge.b = knots[edge.b];
  }
  return {loops.found, std::move(loops.kept)};
}

}  // namespace

std::optional<SweepLoops> close_sweep_loops(SlamSolver& solver) {
  const double reach_m = solver.reach_m();
  SweepLoops loops;
  if (!(reach_m > 0.0)) return loops;
  const std::vector<Pose2> reckoned = knot_poses(solver);
  for (const auto& [share, searches] : kWindows) {
    const LoopOptions options{reach_m, share * reach_m, kWindow_rad, kPointsWithin};
    for (std::size_t i = 0, before = 0; i < searches; ++i) {
      loops = find_loops(solver, reckoned, options);
      // Those that are found no longer lead nowhere: then back to dead reckoning.
      if (loops.kept.empty() && solver.loops().empty()) break;
      solver.set_loops(loops.kept);
      for (int step = 0; step < kSteps; ++step) {
        if (!solver.step(std::nullopt)) return std::nullopt;
      }
      if (loops.kept.size() <= before) break;
      before = loops.kept.size();
    }
    // What is not found in the largest window is in none.
    if (loops.kept.empty()) break;
  }
  solver.set_loops({});
  return loops;
}

}  // namespace pingvox
