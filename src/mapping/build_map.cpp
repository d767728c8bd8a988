#include "pingvox/mapping/build_map.hpp"

#include <algorithm>
#include <atomic>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/without_exceptions.hpp"
#include "mapping/scan_parts.hpp"
#include "mapping/stopwatch.hpp"
#include "pingvox/cloud/trace_points.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/mapping/beam_mapper.hpp"

namespace pingvox {
namespace {

BuildReport report_of(const BeamMapper& mapper, const BeamSource& source, double read_s) {
  BuildReport report = mapper.report();
  report.skipped += source.skipped();
  report.seconds.read = read_s;
  return report;
}

/// From the frame of the sensor to that of the map.
void move_scan(const Pose& map_from_sensor, PointScan& scan) {
  scan.origin_m = map_from_sensor * scan.origin_m;
  for (Eigen::Vector3d& point_m : scan.points_m) point_m = map_from_sensor * point_m;
}

}  // namespace

Result<BuildReport> build_map(BeamSource& source, const Trajectory& map_from_body, const BuildOptions& options,
                              OccupancyMap& map, const Progress& progress) {
  Result<BeamMapper> mapper = BeamMapper::make(options, map, CountSweeps::kYes);
  if (!mapper) return tl::unexpected(mapper.error());
  double read_s = 0.0;
  std::optional<double> first_s, last_s;
  std::size_t told = 0;
  for (;;) {
    detail::Stopwatch watch;
    Result<std::optional<Beam>> beam = source.next();
    watch.lap(read_s);
    if (!beam) return tl::unexpected(std::move(beam.error()));
    if (!*beam) break;
    const double time_s = (*beam)->time_s;
    first_s = std::min(first_s.value_or(time_s), time_s);
    last_s = std::max(last_s.value_or(time_s), time_s);
    const std::optional<Pose> pose = map_from_body.at(time_s);
    if (const auto added = mapper->add(std::move(**beam), pose); !added) return tl::unexpected(added.error());
    if (progress && std::exchange(told, mapper->report().beams) != told) progress(report_of(*mapper, source, read_s));
  }
  if (const auto finished = mapper->finish(); !finished) return tl::unexpected(finished.error());
  BuildReport report = report_of(*mapper, source, read_s);
  report.first_s = first_s;
  report.last_s = last_s;
  report.coverage = mapper->coverage();
  if (progress) progress(report);
  return report;
}

Result<BuildReport> build_map(ScanSource& source, const Trajectory& map_from_body, const BuildOptions& options,
                              OccupancyMap& map, const Progress& progress) {
  if (const auto valid = options.validate_for_points(); !valid) return tl::unexpected(valid.error());
  const PointScanOptions how{
      .ray = options.model.ray, .hit = options.model.hit, .max_range_m = options.echo.max_range_m};
  ScanUpdate scan(map.lattice(), options.miss);
  detail::ScanParts parts(options.threads);
  std::vector<PointTracer> tracers;
  BuildReport report;
  detail::Stopwatch watch;
  const auto map_scan = [&](const PointScan& points) -> Result<void> {
    const std::span<const Eigen::Vector3d> all_m = points.points_m;
    if (const auto fits = check_rays(points.origin_m, all_m, how, map.lattice()); !fits) return fits;
    std::atomic<std::size_t> outside = 0;
    while (tracers.size() < options.threads) tracers.emplace_back(how);
    parts.run(all_m.size(), scan, [&](std::size_t number, std::size_t first, std::size_t last, ScanUpdate& part) {
      outside += tracers[number].trace(points.origin_m, all_m.subspan(first, last - first), part);
    });
    watch.lap(report.seconds.trace);
    const Result<ApplyReport> applied = map.apply(scan);
    if (!applied) return tl::unexpected(applied.error());
    scan.clear();
    watch.lap(report.seconds.apply);
    report.beams += all_m.size();
    report.echoes += all_m.size();
    ++report.sweeps;
    report.outside.count += outside;
    report.cells_freed += applied->cells_freed;
    report.cells_hit += applied->cells_hit;
    return {};
  };
  for (;;) {
    Result<std::optional<PointScan>> points = source.next();
    watch.lap(report.seconds.read);
    if (!points) return tl::unexpected(points.error());
    const auto count_skipped = [&] { report.skipped = source.skipped() + report.outside.count + report.no_pose.count; };
    count_skipped();
    if (!*points) return report;
    PointScan& next = **points;
    if (const std::optional<double> time_s = next.time_s) {
      report.first_s = std::min(report.first_s.value_or(*time_s), *time_s);
      report.last_s = std::max(report.last_s.value_or(*time_s), *time_s);
      const std::optional<Pose> pose = map_from_body.at(*time_s);
      if (!pose) {
        report.no_pose.first_s = report.no_pose.first_s.value_or(*time_s);
        report.no_pose.count += next.points_m.size();
        if (progress) progress(report);
        continue;
      }
      const Pose map_from_sensor = *pose * options.body_from_sensor;
      if (next.has_points_in_map) {
        next.origin_m = map_from_sensor.translation();
      } else {
        move_scan(map_from_sensor, next);
      }
    }
    if (const auto mapped = detail::without_exceptions([&] { return map_scan(next); }); !mapped) {
      return tl::unexpected(mapped.error());
    }
    count_skipped();
    if (progress) progress(report);
  }
}

}  // namespace pingvox
