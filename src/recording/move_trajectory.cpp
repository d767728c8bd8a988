#include "recording/move_trajectory.hpp"

#include <utility>
#include <vector>

namespace pingvox {

Trajectory moved(const Trajectory& trajectory, const Pose& to_from_map) {
  std::vector<StampedPose> poses = trajectory.poses();
  for (StampedPose& pose : poses) pose.map_from_body = to_from_map * pose.map_from_body;
  return *Trajectory::make(std::move(poses), trajectory.longest_step_s(), trajectory.cuts());
}

}  // namespace pingvox
