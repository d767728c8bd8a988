#include "map_log.hpp"

#include <fmt/core.h>

#include <limits>
#include <string_view>

#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/tum.hpp"

namespace pingvox::app {
namespace {

Result<BuildReport> build(const Log& log, const Trajectory& trajectory, const BuildOptions& options,
                          const HeadWords& head, OccupancyMap& map, const Progress& progress) {
  if (const auto* beams = std::get_if<std::unique_ptr<BeamSource>>(&log)) {
    // Scans of points have no blanking range.
    if (const auto ranges = check_ranges(options); !ranges) return tl::unexpected(ranges.error());
    return build_map(**beams, trajectory, head.applied_to(options, (*beams)->device()), map, progress);
  }
  return build_map(*std::get<std::unique_ptr<ScanSource>>(log), options, map, progress);
}

}  // namespace

Result<Trajectory> trajectory_of(const std::optional<std::string>& poses) {
  if (!poses) return Trajectory::still(Pose::Identity());
  const Result<FileBytes> file = read_file(*poses);
  if (!file) return tl::unexpected(file.error());
  Result<Trajectory> trajectory = read_tum(*file);
  if (trajectory) return trajectory;
  // A damaged trajectory may be taken for points as text.
  const std::optional<Format> format = format_of(file->view());
  if (!format || *format == Format::kTum || *format == Format::kXyz) return trajectory;
  return fail(Error::Code::kUnsupported, fmt::format("{}: is {}, not a trajectory", file->name, described(*format)));
}

Result<void> check_ranges(const BuildOptions& options) {
  const double nearest_m = options.echo.min_range_m.value_or(0.0);
  if (options.echo.max_range_m > nearest_m) return {};
  return fail(
      Error::Code::kBadOption,
      fmt::format("--max-range: must be above --min-range, which is {:.6g} m{}, is {:.6g} m", nearest_m,
                  nearest_m == EchoOptions::kUsualBlanking_m ? " when it is not given" : "", options.echo.max_range_m));
}

Result<BuildReport> map_log(const Log& log, const std::string& name, const Trajectory& trajectory,
                            const BuildOptions& options, const HeadWords& head, OccupancyMap& map,
                            const Progress& progress) {
  Result<BuildReport> report = build(log, trajectory, options, head, map, progress);
  if (!report) {
    // Errors of the map itself name no file; those of options need none.
    const Error::Code code = report.error().code;
    if (code != Error::Code::kLimit && code != Error::Code::kNoMemory) return report;
    return fail(code, fmt::format("{}: {}", name, report.error().message));
  }
  if (report->beams == 0) {
    const bool stood_still = trajectory.at(std::numeric_limits<double>::lowest()).has_value();
    const std::string_view hint = stood_still ? "" : "; do the times of the poses fit?";
    return fail(Error::Code::kCorrupt,
                fmt::format("{}: nothing in it could be mapped ({} left out{})", name, report->skipped, hint));
  }
  return report;
}

}  // namespace pingvox::app
