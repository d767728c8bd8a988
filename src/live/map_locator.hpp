#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pingvox/geometry/pose2.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/localizer.hpp"
#include "pingvox/slam/locate_recording.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Finds where the frame of SLAM is in a known map: by a Localizer, which gets the beams that a solution has placed,
/// with its path as odometry.
class MapLocator {
 public:
  struct Located {
    Pose2 map_from_slam;
    PoseHypothesis where;  ///< of the vehicle at the last of these beams
  };

  /// @param start  where the vehicle is at the first beam; nullopt: anywhere. REQUIRES valid options.
  MapLocator(LocalizerOptions options, const std::optional<StartPose>& start)
      : options_(std::move(options)), start_(start) {}

  /// Keeps a beam until a solution places it; of more than 2000 the oldest are dropped.
  void add(const Beam& beam);
  /// Takes the beams that a solution has placed.
  /// @param newest  poses by the solution, not empty
  /// @param map     the same at each call; used at the first one
  /// @return nullopt: not certain yet; an error when the layer of the map around the sonar has no walls, or is too
  /// large
  Result<std::optional<Located>> update(std::span<const StampedPose> newest, const OccupancyMap& map);
  /// Solutions that were taken.
  std::size_t solutions() const { return solutions_; }
  /// Where the vehicle may be, the most likely first.
  std::vector<PoseHypothesis> hypotheses() const;

 private:
  Result<void> begin(const Pose& first, const OccupancyMap& map);

  LocalizerOptions options_;
  std::optional<StartPose> start_;
  std::deque<Beam> waiting_;
  std::optional<Localizer> localizer_;
  /// Solutions move the whole path: only its new part is odometry.
  Pose2 odometry_from_slam_;
  std::optional<StampedPose> last_;  ///< in odometry, of the last beam with a pose
  std::size_t solutions_ = 0;
};

}  // namespace pingvox
