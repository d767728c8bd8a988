#include "mapping/internal/held_out_echoes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "base/without_exceptions.hpp"
#include "mapping/echo_mapper.hpp"
#include "mapping/internal/first_return.hpp"
#include "mapping/sweep_coverage_counter.hpp"
#include "sonar/internal/echo_stream.hpp"

namespace pingvox {
namespace {

using detail::EchoBeam;
using detail::EchoBeams;
using Poses = std::vector<std::optional<Pose>>;

struct HeldOutLog {
  BuildOptions options;
  std::vector<EchoBeams> sweeps;
};

bool has_echo_in_range(const EchoBeam& beam) {
  return beam.echo && beam.where == EchoBeam::Where::kInRange;
}

Poses poses_of(const EchoBeams& sweep, const Trajectory& map_from_body, double nav_offset_s) {
  Poses poses;
  poses.reserve(sweep.beams.size());
  for (const EchoBeam& beam : sweep.beams) poses.push_back(map_from_body.at(beam.time_s - nav_offset_s));
  return poses;
}

/// The same sweep with other ranges.
EchoBeams scaled(EchoBeams sweep, double factor) {
  for (EchoBeam& beam : sweep.beams) {
    beam.bin_length_m *= factor;
    if (beam.echo) beam.echo->range_m *= factor;
  }
  return sweep;
}

Pose changed_mount(const Pose& body_from_sensor, const HeldOutOptions& options) {
  Pose mount = body_from_sensor;
  mount.linear() = Eigen::AngleAxisd(options.mount_yaw_rad, Eigen::Vector3d::UnitZ()) * body_from_sensor.linear();
  return mount.pretranslate(Eigen::Vector3d(options.mount_x_m, options.mount_y_m, 0.0));
}

struct KeyHash {
  std::size_t operator()(const WideKey& key) const {
    // Cells beside each other differ in the low bits of one component.
    constexpr std::uint64_t kX = 0x9E3779B97F4A7C15U, kY = 0xC2B2AE3D27D4EB4FU, kZ = 0x165667B19E3779F9U;
    return static_cast<std::uint64_t>(key.x) * kX ^ static_cast<std::uint64_t>(key.y) * kY ^
           static_cast<std::uint64_t>(key.z) * kZ;
  }
};

/// Counts for each cell the echoes that were compared with it.
class CellCounter {
 public:
  /// @param cells  each counts once
  void add(std::vector<WideKey> cells, bool agrees) {
    std::ranges::sort(cells);
    const auto repeated = std::ranges::unique(cells);
    cells.erase(repeated.begin(), repeated.end());
    for (const WideKey& cell : cells) {
      Counts& counts = counts_[cell];
      ++counts.judged;
      counts.agreed += agrees ? 1 : 0;
    }
  }

  std::vector<CellAgreement> cells() const {
    std::vector<CellAgreement> cells;
    cells.reserve(counts_.size());
    for (const auto& [cell, counts] : counts_) cells.push_back({cell, counts.judged, counts.agreed});
    std::ranges::sort(cells, {}, &CellAgreement::cell);
    return cells;
  }

 private:
  struct Counts {
    std::uint32_t judged = 0, agreed = 0;
  };
  std::unordered_map<WideKey, Counts, KeyHash> counts_;
};

double blanking_of(const BuildOptions& build) {
  return build.echo.min_range_m.value_or(EchoOptions::kDefaultBlanking_m);
}

void count_cells(const OccupancyMap& map, const BeamInMap& part, const BuildOptions& build, double tolerance_m,
                 const JudgedEcho& judged, CellCounter& counter) {
  switch (judged.outcome) {
    case EchoOutcome::kPredicted:
      return counter.add(occupied_on_arc(map, part, judged.range_m, tolerance_m), true);
    case EchoOutcome::kTooEarly: {
      // The sound passed all of that arc.
      const std::optional<double> first_m = first_return_m(map, part, blanking_of(build), judged.range_m + tolerance_m);
      return counter.add(occupied_on_arc(map, part, first_m.value_or(judged.range_m), tolerance_m), false);
    }
    case EchoOutcome::kFromFree:
      return counter.add(cells_on_arc(map, part, judged.range_m), false);
    case EchoOutcome::kUnknown:
      break;
  }
}

JudgedEcho judge_echo(const OccupancyMap& map, const EchoBeam& beam, const BeamInMap& part, const BuildOptions& build,
                      double tolerance_m) {
  const double echo_m = beam.echo->range_m, blanking_m = blanking_of(build);
  // What is beyond the echo does not matter.
  const double max_range_m = echo_m + tolerance_m;
  const std::optional<double> first_m =
      blanking_m < max_range_m ? first_return_m(map, part, blanking_m, max_range_m) : std::nullopt;
  JudgedEcho judged{.time_s = beam.time_s, .range_m = echo_m};
  // Most echoes come from the axis.
  const bool is_on_axis = first_m && std::abs(*first_m - echo_m) <= tolerance_m;
  const EchoPlace place =
      is_on_axis ? EchoPlace{Occupancy::kOccupied, *first_m - echo_m} : place_of_echo(map, part, echo_m, tolerance_m);
  judged.outcome = outcome_of(first_m, echo_m, tolerance_m, place.what);
  if (judged.outcome == EchoOutcome::kPredicted) judged.error_m = place.error_m;
  return judged;
}

}  // namespace

EchoOutcome outcome_of(const std::optional<double>& first_m, double echo_m, double tolerance_m, Occupancy place) {
  if (first_m && *first_m < echo_m - tolerance_m) return EchoOutcome::kTooEarly;
  switch (place) {
    case Occupancy::kOccupied:
      return EchoOutcome::kPredicted;
    case Occupancy::kFree:
      return EchoOutcome::kFromFree;
    case Occupancy::kUnknown:
      break;
  }
  return EchoOutcome::kUnknown;
}

struct HeldOutEchoes::State {
  std::vector<HeldOutLog> logs;

  /// Calls f(log, sweep, number) for each sweep; numbers go on over all logs. Stops at an error.
  template <class F>
  Result<void> for_each_sweep(const F& f) const {
    std::size_t number = 0;
    for (const HeldOutLog& log : logs) {
      for (const EchoBeams& sweep : log.sweeps) {
        if (const Result<void> done = f(log, sweep, number++); !done) return done;
      }
    }
    return {};
  }
};

HeldOutEchoes::HeldOutEchoes() : state_(std::make_unique<State>()) {}
HeldOutEchoes::HeldOutEchoes(HeldOutEchoes&&) noexcept = default;
HeldOutEchoes& HeldOutEchoes::operator=(HeldOutEchoes&&) noexcept = default;
HeldOutEchoes::~HeldOutEchoes() = default;

Result<void> HeldOutEchoes::add(BeamSource& source, const BuildOptions& options) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  return detail::without_exceptions([&]() -> Result<void> {
    HeldOutLog log{options, {}};
    log.options.timing = Timing::kBySweep;
    EchoStream stream = detail::echo_stream(log.options);
    std::size_t complete = 0;
    const auto take = [&](const std::vector<EchoStream::BeamWithEcho>& sweep) {
      if (sweep.empty()) return;
      const std::size_t before = std::exchange(complete, stream.complete_sweeps());
      log.sweeps.push_back(detail::echo_beams(sweep, 0, complete - before));
    };
    for (;;) {
      Result<std::optional<Beam>> beam = source.next();
      if (!beam) return tl::unexpected(beam.error());
      if (!*beam) break;
      (*beam)->bin_length_m *= options.sound_speed_ratio;
      take(stream.add(std::move(**beam)));
    }
    take(stream.finish());
    state_->logs.push_back(std::move(log));
    return {};
  });
}

std::size_t HeldOutEchoes::sweeps() const {
  std::size_t sweeps = 0;
  for (const HeldOutLog& log : state_->logs) sweeps += log.sweeps.size();
  return sweeps;
}

SweepCoverage HeldOutEchoes::coverage(const Trajectory& map_from_body, double cell_m) const {
  detail::SweepCoverageCounter counter(cell_m);
  const auto count = [&](const HeldOutLog& log, const EchoBeams& sweep, std::size_t) -> Result<void> {
    const Poses poses = poses_of(sweep, map_from_body, 0.0);
    for (std::size_t n = 0; n < poses.size(); ++n) {
      if (!poses[n]) continue;
      const EchoBeam& beam = sweep.beams[n];
      counter.add(beam.time_s,
                  {*poses[n] * log.options.body_from_sensor, beam.bearing_rad, beam.bin_length_m, beam.bins, beam.echo},
                  log.options.model.width_rad, has_echo_in_range(beam));
    }
    counter.end_sweep(sweep.ended_sweeps > 0);
    return {};
  };
  const Result<void> counted = state_->for_each_sweep(count);
  assert(counted);
  return counter.coverage();
}

Result<JudgedEchoes> HeldOutEchoes::judge(const Trajectory& map_from_body, const MapOptions& map,
                                          const HeldOutOptions& options,
                                          const std::function<void(double)>& progress) const {
  assert(options.folds >= 2 && options.tolerance_m > 0.0 && options.range_factor > 0.0);
  return detail::without_exceptions([&]() -> Result<JudgedEchoes> {
    const std::size_t folds = std::clamp<std::size_t>(sweeps(), 1, options.folds);
    const double steps = static_cast<double>(2 * folds * std::max<std::size_t>(sweeps(), 1));
    std::size_t step = 0;
    const auto advance = [&] {
      if (progress) progress(static_cast<double>(++step) / steps);
    };
    std::vector<JudgedEcho> all;
    CellCounter cells;
    for (std::size_t fold = 0; fold < folds; ++fold) {
      Result<OccupancyMap> made = OccupancyMap::make(map);
      if (!made) return tl::unexpected(made.error());
      const HeldOutLog* mapped_log = nullptr;
      std::optional<detail::EchoMapper> mapper;
      BuildReport report;
      const auto map_sweep = [&](const HeldOutLog& log, const EchoBeams& sweep, std::size_t number) -> Result<void> {
        advance();
        if (number % folds == fold) return {};
        if (std::exchange(mapped_log, &log) != &log) {
          BuildOptions build = log.options;
          build.body_from_sensor = changed_mount(build.body_from_sensor, options);
          mapper.emplace(build, *made);
        }
        const Poses poses = poses_of(sweep, map_from_body, options.nav_offset_s);
        return options.range_factor == 1.0 ? mapper->add(sweep, poses, report)
                                           : mapper->add(scaled(sweep, options.range_factor), poses, report);
      };
      if (const auto mapped = state_->for_each_sweep(map_sweep); !mapped) return tl::unexpected(mapped.error());
      const auto judge_sweep = [&](const HeldOutLog& log, const EchoBeams& sweep, std::size_t number) -> Result<void> {
        advance();
        if (number % folds != fold) return {};
        const Poses poses = poses_of(sweep, map_from_body, options.nav_offset_s);
        const Pose mount = changed_mount(log.options.body_from_sensor, options);
        const EchoBeams heard = scaled(sweep, options.range_factor);
        for (std::size_t n = 0; n < poses.size(); ++n) {
          if (!poses[n] || !has_echo_in_range(heard.beams[n])) continue;
          const EchoBeam& beam = heard.beams[n];
          const BeamInMap part = heard_part(log.options.model, *poses[n] * mount, beam.bearing_rad);
          JudgedEcho& judged = all.emplace_back(judge_echo(*made, beam, part, log.options, options.tolerance_m));
          judged.sweep = number;
          if (options.cells == CountCells::kYes) {
            count_cells(*made, part, log.options, options.tolerance_m, judged, cells);
          }
        }
        return {};
      };
      if (const auto judged = state_->for_each_sweep(judge_sweep); !judged) return tl::unexpected(judged.error());
    }
    std::ranges::stable_sort(all, {}, &JudgedEcho::sweep);
    return JudgedEchoes{std::move(all), cells.cells()};
  });
}

}  // namespace pingvox
