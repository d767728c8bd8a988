#include "mapping/echo_mapper.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "pingvox/map/cast_ray.hpp"
#include "pingvox/map/trace_ray.hpp"

namespace pingvox::detail {
namespace {

/// Distance from a point to the farthest corner of a cell.
double farthest_corner_m(const Lattice& lattice, const WideKey& key, const Eigen::Vector3d& from_m) {
  const double half_m = 0.5 * lattice.resolution_m();
  return ((lattice.centre_of(key) - from_m).cwiseAbs().array() + half_m).matrix().norm();
}

double range_of(const EchoBeam& beam) {
  return static_cast<double>(beam.bins) * beam.bin_length_m;
}

double freed_range_m(const EchoBeam& beam) {
  return beam.echo ? beam.echo->range_m : range_of(beam);
}

}  // namespace

EchoBeams echo_beams(const std::vector<EchoStream::BeamWithEcho>& heard, std::uint64_t first,
                     std::size_t ended_sweeps) {
  EchoBeams out;
  out.ended_sweeps = ended_sweeps;
  out.beams.reserve(heard.size());
  out.numbers.reserve(heard.size());
  for (const EchoStream::BeamWithEcho& one : heard) {
    const std::size_t bins =
        std::min<std::size_t>(one.beam.intensities.size(), std::numeric_limits<std::uint32_t>::max());
    // Sound that came back from beyond the range has passed all before.
    out.beams.push_back({one.beam.time_s, one.beam.bearing_rad, one.beam.bin_length_m, static_cast<std::uint32_t>(bins),
                         one.echo ? EchoBeam::Where::kInRange : EchoBeam::Where::kBeyond,
                         one.echo ? one.echo : one.beyond});
    out.numbers.push_back(first + one.number);
  }
  return out;
}

EchoStream echo_stream(const BuildOptions& options) {
  return {options.filter, options.echo,
          options.timing == Timing::kBySweep ? EchoStream::Wait::kForSweep : EchoStream::Wait::kForNeighbours};
}

EchoMapper::EchoMapper(const BuildOptions& options, OccupancyMap& map, CountSweeps count)
    : options_(options), map_(&map), scan_(map.lattice(), options.miss), parts_(options.threads) {
  if (count == CountSweeps::kYes) coverage_.emplace(map.lattice().resolution_m());
  for (std::size_t i = 0; i < options.threads; ++i) tracers_.emplace_back(options.model, options.echo.max_range_m);
}

Result<void> EchoMapper::add(const EchoBeams& heard, std::span<const std::optional<Pose>> map_from_body,
                             BuildReport& report) {
  watch_.skip();
  if (options_.timing == Timing::kBySweep) no_pose_before_ = report.no_pose.count;  // these beams are one sweep
  const Result<Placed> placed = place(heard, map_from_body, report);
  if (!placed) return tl::unexpected(placed.error());
  Result<void> mapped =
      options_.vote == Vote::kPerSweep ? map_as_one_scan(*placed, report) : map_one_by_one(*placed, report);
  if (!mapped) return mapped;
  if (heard.ended_sweeps > 0) {
    if (report.no_pose.count == no_pose_before_) report.sweeps += heard.ended_sweeps;
    no_pose_before_ = report.no_pose.count;
  }
  if (coverage_ && (heard.ended_sweeps > 0 || options_.timing == Timing::kBySweep)) {
    coverage_->end_sweep(heard.ended_sweeps > 0);
  }
  report.skipped = report.no_pose.count + report.outside.count + report.blocked.count + report.too_long.count;
  return {};
}

void EchoMapper::restart(const BuildReport& report) {
  no_pose_before_ = report.no_pose.count;
  recent_ranges_m_.clear();
  too_long_in_row_ = 0;
  scan_.clear();
  end_sweep();
}

void EchoMapper::end_sweep() {
  if (coverage_) coverage_->end_sweep(false);
}

/// Ranges beyond are out of all proportion to those of the beams before and with them: those of damaged numbers.
/// Infinity: all are plausible, as those after the range was changed.
double EchoMapper::longest_range_m(std::span<const EchoBeam> beams) {
  constexpr double kPlausible = 10.0, kNone = std::numeric_limits<double>::infinity();
  constexpr std::size_t kFewBeams = 10, kRecentBeams = 100;
  std::vector<double> ranges_m = recent_ranges_m_;
  std::ranges::transform(beams, std::back_inserter(ranges_m), range_of);
  double longest_m = kNone;
  if (ranges_m.size() >= kFewBeams) {
    std::vector<double> sorted_m = ranges_m;
    const auto middle = sorted_m.begin() + static_cast<std::ptrdiff_t>(sorted_m.size() / 2);
    std::ranges::nth_element(sorted_m, middle);
    longest_m = kPlausible * *middle;
  }
  const auto is_beyond = [&](double range_m) { return range_m > longest_m; };
  const auto beyond = static_cast<std::size_t>(std::ranges::count_if(beams, is_beyond, range_of));
  too_long_in_row_ = beyond > 0 ? too_long_in_row_ + beyond : 0;
  const bool is_reset = too_long_in_row_ >= kFewBeams && beyond * kFewBeams > beams.size();
  std::erase_if(ranges_m, [&](double range_m) { return is_beyond(range_m) != is_reset; });
  if (is_reset) {
    too_long_in_row_ = 0;
    longest_m = kNone;
  }
  const std::size_t old = ranges_m.size() - std::min(ranges_m.size(), kRecentBeams);
  recent_ranges_m_.assign(ranges_m.begin() + static_cast<std::ptrdiff_t>(old), ranges_m.end());
  return longest_m;
}

/// Each beam where it was heard: de-skew. Those without a pose are left out.
Result<EchoMapper::Placed> EchoMapper::place(const EchoBeams& heard, std::span<const std::optional<Pose>> map_from_body,
                                             BuildReport& report) {
  Placed placed;
  placed.beams.reserve(heard.beams.size());
  placed.heard.reserve(heard.beams.size());
  const double longest_m = longest_range_m(heard.beams);
  for (std::size_t n = 0; n < heard.beams.size(); ++n) {
    const EchoBeam& one = heard.beams[n];
    if (!map_from_body[n]) {
      report.no_pose.add(one.time_s);
      continue;
    }
    const PlacedBeam beam{*map_from_body[n] * options_.body_from_sensor, one.bearing_rad, one.bin_length_m, one.bins,
                          one.echo};
    if (is_blocked(beam)) {
      report.blocked.add(one.time_s);
      continue;
    }
    if (range_of(one) > longest_m || length_of(one) > kMaxCellsInRay || cells_of(one) > kMaxCellsInBeam) {
      report.too_long.add(one.time_s);
      // One damaged number costs its beam; where no beam fits, the map is at fault.
      constexpr std::size_t kFew = 20;
      const bool fits_none = report.beams == 0 && placed.beams.empty() && report.too_long.count > kFew;
      if (fits_none) return too_many_cells(one);
      continue;
    }
    placed.beams.push_back(beam);
    placed.heard.push_back(&one);
  }
  for (std::size_t n = 0; n < placed.heard.size(); ++n) {
    const EchoBeam* const one = placed.heard[n];
    const bool has_echo = one->echo && one->where == EchoBeam::Where::kInRange;
    if (coverage_) coverage_->add(one->time_s, placed.beams[n], options_.model.width_rad, has_echo);
    if (!has_echo) continue;
    const int threshold = one->echo->threshold;
    ++report.echoes;
    report.min_threshold = std::min(report.min_threshold.value_or(threshold), threshold);
    report.max_threshold = std::max(report.max_threshold.value_or(threshold), threshold);
  }
  report.beams += placed.beams.size();
  return placed;
}

/// Whether the map has an obstacle on the beam's axis within the blanking range. Its own echo is not heard; what is
/// heard are its second echo, or sound that went round it. The surface is anywhere in its cell, so all of the cell has
/// to be that near: otherwise coarse cells block beams that hear the surface itself.
bool EchoMapper::is_blocked(const PlacedBeam& beam) const {
  const double blanking_m = options_.echo.min_range_m.value_or(EchoOptions::kDefaultBlanking_m);
  if (map_->empty() || !(blanking_m > 0.0)) return false;
  const Eigen::Vector3d axis{std::cos(beam.bearing_rad), std::sin(beam.bearing_rad), 0.0};
  const Eigen::Vector3d origin_m = beam.map_from_sensor.translation();
  const Eigen::Vector3d direction = beam.map_from_sensor.linear() * axis;
  const RayEnd end = cast_ray(*map_, origin_m, direction, blanking_m);
  return end.what == Occupancy::kOccupied && farthest_corner_m(map_->lattice(), end.key, origin_m) <= blanking_m;
}

/// Number of cells that a beam is long, and that it would free.
double EchoMapper::length_of(const EchoBeam& beam) const {
  return std::min(freed_range_m(beam), options_.echo.max_range_m) / map_->lattice().resolution_m();
}

double EchoMapper::cells_of(const EchoBeam& beam) const {
  return cells_in_beam(options_.model, std::min(freed_range_m(beam), options_.echo.max_range_m),
                       map_->lattice().resolution_m());
}

tl::unexpected<Error> EchoMapper::too_many_cells(const EchoBeam& beam) const {
  if (const double length = length_of(beam); length > kMaxCellsInRay) {
    return fail(Error::Code::kLimit,
                fmt::format("a beam of {:.3g} m at {:.3f} s is {:.1e} cells of {} m long, and {:.0e} are the most: "
                            "use larger cells or a shorter maximum range",
                            freed_range_m(beam), beam.time_s, length, map_->lattice().resolution_m(), kMaxCellsInRay));
  }
  return fail(
      Error::Code::kLimit,
      fmt::format("a beam of {:.3g} m at {:.3f} s fills {:.1e} cells of {} m, and {:.0e} are the most: use larger "
                  "cells, a shorter maximum range or a thinner beam",
                  freed_range_m(beam), beam.time_s, cells_of(beam), map_->lattice().resolution_m(), kMaxCellsInBeam));
}

/// All beams in one scan.
Result<void> EchoMapper::map_as_one_scan(const Placed& placed, BuildReport& report) {
  const std::span<const PlacedBeam> beams = placed.beams;
  std::vector<std::size_t> left_out(beams.size());
  parts_.run(beams.size(), scan_, [&](std::size_t part, std::size_t first, std::size_t last, ScanUpdate& scan) {
    std::ranges::copy(tracers_[part].trace(beams.subspan(first, last - first), scan),
                      left_out.begin() + static_cast<std::ptrdiff_t>(first));
  });
  for (std::size_t i = 0; i < beams.size(); ++i) {
    if (left_out[i] > 0) report.outside.add(placed.heard[i]->time_s);
  }
  return apply(report);
}

/// Each beam as a scan of its own.
Result<void> EchoMapper::map_one_by_one(const Placed& placed, BuildReport& report) {
  const std::span<const PlacedBeam> beams = placed.beams;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    if (tracers_.front().trace(beams.subspan(i, 1), scan_).front() > 0) report.outside.add(placed.heard[i]->time_s);
    if (const auto applied = apply(report); !applied) return applied;
  }
  return {};
}

/// Applies the scan and empties it.
Result<void> EchoMapper::apply(BuildReport& report) {
  watch_.lap(report.seconds.trace);
  if (scan_.empty()) return {};
  // Before, as a scan may be applied in part.
  if (changes_ != nullptr) changes_->add(scan_);
  const Result<ApplyReport> applied = map_->apply(scan_);
  if (!applied) return tl::unexpected(applied.error());
  report.cells_freed += applied->cells_freed;
  report.cells_hit += applied->cells_hit;
  scan_.clear();
  watch_.lap(report.seconds.apply);
  return {};
}

}  // namespace pingvox::detail
