#include "pingvox/slam/causal_replay.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/without_exceptions.hpp"
#include "slam/causal/causal_estimator.hpp"
#include "slam/smoother/slam_data.hpp"
#include "slam/smoother/solution.hpp"
#include "slam/smoother/sonar_checks.hpp"

namespace pingvox {
namespace {

/// Gives an estimator beams and navigation until a time.
class Feed {
 public:
  Feed(std::span<const double> beam_times_s, const NavLog& log)
      : beam_times_s_(beam_times_s), log_(log), samples_(log.sources().size(), 0) {}

  Result<void> add_until(double time_s, CausalEstimator& estimator) {
    for (; beams_ < beam_times_s_.size() && beam_times_s_[beams_] <= time_s; ++beams_) {
      estimator.add_beam(beam_times_s_[beams_]);
    }
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      const NavSource& source = log_.sources()[s];
      for (std::size_t& next = samples_[s]; next < source.samples.size() && source.samples[next].time_s <= time_s;
           ++next) {
        const auto added = estimator.add_sample(source.name, source.quantity, source.samples[next]);
        if (!added) return added;
      }
    }
    return {};
  }

 private:
  std::span<const double> beam_times_s_;
  const NavLog& log_;
  std::size_t beams_ = 0;
  std::vector<std::size_t> samples_;  ///< of each source: how many were added
};

/// All that was recorded, as it came.
Result<SlamSolution> replay(std::span<const double> beam_times_s, std::span<const SweepEchoes> sweeps,
                            const NavLog& log, const SlamOptions& options) {
  CausalEstimator estimator(options);
  Feed feed(beam_times_s, log);
  for (const SweepEchoes& sweep : sweeps.first(sweeps.size() - 1)) {
    const auto added = feed.add_until(sweep.to_s, estimator).and_then([&] { return estimator.add_sweep(sweep); });
    if (!added) return tl::unexpected(added.error());
  }
  if (const auto added = feed.add_until(kInfinity, estimator); !added) return tl::unexpected(added.error());
  return estimator.finish(sweeps.back());
}

}  // namespace

struct CausalReplay::State {
  SlamData log;
};

CausalReplay::CausalReplay(SlamOptions options)
    : state_(std::make_unique<State>(State{SlamData(std::move(options))})) {}
CausalReplay::~CausalReplay() = default;
CausalReplay::CausalReplay(CausalReplay&&) noexcept = default;
CausalReplay& CausalReplay::operator=(CausalReplay&&) noexcept = default;

void CausalReplay::add(Beam beam) {
  state_->log.add(std::move(beam));
}

Result<void> CausalReplay::add(std::string_view source, NavQuantity quantity, const NavSample& sample) {
  return state_->log.add(source, quantity, sample);
}

Result<void> CausalReplay::add(const NavLog& log) {
  return state_->log.add(log);
}

Result<SlamSolution> CausalReplay::solve() const {
  return detail::without_exceptions([&]() -> Result<SlamSolution> {
    const SlamData& heard = state_->log;
    const Result<std::vector<SweepEchoes>> sweeps = heard.sweeps();
    if (!sweeps) return tl::unexpected(sweeps.error());
    const Result<NavLog> log = NavLog::make(heard.sources(), NavClock::kUnknown);
    if (!log) return tl::unexpected(log.error());
    SlamOptions options = heard.options();
    options.nav_offset_s = 0.0;  // the sources are on the clock of the beams
    const std::vector<HeadingSource> headings = headings_of(*log, options);
    if (!headings.empty()) {
      const auto checked = check_headings(headings, heard.beam_times_s());
      if (!checked) return tl::unexpected(checked.error());
    }
    const std::optional<VelocitySource> velocity = velocity_of(*log, options, kEarlierSamples);
    if (!velocity && options.motion == MotionSource::kVelocity) {
      const auto checked = check_sources(*log, kVelocityQuantities);
      if (!checked) return tl::unexpected(checked.error());
    }
    if (!velocity) options.motion = MotionSource::kSonar;
    Result<SlamSolution> solution = replay(heard.beam_times_s(), *sweeps, *log, options);
    if (!solution || solution->report.velocity.by_sonar || !velocity) return solution;
    // Of all, not of the window.
    const std::vector<StampedPose>& poses = solution->trajectory.poses();
    report_velocity(*velocity, {poses.front().time_s, poses.back().time_s}, solution->report.velocity);
    report_checks(checks_of(*velocity, headings.front(), *sweeps, heard.turns(), options), solution->report);
    return solution;
  });
}

}  // namespace pingvox
