#include "pingvox/slam/causal_slam.hpp"

#include <fmt/core.h>

#include <cassert>
#include <utility>

#include "base/without_exceptions.hpp"
#include "slam/causal/causal_estimator.hpp"

namespace pingvox {

struct CausalSlam::State {
  explicit State(const SlamOptions& some) : options(some), estimator(some) {}

  void take(const Sweep& sweep) {
    estimator.add_sweep(heard_sweep(sweep, options));
    ++waiting;
  }

  SlamOptions options;
  CausalEstimator estimator;
  SweepAssembler assembler;
  std::optional<double> last_s;
  std::size_t waiting = 0;  ///< sweeps since the last solution
};

CausalSlam::CausalSlam(SlamOptions options) {
  assert(options.validate());
  options.estimation = Estimation::kCausal;
  state_ = std::make_unique<State>(options);
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
    if (!sweep) return {};
    state_->take(*sweep);
    if (state_->waiting < kSweepsOfStep) return {};
    state_->waiting = 0;
    return state_->estimator.solve();
  });
}

Result<void> CausalSlam::add(std::string_view source, NavQuantity quantity, const NavSample& sample) {
  return state_->estimator.add_sample(source, quantity, sample);
}

std::optional<StampedPose> CausalSlam::pose() const {
  return state_->estimator.pose();
}

Result<SlamSolution> CausalSlam::finish() {
  return detail::without_exceptions([&]() -> Result<SlamSolution> {
    if (const auto rest = state_->assembler.finish()) state_->take(*rest);
    return state_->estimator.finish();
  });
}

}  // namespace pingvox
