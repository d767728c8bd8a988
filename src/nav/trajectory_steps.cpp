#include "nav/internal/trajectory_steps.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "nav/internal/frame_tracker.hpp"
#include "nav/source_steps.hpp"

namespace pingvox {
namespace {

SamplePose sample_of(const StampedPose& pose) {
  return {pose.time_s, pose.map_from_body.translation(), Eigen::Quaterniond(pose.map_from_body.linear())};
}

/// Poses [begin, end) without a step between them.
struct Piece {
  std::size_t begin = 0, end = 0, frame = 0;
};

std::vector<Piece> pieces_of(const std::vector<StampedPose>& poses) {
  FrameTracker tracker;
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::size_t frame = tracker.add(sample_of(poses[i]));
    if (pieces.empty() || pieces.back().frame != frame) pieces.push_back({i, i, frame});
    pieces.back().end = i + 1;
  }
  return pieces;
}

}  // namespace

CutTrajectory cut_at_steps(const Trajectory& trajectory) {
  const std::vector<StampedPose>& poses = trajectory.poses();
  const std::vector<Piece> pieces = pieces_of(poses);
  if (pieces.size() == 1) return {trajectory, {}};
  const auto size_of = [](const Piece& piece) { return piece.end - piece.begin; };
  const std::size_t largest = size_of(std::ranges::max(pieces, {}, size_of));
  const auto is_kept = [&](const Piece& piece) {
    const double seconds = poses[piece.end - 1].time_s - poses[piece.begin].time_s;
    return size_of(piece) == largest || is_lasting(size_of(piece), seconds);
  };
  CutTrajectory cut{trajectory, {}};
  // The step to a pose, and the poses [begin, end) that are left out with it.
  const auto note = [&](std::size_t to, std::size_t begin, std::size_t end) {
    SourceStep step = source_step(PoseStep::between(sample_of(poses[to - 1]), sample_of(poses[to])), false);
    step.left_out = end - begin;
    if (end > begin) {
      step.left_from_s = poses[begin].time_s;
      step.left_to_s = poses[end - 1].time_s;
    }
    cut.steps.push_back(step);
  };
  std::vector<StampedPose> kept;
  std::vector<std::size_t> cuts;
  std::optional<Piece> before;  // the last one that is kept
  for (const Piece& piece : pieces) {
    if (!is_kept(piece)) continue;
    const std::size_t left_from = before ? before->end : 0;
    if (before) {
      note(left_from, left_from, piece.begin);
      if (piece.frame != before->frame) cuts.push_back(kept.size());
    } else if (piece.begin > 0) {
      note(piece.begin, 0, piece.begin);
    }
    kept.insert(kept.end(), poses.begin() + static_cast<std::ptrdiff_t>(piece.begin),
                poses.begin() + static_cast<std::ptrdiff_t>(piece.end));
    before = piece;
  }
  if (before->end < poses.size()) note(before->end, before->end, poses.size());
  cut.trajectory = *Trajectory::make(std::move(kept), trajectory.longest_step_s(), std::move(cuts));
  return cut;
}

Trajectory join_at_cuts(const Trajectory& trajectory) {
  if (trajectory.cuts().empty()) return trajectory;
  std::vector<StampedPose> poses = trajectory.poses();
  Pose before_from_after = Pose::Identity();
  auto cut = trajectory.cuts().begin();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Pose& pose = poses[i].map_from_body;
    if (cut != trajectory.cuts().end() && *cut == i) {
      before_from_after = poses[i - 1].map_from_body * pose.inverse();
      ++cut;
    }
    pose = before_from_after * pose;
  }
  return *Trajectory::make(std::move(poses), trajectory.longest_step_s());
}

}  // namespace pingvox
