#include "pingvox/mapping/beam_mapper.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "mapping/scan_parts.hpp"
#include "mapping/stopwatch.hpp"
#include "mapping/without_exceptions.hpp"
#include "pingvox/map/cast_ray.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/mapping/beam_tracer.hpp"
#include "pingvox/sonar/echo_stream.hpp"

namespace pingvox {
namespace {

EchoStream stream_of(const BuildOptions& options) {
  return {options.filter, options.echo,
          options.timing == Timing::kBySweep ? EchoStream::Wait::kForSweep : EchoStream::Wait::kForNeighbours};
}

/// A beam, and where the head was when it was heard.
struct PlacedBeam {
  EchoStream::BeamWithEcho heard;
  Pose map_from_sensor;

  /// The first thing heard within the range, or beyond it: sound that came back from there has passed all before.
  const std::optional<Echo>& first_echo() const { return heard.echo ? heard.echo : heard.beyond; }
};

/// Refuses cells so small that a single beam would take all memory.
Result<void> check_size(const PlacedBeam& placed, const BuildOptions& options, const Lattice& lattice) {
  const Beam& beam = placed.heard.beam;
  const std::optional<Echo>& echo = placed.first_echo();
  const double range_m = echo ? echo->range_m : static_cast<double>(beam.intensities.size()) * beam.bin_length_m;
  const double cells =
      cells_in_beam(options.model, std::min(range_m, options.echo.max_range_m), lattice.resolution_m());
  if (cells <= kMaxCellsInBeam) return {};
  return fail(
      Error::Code::kLimit,
      fmt::format("a beam of {:.3g} m at {:.3f} s fills {:.1e} cells of {} m, and {:.0e} are the most: larger cells, "
                  "a shorter maximum range or a thinner beam would do",
                  range_m, beam.time_s, cells, lattice.resolution_m(), kMaxCellsInBeam));
}

}  // namespace

/// Beams go through detection, placing, tracing, and into the map.
class BeamMapper::Stages {
 public:
  Stages(const BuildOptions& options, OccupancyMap& map)
      : options_(options),
        map_(map),
        empty_stream_(stream_of(options)),
        stream_(empty_stream_),
        tracer_(options.model, options.echo.max_range_m),
        scan_(map.lattice(), options.miss),
        parts_(options.threads) {}

  Result<void> add(Beam beam, const std::optional<Pose>& map_from_body) {
    watch_.skip();
    beam.bin_length_m *= options_.sound_speed_ratio;
    poses_[beams_++] = map_from_body;
    return take(stream_.add(std::move(beam)));
  }

  Result<void> finish() {
    watch_.skip();
    return take(stream_.finish());
  }

  /// After an error: what waits is not whole any more.
  void restart() {
    stream_ = empty_stream_;
    poses_.clear();
    beams_ = 0;
    sweeps_ = 0;
    scan_.clear();
  }

  const BuildReport& report() const { return report_; }
  std::optional<std::size_t> delay_beams() const { return stream_.delay_beams(); }

 private:
  /// Maps the beams whose echoes are final.
  Result<void> take(std::vector<EchoStream::BeamWithEcho> heard) {
    watch_.lap(report_.seconds.detect);
    if (options_.timing == Timing::kBySweep) no_pose_before_ = report_.no_pose.count;  // these beams are one sweep
    const Result<std::vector<PlacedBeam>> placed = place(std::move(heard));
    if (!placed) return tl::unexpected(placed.error());
    Result<void> mapped = options_.vote == Vote::kPerSweep ? map_as_one_scan(*placed) : map_one_by_one(*placed);
    if (!mapped) return mapped;
    if (stream_.complete_sweeps() > sweeps_) {
      if (report_.no_pose.count == no_pose_before_) report_.sweeps += stream_.complete_sweeps() - sweeps_;
      no_pose_before_ = report_.no_pose.count;
    }
    sweeps_ = stream_.complete_sweeps();
    report_.skipped = report_.no_pose.count + report_.outside.count + report_.blocked.count;
    return {};
  }

  /// Each beam where it was heard: de-skew. Those without a pose are left out.
  Result<std::vector<PlacedBeam>> place(std::vector<EchoStream::BeamWithEcho> heard) {
    std::vector<PlacedBeam> placed;
    for (EchoStream::BeamWithEcho& one : heard) {
      const auto waiting = poses_.extract(one.number);
      const std::optional<Pose>& map_from_body = waiting.mapped();
      if (!map_from_body) {
        report_.no_pose.add(one.beam.time_s);
        continue;
      }
      placed.push_back({std::move(one), *map_from_body * options_.body_from_sensor});
      if (is_blocked(placed.back())) {
        report_.blocked.add(placed.back().heard.beam.time_s);
        placed.pop_back();
        continue;
      }
      if (const auto fits = check_size(placed.back(), options_, map_.lattice()); !fits) {
        return tl::unexpected(fits.error());
      }
    }
    for (const PlacedBeam& beam : placed) {
      if (beam.heard.echo) count_echo(*beam.heard.echo);
    }
    report_.beams += placed.size();
    return placed;
  }

  /// Whether the map has an obstacle on the beam's axis within the blanking range. Its own echo is not heard; what is
  /// heard are its second echo, or sound that went round it.
  bool is_blocked(const PlacedBeam& beam) const {
    const double blanking_m = options_.echo.min_range_m.value_or(EchoOptions::kDefaultBlanking_m);
    if (map_.empty() || !(blanking_m > 0.0)) return false;
    const double bearing_rad = beam.heard.beam.bearing_rad;
    const Eigen::Vector3d axis{std::cos(bearing_rad), std::sin(bearing_rad), 0.0};
    const Pose& pose = beam.map_from_sensor;
    return cast_ray(map_, pose.translation(), pose.linear() * axis, blanking_m).what == Occupancy::kOccupied;
  }

  void count_echo(const Echo& echo) {
    ++report_.echoes;
    report_.min_threshold = std::min(report_.min_threshold.value_or(echo.threshold), echo.threshold);
    report_.max_threshold = std::max(report_.max_threshold.value_or(echo.threshold), echo.threshold);
  }

  enum class Fit { kInside, kPartlyOutside };
  static Fit trace(const PlacedBeam& beam, BeamTracer& tracer, ScanUpdate& scan) {
    const std::size_t left_out = tracer.trace(beam.map_from_sensor, beam.heard.beam, beam.first_echo(), scan);
    return left_out == 0 ? Fit::kInside : Fit::kPartlyOutside;
  }

  /// All beams in one scan.
  Result<void> map_as_one_scan(const std::vector<PlacedBeam>& beams) {
    std::vector<Fit> fits(beams.size());
    parts_.run(beams.size(), scan_, [&](std::size_t, std::size_t first, std::size_t last, ScanUpdate& part) {
      BeamTracer tracer(options_.model, options_.echo.max_range_m);
      for (std::size_t i = first; i < last; ++i) fits[i] = trace(beams[i], tracer, part);
    });
    for (std::size_t i = 0; i < beams.size(); ++i) count(beams[i], fits[i]);
    return apply();
  }

  /// Each beam as a scan of its own.
  Result<void> map_one_by_one(const std::vector<PlacedBeam>& beams) {
    for (const PlacedBeam& beam : beams) {
      count(beam, trace(beam, tracer_, scan_));
      if (const auto applied = apply(); !applied) return applied;
    }
    return {};
  }

  void count(const PlacedBeam& beam, Fit fit) {
    if (fit == Fit::kPartlyOutside) report_.outside.add(beam.heard.beam.time_s);
  }

  /// Applies the scan and empties it.
  Result<void> apply() {
    watch_.lap(report_.seconds.trace);
    if (scan_.empty()) return {};
    const Result<ApplyReport> applied = map_.apply(scan_);
    if (!applied) return tl::unexpected(applied.error());
    report_.cells_freed += applied->cells_freed;
    report_.cells_hit += applied->cells_hit;
    scan_.clear();
    watch_.lap(report_.seconds.apply);
    return {};
  }

  BuildOptions options_;
  OccupancyMap& map_;
  EchoStream empty_stream_;  ///< to restart without an allocation
  EchoStream stream_;
  BeamTracer tracer_;
  ScanUpdate scan_;
  detail::ScanParts parts_;
  std::map<std::uint64_t, std::optional<Pose>> poses_;  ///< map_from_body of the beams that wait, by their numbers
  std::uint64_t beams_ = 0;                             ///< that the stream was given
  std::size_t sweeps_ = 0;                              ///< complete ones that it has counted
  std::size_t no_pose_before_ = 0;                      ///< beams left out before this sweep
  BuildReport report_;
  detail::Stopwatch watch_;
};

Result<BeamMapper> BeamMapper::make(const BuildOptions& options, OccupancyMap& map) {
  return detail::without_exceptions([&]() -> Result<BeamMapper> {
    if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
    return BeamMapper(std::make_unique<Stages>(options, map));
  });
}

BeamMapper::BeamMapper(std::unique_ptr<Stages> stages) : stages_(std::move(stages)) {}
BeamMapper::BeamMapper(BeamMapper&&) noexcept = default;
BeamMapper& BeamMapper::operator=(BeamMapper&&) noexcept = default;
BeamMapper::~BeamMapper() = default;

Result<void> BeamMapper::add(Beam beam, const std::optional<Pose>& map_from_body) {
  Result<void> added = detail::without_exceptions([&] { return stages_->add(std::move(beam), map_from_body); });
  if (!added) stages_->restart();
  return added;
}

Result<void> BeamMapper::finish() {
  Result<void> finished = detail::without_exceptions([&] { return stages_->finish(); });
  if (!finished) stages_->restart();
  return finished;
}

const BuildReport& BeamMapper::report() const {
  return stages_->report();
}

std::optional<std::size_t> BeamMapper::delay_beams() const {
  return stages_->delay_beams();
}

}  // namespace pingvox
