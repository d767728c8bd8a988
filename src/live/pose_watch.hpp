#pragma once

#include <cstddef>
#include <optional>

#include "pingvox/live/live_event.hpp"

namespace pingvox {

/// Detects that beams get no pose although poses arrive, and why.
class PoseWatch {
 public:
  /// The latest one by its stamp, and its arrival. The two may be of different clocks.
  struct Latest {
    double stamp_s = 0.0, came_s = 0.0;
  };
  struct Seen {
    double now_s = 0.0;
    Latest pose, beam;
    std::size_t beams = 0, without_pose = 0;  ///< of all whose pose was looked up so far
  };

  /// @return what to report
  std::optional<LiveEvent> update(const Seen& seen);
  /// Forgets the beams and poses so far, not what was reported.
  void restart(const Seen& seen);
  /// Whether BeamsWithoutPose was reported last.
  bool is_reported() const { return is_reported_; }

 private:
  struct Count {
    std::size_t beams = 0, without_pose = 0;
    double seconds = 0.0;
  };
  void note_pose(const Seen& seen);
  void begin_window(const Seen& from, double from_s);
  std::optional<LiveEvent> judge(const Count& window);
  live_event::BeamsWithoutPose loss(const Count& count) const;

  Seen last_;
  std::optional<double> asked_s_;  ///< when the last pose was asked for; nullopt: no window has begun
  Seen from_;                      ///< the counts before the window
  double from_s_ = 0.0;
  std::optional<Count> before_;  ///< the window before
  std::optional<double> pose_came_s_;
  double behind_s_ = 0.0;                        ///< of the last pose that came
  double apart_s_ = 0.0, apart_before_s_ = 0.0;  ///< longest time between two poses in this window and the one before
  bool is_reported_ = false;
};

}  // namespace pingvox
