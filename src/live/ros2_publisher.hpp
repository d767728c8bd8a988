#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "device/internal/ros2_node.hpp"
#include "live/task_thread.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/live/ros2_publish.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Whether poses are published as transforms: not where another node already publishes that frame's parent.
enum class PublishTf { kNo, kYes };

/// Publishes a map and poses as topics of ROS 2, in threads of its own: messages of a large map take long, and a slow
/// reader may block the writer.
class Ros2Publisher {
 public:
  static Result<Ros2Publisher> open(const Ros2Node& node, const Ros2Publish& options, PublishTf tf);

  Ros2Publisher(Ros2Publisher&&) noexcept;
  Ros2Publisher& operator=(Ros2Publisher&&) noexcept;
  ~Ros2Publisher();

  /// Whether a map is due and the one before is written.
  bool is_map_due(double now_s) const;
  /// Publishes a copy, unless no cell is occupied. @param since_1970_s  its time
  void publish_map(const OccupancyMap& map, double now_s, double since_1970_s);
  /// Dropped within 0.05 s of the last one.
  void publish_pose(const StampedPose& pose, double since_1970_s);
  /// Waits until all is written.
  void finish();

  /// Why something is not published; empty: all is.
  std::string problem() const;

 private:
  struct Shared;
  Ros2Publisher(std::unique_ptr<Shared> shared, const Ros2Publish& options);

  std::unique_ptr<Shared> shared_;  ///< with the threads
  Ros2Publish options_;
  double map_due_s_ = 0.0;
  std::optional<StampedPose> last_;
};

}  // namespace pingvox
