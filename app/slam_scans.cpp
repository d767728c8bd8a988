#include "slam_scans.hpp"

#include <fmt/format.h>

#include <cassert>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <variant>

#include "console.hpp"
#include "open_log.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/g2o.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/slam/scan_slam.hpp"
#include "progress.hpp"
#include "slam_files.hpp"
#include "slam_report.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

/// Scans of a log moved to the poses of a trajectory over their numbers.
class MovedScans : public ScanSource {
 public:
  MovedScans(std::unique_ptr<ScanSource> scans, const Trajectory& trajectory)
      : scans_(std::move(scans)), trajectory_(trajectory) {}

  Result<std::optional<PointScan>> next() override {
    Result<std::optional<PointScan>> scan = scans_->next();
    if (!scan || !*scan) return scan;
    const std::optional<Pose> pose = trajectory_.at(static_cast<double>((*scan)->number));
    assert(pose);
    const Pose moved = *pose * Pose(Eigen::Translation3d((*scan)->origin_m) * (*scan)->rotation).inverse();
    (*scan)->origin_m = pose->translation();
    for (Eigen::Vector3d& point : (*scan)->points_m) point = moved * point;
    return scan;
  }

 private:
  std::unique_ptr<ScanSource> scans_;
  const Trajectory& trajectory_;
};

Result<void> map_scans(const Trajectory& trajectory, const SlamCommand& command, OccupancyMap& map) {
  Result<Log> log = ByteStream::open(command.recording.logs.front()).and_then([&](ByteStream stream) {
    return open_file_log(std::move(stream), command.recording.damage, command.recording.bag.beams);
  });
  if (!log) return tl::unexpected(log.error());
  auto* scans = std::get_if<std::unique_ptr<ScanSource>>(&*log);
  if (scans == nullptr) return fail(Error::Code::kIo, fmt::format("{}: has changed", command.recording.logs.front()));
  MovedScans moved(std::move(*scans), trajectory);
  const auto report = build_map(moved, Trajectory::still(Pose::Identity()), command.build, map);
  return report ? Result<void>() : tl::unexpected(report.error());
}

}  // namespace

Result<int> run_scans(const SlamCommand& command, std::unique_ptr<ScanSource> scans, Console& console) {
  if (command.recording.logs.size() > 1) {
    return fail(Error::Code::kBadOption, fmt::format("slam: unexpected argument '{}': scans of points are of one log",
                                                     command.recording.logs[1]));
  }
  const Stopwatch total;
  SlamSeconds seconds;
  Result<OccupancyMap> map = OccupancyMap::make(command.map_options);
  if (!map) return tl::unexpected(map.error());
  const Stopwatch read;
  ScanSlam slam;
  for (;;) {
    const Result<std::optional<PointScan>> scan = scans->next();
    if (!scan) return tl::unexpected(scan.error());
    if (!*scan) break;
    if ((*scan)->time_s) {
      return fail(
          Error::Code::kUnsupported,
          fmt::format("{}: its scans have no poses to begin with: 'pingvox map' maps them along --nav or --poses",
                      name_of_input(command.recording.logs.front())));
    }
    slam.add(**scan);
  }
  seconds.read = read.seconds();

  ProgressBar bar(command.output_options);
  bar.draw(std::nullopt, "solving");
  const Stopwatch solve;
  const Result<ScanSlamSolution> solution = slam.solve();
  if (!solution) {
    return fail(solution.error().code,
                fmt::format("{}: {}", name_of_input(command.recording.logs.front()), solution.error().message));
  }
  seconds.solve = solve.seconds();
  if (command.map) {
    bar.draw(std::nullopt, "mapping");
    const Stopwatch mapping;
    const Result<void> mapped = map_scans(solution->trajectory, command, *map);
    if (!mapped) return tl::unexpected(mapped.error());
    seconds.map = mapping.seconds();
  }
  bar.clear();
  const Stopwatch write;
  const auto written = write_slam_results(solution->trajectory, *map, MapAxes::kUnknown, command);
  if (!written) return tl::unexpected(written.error());
  if (command.graph) {
    const auto drawn = write_file(*command.graph, [&](std::ostream& out) { return write_g2o(solution->graph, out); });
    if (!drawn) return tl::unexpected(drawn.error());
  }
  seconds.write = write.seconds();
  seconds.total = total.seconds();
  const Result<void> summary =
      command.output_options.report == Report::kJson
          ? console.print(scan_slam_json(solution->report, scans->skipped(), seconds))
          : console.summarise(scan_slam_text(solution->report, command, seconds), command.output);
  if (!summary) return tl::unexpected(summary.error());
  return 0;
}

}  // namespace pingvox::app
