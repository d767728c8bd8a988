#pragma once

#include <optional>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/nav/clock_offset.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox {

/// How the vehicle turned, by the picture of its sonar: when the vehicle turns left, the picture turns right. Parts of
/// 30 degrees are looked for in the next sweep, up to 60 degrees away; those that are not found clearly give nothing.
class PictureTurns {
 public:
  /// @param body_from_sonar  the picture of a head that is upside down turns with the vehicle; one that is tilted by
  ///                         45 degrees or more shows no turns
  explicit PictureTurns(const Pose& body_from_sonar = Pose::Identity());

  /// Takes the next beam, which must be valid.
  void add(Beam beam);
  /// The changes of yaw found so far; the beams since the last whole sweep count as one.
  std::vector<YawChange> finish();
  /// Of two seconds and more between one beam and the next.
  const std::vector<TimeSpan>& pauses() const { return pauses_; }

 private:
  void compare(Sweep sweep);

  double sense_;  ///< 1; -1 of a head that is upside down; 0 of one that shows no turns
  SweepAssembler assembler_;
  Sweep before_;
  std::vector<YawChange> changes_;
  std::optional<double> last_s_;
  std::vector<TimeSpan> pauses_;
};

}  // namespace pingvox
