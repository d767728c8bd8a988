#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// What a vehicle can do between two samples of its place. A time step counts as 0.1 s at least, as devices are late
/// by that much, and a source that is noisier or faster than this by nature has five times what is usual for it.
struct MotionLimits {
  double speed_m_s = 10.0;
  double turn_rad_s = 2.0 * std::numbers::pi;
  double noise_m = 0.0;           ///< by which positions differ although nothing moves
  bool starts_at_origin = false;  ///< its device starts at 0 whenever it is switched on
  /// Those of a source of a quantity.
  static MotionLimits of(NavQuantity quantity);
};

/// What a sample says of the place of a vehicle; the rest is 0.
struct SamplePose {
  double time_s = 0.0;
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};
/// Whether a quantity says where the vehicle is or how it is turned: position, fix, depth, pressure, attitude, heading.
bool gives_pose(NavQuantity quantity);
/// The pose by a sample. REQUIRES gives_pose.
/// @param origin  value of the first sample of the source, which fixes are relative to
SamplePose pose_by(NavQuantity quantity, const NavSample& sample, const Eigen::Vector3d& origin);

/// From one sample to the next.
struct PoseStep {
  double from_s = 0.0, to_s = 0.0;
  Eigen::Vector3d moved_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  double turned_rad = 0.0;

  double seconds() const { return to_s - from_s; }
  static PoseStep between(const SamplePose& from, const SamplePose& to);
};

/// Tells in which frame the samples of a source are: a step that no vehicle makes leads from one into another. The
/// steps are added up, so it is known when a later one leads back into a frame that was left.
class FrameTracker {
 public:
  explicit FrameTracker(const MotionLimits& limits = {}) : limits_(limits) {}

  /// @return number of the sample's frame, from 0 in the order in which they begin
  /// REQUIRES samples in order of time
  std::size_t add(const SamplePose& sample);

  /// Whether the last sample began a frame because its device restarted: it is at the origin, but was not before
  /// a pause or a jump.
  bool is_new_start() const { return is_new_start_; }

 private:
  struct Frame {
    std::size_t number = 0;
    Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< sum of the jumps that led here
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    double left_s = 0.0;  ///< how long the step took that left it
    std::size_t samples = 0;
  };
  bool is_beyond(const PoseStep& step, double speed_m_s, double turn_rad_s) const;
  bool is_jump(const PoseStep& step) const;
  bool leads_to_new_start(const PoseStep& step, const SamplePose& sample) const;
  void leave_frame(const PoseStep& step);
  double share_of_limit(const Frame& frame, const Frame& other, double seconds) const;
  void begin_frame(Frame frame);
  void remember(const PoseStep& step);

  struct Usual {
    double seconds = 0.0, speed_m_s = 0.0, turn_rad_s = 0.0;
  };
  static constexpr std::size_t kUsual = 15;

  MotionLimits limits_;
  std::optional<SamplePose> last_;
  std::vector<Frame> frames_;             ///< those that may come again
  std::size_t current_ = 0;               ///< index in frames_
  std::size_t begun_ = 0;                 ///< frames so far
  std::array<Usual, kUsual> usual_ = {};  ///< of the last steps that are none into another frame
  std::size_t remembered_ = 0;
  bool is_new_start_ = false;
};

}  // namespace pingvox
