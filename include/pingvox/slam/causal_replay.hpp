#pragma once

#include <memory>
#include <string_view>

#include "pingvox/slam/slam_smoother.hpp"

namespace pingvox {

/// CausalSlam on a recording: the pose of each beam from the data until then, and checks of the velocity and the clocks
/// over all of it. Where the recording has no velocity, motion is estimated from the sonar.
class CausalReplay {
 public:
  /// REQUIRES valid options.
  explicit CausalReplay(SlamOptions options);
  ~CausalReplay();
  CausalReplay(CausalReplay&&) noexcept;
  CausalReplay& operator=(CausalReplay&&) noexcept;

  /// As of SlamSmoother: beams in order, samples and logs in any.
  void add(Beam beam);
  Result<void> add(std::string_view source, NavQuantity quantity, const NavSample& sample);
  Result<void> add(const NavLog& log);

  /// Of all that was added so far. May be called again after more was added.
  /// @return errors of SlamSmoother::solve
  Result<SlamSolution> solve() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pingvox
