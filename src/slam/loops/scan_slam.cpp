#include "pingvox/slam/scan_slam.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "base/without_exceptions.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/slam/loop_finder.hpp"
#include "slam/sweeps/reach.hpp"

namespace pingvox {
namespace {

/// A key frame after so much way, as a share of the reach, or turn.
constexpr double kStep = 0.04, kTurn_rad = 20.0 * kDegree_rad;
/// Half of the window of the search: share of the reach, and yaw. A window is used until it brings few new loops.
constexpr std::array kSearchWindows = {std::pair(0.8, 24.0 * kDegree_rad), std::pair(0.3, 14.0 * kDegree_rad),
                                       std::pair(0.12, 6.0 * kDegree_rad)};
constexpr std::size_t kRoundsOfWindow = 4;
constexpr double kFewNew = 0.05;

struct LevelScan {
  Pose pose;
  std::size_t number = 0;
  std::vector<Eigen::Vector2d> points_m;  ///< around the sensor, turned by its yaw only

  Pose2 odometry() const { return pose2_of(pose); }
};

/// Key frames, the number of the first scan of each, and for each scan its key frame.
struct Frames {
  std::vector<KeyFrame> frames;
  std::vector<std::size_t> numbers;
  std::vector<std::size_t> of_scan;
};

Frames key_frames(const std::vector<LevelScan>& scans, double reach_m) {
  Frames result;
  for (const LevelScan& scan : scans) {
    const Pose2 odometry = scan.odometry();
    if (!result.frames.empty()) {
      const Pose2 step = result.frames.back().odometry.inverse() * odometry;
      if (step.place_m.norm() < kStep * reach_m && std::abs(step.yaw_rad) < kTurn_rad) {
        for (const Eigen::Vector2d& point : scan.points_m) result.frames.back().points_m.push_back(step * point);
        result.of_scan.push_back(result.frames.size() - 1);
        continue;
      }
    }
    result.frames.push_back({odometry, scan.points_m});
    result.numbers.push_back(scan.number);
    result.of_scan.push_back(result.frames.size() - 1);
  }
  return result;
}

double reach_of_scans(const std::vector<LevelScan>& scans) {
  std::vector<double> ranges_m;
  for (const LevelScan& scan : scans) {
    for (const Eigen::Vector2d& point : scan.points_m) ranges_m.push_back(point.norm());
  }
  return pingvox::reach_of(std::move(ranges_m));
}

std::vector<PoseEdge> odometry_edges(const std::vector<KeyFrame>& frames, double reach_m) {
  std::vector<PoseEdge> edges;
  for (std::size_t k = 0; k + 1 < frames.size(); ++k) {
    const Pose2 step = frames[k].odometry.inverse() * frames[k + 1].odometry;
    const Eigen::Vector3d deviation = odometry_deviation(step.place_m.norm(), std::abs(step.yaw_rad), reach_m);
    edges.push_back({k, k + 1, step, deviation.cwiseAbs2().cwiseInverse().asDiagonal()});
  }
  return edges;
}

/// @param weights  of the loops
PoseGraph graph_of(std::span<const std::size_t> numbers, std::span<const Pose2> poses,
                   std::span<const PoseEdge> odometry, std::span<const PoseEdge> loops,
                   std::span<const double> weights) {
  PoseGraph graph;
  for (std::size_t k = 0; k < poses.size(); ++k) graph.nodes.push_back({numbers[k], poses[k]});
  graph.edges.assign(odometry.begin(), odometry.end());
  for (std::size_t l = 0; l < loops.size(); ++l) {
    graph.edges.push_back(loops[l]);
    graph.edges.back().information *= weights[l];
  }
  return graph;
}

/// Where a scan is by the key frames before and after it.
Pose2 correct(const Pose2& odometry, std::size_t k, const std::vector<KeyFrame>& frames,
              const std::vector<Pose2>& poses) {
  const auto by = [&](std::size_t frame) { return poses[frame] * (frames[frame].odometry.inverse() * odometry); };
  Pose2 before = by(k);
  if (k + 1 == frames.size()) return before;
  const double since_m = (odometry.place_m - frames[k].odometry.place_m).norm(),
               until_m = (odometry.place_m - frames[k + 1].odometry.place_m).norm();
  const double share = since_m + until_m > 0.0 ? since_m / (since_m + until_m) : 0.0;
  const Pose2 after = by(k + 1);
  return {before.place_m + share * (after.place_m - before.place_m),
          before.yaw_rad + share * wrap_angle(after.yaw_rad - before.yaw_rad)};
}

}  // namespace

struct ScanSlam::State {
  std::vector<LevelScan> scans;
};

ScanSlam::ScanSlam() : state_(std::make_unique<State>()) {}
ScanSlam::~ScanSlam() = default;
ScanSlam::ScanSlam(ScanSlam&&) noexcept = default;
ScanSlam& ScanSlam::operator=(ScanSlam&&) noexcept = default;

void ScanSlam::add(const PointScan& scan) {
  LevelScan& level = state_->scans.emplace_back();
  level.pose = Eigen::Translation3d(scan.origin_m) * scan.rotation;
  level.number = scan.number;
  const Pose2 sensor_from_map = level.odometry().inverse();
  level.points_m.reserve(scan.points_m.size());
  for (const Eigen::Vector3d& point : scan.points_m) {
    level.points_m.push_back(sensor_from_map * Eigen::Vector2d(point.head<2>()));
  }
}

Result<ScanSlamSolution> ScanSlam::solve() const {
  return detail::without_exceptions([&]() -> Result<ScanSlamSolution> {
    const std::vector<LevelScan>& scans = state_->scans;
    if (scans.size() < 2) {
      return fail(Error::Code::kUnsupported, scans.empty() ? "there are no scans" : "there is only one scan");
    }
    ScanSlamReport report;
    report.scans = scans.size();
    report.reach_m = reach_of_scans(scans);
    if (!(report.reach_m > 0.0)) return fail(Error::Code::kUnsupported, "the scans have no points");
    const auto [frames, numbers, frame_of] = key_frames(scans, report.reach_m);
    report.key_frames = frames.size();

    std::vector<Pose2> poses;
    for (const KeyFrame& frame : frames) poses.push_back(frame.odometry);
    const std::vector<PoseEdge> odometry = odometry_edges(frames, report.reach_m);
    std::vector<PoseEdge> kept_loops;
    std::vector<double> weights;
    for (const auto& [share, yaw_rad] : kSearchWindows) {
      double before = 0.0;
      for (std::size_t round = 0; round < kRoundsOfWindow; ++round) {
        Loops loops = find_loops(frames, poses, {report.reach_m, share * report.reach_m, yaw_rad});
        ++report.rounds;
        report.loops_found = loops.found;
        report.loops_kept = loops.kept.size();
        weights = solve_pose_graph(poses, odometry, loops.kept);
        const auto kept = static_cast<double>(loops.kept.size());
        kept_loops = std::move(loops.kept);
        if (kept <= (1.0 + kFewNew) * before) break;
        before = kept;
      }
    }

    std::vector<StampedPose> stamped;
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const Pose2 before = scans[i].odometry(), after = correct(before, frame_of[i], frames, poses);
      Pose pose = scans[i].pose;
      pose.linear() =
          Eigen::AngleAxisd(after.yaw_rad - before.yaw_rad, Eigen::Vector3d::UnitZ()) * scans[i].pose.linear();
      pose.translation().head<2>() = after.place_m;
      stamped.push_back({static_cast<double>(scans[i].number), pose});
    }
    return Trajectory::make(std::move(stamped)).map([&](Trajectory trajectory) {
      return ScanSlamSolution{std::move(trajectory), graph_of(numbers, poses, odometry, kept_loops, weights), report};
    });
  });
}

}  // namespace pingvox
