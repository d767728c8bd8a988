#include "pingvox/mapping/build_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "mapping/parts.hpp"
#include "pingvox/cloud/trace_points.hpp"
#include "pingvox/mapping/beam_tracer.hpp"
#include "pingvox/sonar/polar_image.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox {
namespace {

/// Adds the time since the last lap to one stage after the other.
class Stopwatch {
 public:
  void lap(double& stage_s) {
    const auto now = Clock::now();
    stage_s += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

/// The beams of a source, sweep by sweep, with ranges corrected for the true speed of sound.
class SweepReader {
 public:
  SweepReader(BeamSource& source, double sound_speed_ratio) : source_(source), ratio_(sound_speed_ratio) {}

  Result<std::optional<Sweep>> next() {
    while (!ended_) {
      Result<std::optional<Beam>> beam = source_.next();
      if (!beam) return tl::unexpected(std::move(beam.error()));
      if (!*beam) {
        ended_ = true;
        return assembler_.finish();
      }
      (*beam)->bin_length_m *= ratio_;
      if (auto sweep = assembler_.add(std::move(**beam))) return sweep;
    }
    return std::nullopt;
  }

 private:
  BeamSource& source_;
  double ratio_;
  SweepAssembler assembler_;
  bool ended_ = false;
};

/// A sweep's echoes within the model's range. A beam without one that heard something beyond it keeps that: sound that
/// came back from there has passed all that lies before, and the model hits nothing so far away.
std::vector<std::optional<Echo>> echoes_of(const PolarImage& image, const Sweep& sweep, const EchoOptions& within,
                                           const BuildOptions& options) {
  std::vector<std::optional<Echo>> echoes = detect_echoes(image, sweep, within);
  if (!std::isfinite(options.model.max_range_m)) return echoes;
  const std::vector<std::optional<Echo>> all = detect_echoes(image, sweep, options.echo);
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    if (!echoes[i] && all[i] && all[i]->range_m > options.model.max_range_m) echoes[i] = all[i];
  }
  return echoes;
}

/// Refuses cells so small that a single beam would take all memory.
Result<void> check_size(const Beam& beam, const std::optional<Echo>& echo, const BeamModelOptions& model,
                        const Lattice& lattice) {
  const double range_m = echo ? echo->range_m : static_cast<double>(beam.intensities.size()) * beam.bin_length_m;
  const double cells = cells_in_beam(model, range_m, lattice.resolution_m());
  if (cells <= kMostCellsInBeam) return {};
  return fail(
      Error::Code::kLimit,
      fmt::format("a beam of {:.3g} m at {:.3f} s fills {:.1e} cells of {} m, and {:.0e} are the most: larger cells, "
                  "a shorter maximum range or a thinner beam would do",
                  range_m, beam.time_s, cells, lattice.resolution_m(), kMostCellsInBeam));
}

/// A beam of a sweep, and where the head was when it was heard.
struct PlacedBeam {
  std::size_t number;
  Pose map_from_sensor;
};

/// Each beam where it was heard: de-skew. Those that the trajectory has no place for are left out.
Result<std::vector<PlacedBeam>> placed_beams(std::span<const Beam> beams, std::span<const std::optional<Echo>> echoes,
                                             const Trajectory& map_from_body, const BuildOptions& options,
                                             const Lattice& lattice) {
  std::vector<PlacedBeam> placed;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const std::optional<Pose> body = map_from_body.at(beams[i].time_s);
    if (!body) continue;
    if (const auto fits = check_size(beams[i], echoes[i], options.model, lattice); !fits) {
      return tl::unexpected(fits.error());
    }
    placed.push_back({i, *body * options.body_from_sensor});
  }
  return placed;
}

/// Applies the scan and empties it.
Result<void> apply(ScanUpdate& scan, OccupancyMap& map, BuildReport& report) {
  const Result<ApplyReport> applied = map.apply(scan);
  if (!applied) return tl::unexpected(applied.error());
  report.cells_freed += applied->cells_freed;
  report.cells_hit += applied->cells_hit;
  scan.clear();
  return {};
}

}  // namespace

Result<void> BuildOptions::validate() const {
  std::string bad;
  for (const Result<void>& part : {filter.validate(), echo.validate(), model.validate()}) {
    if (!part) bad += (bad.empty() ? "" : "; ") + part.error().message;
  }
  if (!body_from_sensor.matrix().allFinite()) bad += (bad.empty() ? "" : "; ") + std::string("mount is not finite");
  if (!(sound_speed_ratio > 0.1 && sound_speed_ratio < 10.0)) {
    bad += fmt::format("{}sound speed must be within a tenth and ten times of what the device assumed, is {} times",
                       bad.empty() ? "" : "; ", sound_speed_ratio);
  }
  if (threads < 1 || threads > 256) {
    bad += fmt::format("{}threads must be in 1..256, are {}", bad.empty() ? "" : "; ", threads);
  }
  if (bad.empty()) return {};
  return fail(Error::Code::kBadOption, bad);
}

Result<EchoOptions> BuildOptions::echo_within_range() const {
  if (const double nearest_m = echo.min_range_m.value_or(0.0); !(model.max_range_m > nearest_m)) {
    return fail(Error::Code::kBadOption,
                fmt::format("max range must be greater than min range, {} m, is {} m", nearest_m, model.max_range_m));
  }
  EchoOptions within = echo;
  within.farthest_m = std::min(echo.farthest_m, model.max_range_m);
  return within;
}

Result<BuildReport> build_map(BeamSource& source, const Trajectory& map_from_body, const BuildOptions& options,
                              OccupancyMap& map, const Progress& progress) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  const Result<EchoOptions> within = options.echo_within_range();
  if (!within) return tl::unexpected(within.error());
  SweepReader sweeps(source, options.sound_speed_ratio);
  ScanUpdate scan(options.model.miss);
  ScanParts parts(options.threads);
  BuildReport report;
  std::size_t unplaced = 0;  // beams that the trajectory has no place for
  Stopwatch watch;
  for (;;) {
    const Result<std::optional<Sweep>> sweep = sweeps.next();
    watch.lap(report.seconds.read);
    if (!sweep) return tl::unexpected(sweep.error());
    if (!*sweep) break;

    const std::vector<Beam>& beams = (*sweep)->beams;
    const PolarImage image = filtered(PolarImage(**sweep), options.filter);
    const std::vector<std::optional<Echo>> echoes = echoes_of(image, **sweep, *within, options);
    watch.lap(report.seconds.detect);

    const Result<std::vector<PlacedBeam>> placed = placed_beams(beams, echoes, map_from_body, options, map.lattice());
    if (!placed) return tl::unexpected(placed.error());
    unplaced += beams.size() - placed->size();
    report.beams += placed->size();
    for (const PlacedBeam& beam : *placed) {
      const std::optional<Echo>& echo = echoes[beam.number];
      report.echoes += echo && echo->range_m <= options.model.max_range_m;
    }
    const auto trace = [&](const PlacedBeam& beam, BeamTracer& tracer, ScanUpdate& into) -> std::size_t {
      const std::size_t i = beam.number;
      return tracer.trace(beam.map_from_sensor, beams[i], echoes[i], into) > 0 ? 1 : 0;
    };
    if (options.vote == Vote::kPerSweep) {
      std::atomic<std::size_t> outside = 0;
      parts.run(placed->size(), scan, [&](std::size_t, std::size_t first, std::size_t last, ScanUpdate& part) {
        BeamTracer tracer(map.lattice(), options.model);
        for (std::size_t i = first; i < last; ++i) outside += trace((*placed)[i], tracer, part);
      });
      report.outside += outside;
    } else {
      BeamTracer tracer(map.lattice(), options.model);
      for (const PlacedBeam& beam : *placed) {
        report.outside += trace(beam, tracer, scan);
        watch.lap(report.seconds.trace);
        if (const auto applied = apply(scan, map, report); !applied) return tl::unexpected(applied.error());
        watch.lap(report.seconds.apply);
      }
    }
    watch.lap(report.seconds.trace);
    if (const auto applied = apply(scan, map, report); !applied) return tl::unexpected(applied.error());
    watch.lap(report.seconds.apply);

    report.sweeps += (*sweep)->extent != Sweep::Extent::kCut;
    report.skipped = source.skipped() + unplaced + report.outside;
    if (progress) progress(report);
  }
  report.skipped = source.skipped() + unplaced + report.outside;
  return report;
}

Result<BuildReport> build_map(ScanSource& source, const BuildOptions& options, OccupancyMap& map,
                              const Progress& progress) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  const PointScanOptions how{
      .ray = options.model.ray, .hit = options.model.hit, .max_range_m = options.model.max_range_m};
  ScanUpdate scan(options.model.miss);
  ScanParts parts(options.threads);
  std::vector<PointTracer> tracers;
  for (std::size_t i = 0; i < std::max<std::size_t>(options.threads, 1); ++i) tracers.emplace_back(map.lattice(), how);
  BuildReport report;
  Stopwatch watch;
  for (;;) {
    const Result<std::optional<PointScan>> points = source.next();
    watch.lap(report.seconds.read);
    if (!points) return tl::unexpected(points.error());
    if (!*points) break;
    const std::span<const Eigen::Vector3d> all_m = (*points)->points_m;
    std::atomic<std::size_t> outside = 0;
    parts.run(all_m.size(), scan, [&](std::size_t number, std::size_t first, std::size_t last, ScanUpdate& part) {
      outside += tracers[number].trace((*points)->origin_m, all_m.subspan(first, last - first), part);
    });
    report.outside += outside;
    watch.lap(report.seconds.trace);
    if (const auto applied = apply(scan, map, report); !applied) return tl::unexpected(applied.error());
    watch.lap(report.seconds.apply);
    report.beams += (*points)->points_m.size();
    report.echoes += (*points)->points_m.size();
    ++report.sweeps;
    report.skipped = source.skipped() + report.outside;
    if (progress) progress(report);
  }
  report.skipped = source.skipped() + report.outside;
  return report;
}

}  // namespace pingvox
