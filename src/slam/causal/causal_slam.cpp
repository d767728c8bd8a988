#include "pingvox/slam/causal_slam.hpp"

#include <fmt/core.h>

#include <cassert>
#include <utility>

#include "base/without_exceptions.hpp"
#include "slam/causal/causal_estimator.hpp"
#include "slam/odometry/trajectory_gaps.hpp"

namespace pingvox {

struct CausalSlam::State {
  explicit State(const SlamOptions& some) : options(some), estimator(some) {}

  SlamOptions options;
  CausalEstimator estimator;
  SweepAssembler assembler;
  std::optional<double> last_s;
};

CausalSlam::CausalSlam(const SlamOptions& options) : state_(std::make_unique<State>(options)) {
  assert(options.validate());
}
CausalSlam::~CausalSlam() = default;
CausalSlam::CausalSlam(CausalSlam&&) noexcept = default;
CausalSlam& CausalSlam::operator=(CausalSlam&&) noexcept = default;

Result<void> CausalSlam::add(Beam beam) {
  return detail::without_exceptions([&]() -> Result<void> {
    if (state_->last_s && beam.time_s < *state_->last_s) {
      return fail(Error::Code::kCorrupt, fmt::format("the times of the beams do not rise: {:.3f} s, then {:.3f} s",
                                                     *state_->last_s, beam.time_s));
    }
    state_->last_s = beam.time_s;
    state_->estimator.add_beam(beam.time_s);
    const auto sweep = state_->assembler.add(std::move(beam));
    return sweep ? state_->estimator.add_sweep(sweep_echoes(*sweep, state_->options)) : Result<void>();
  });
}

Result<void> CausalSlam::add(std::string_view source, NavQuantity quantity, const NavSample& sample) {
  return state_->estimator.add_sample(source, quantity, sample);
}

std::optional<StampedPose> CausalSlam::pose(double until_s) const {
  return state_->estimator.pose(until_s);
}

std::optional<PredictedPose> CausalSlam::predict(double until_s) const {
  return state_->estimator.predict(until_s);
}

std::optional<Trajectory> CausalSlam::path() const {
  Result<Trajectory> path = trajectory_with_gaps(state_->estimator.path());
  return path ? std::optional(*std::move(path)) : std::nullopt;
}

std::vector<StampedPose> CausalSlam::newest_path() const {
  return state_->estimator.newest_path();
}

std::optional<MotionReport> CausalSlam::motion() const {
  return state_->estimator.motion();
}

std::size_t CausalSlam::solutions() const {
  return state_->estimator.solutions();
}

LoopCount CausalSlam::loops() const {
  return {state_->estimator.loops().found, state_->estimator.loops().kept};
}

Result<SlamSolution> CausalSlam::finish() {
  return detail::without_exceptions([&]() -> Result<SlamSolution> {
    std::optional<SweepEchoes> last;
    if (const auto rest = state_->assembler.finish()) last = sweep_echoes(*rest, state_->options);
    return state_->estimator.finish(std::move(last));
  });
}

}  // namespace pingvox
