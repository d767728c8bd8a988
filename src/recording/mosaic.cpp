#include "pingvox/recording/mosaic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "base/option_errors.hpp"
#include "mapping/internal/option_limits.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/sonar/background.hpp"

namespace pingvox {
namespace {

MosaicOptions mosaic_options(const RecordingMosaicOptions& options, double resolution_m) {
  return {.resolution_m = resolution_m,
          .blend = options.blend,
          .min_range_m = options.min_range_m,
          .max_range_m = options.max_range_m};
}

/// The angle between two beams, one after another. nullopt: so large that the head does not step but jump.
std::optional<double> step_between(double from_rad, double to_rad) {
  constexpr double kCoarsest_rad = 12.0 * kDegree_rad;
  const double step_rad = std::abs(std::remainder(to_rad - from_rad, 2.0 * std::numbers::pi));
  return step_rad <= kCoarsest_rad ? std::optional(step_rad) : std::nullopt;
}

/// Draws a log, to its end.
Result<MappedLog> draw_log(const Recording& recording, OpenedLog log, const VehiclePath& path, double sound_speed_ratio,
                           Mosaic& picture, const Progress& progress) {
  MappedLog drawn;
  drawn.name = log.name;
  Result<std::unique_ptr<BeamSource>> beams = only_beams(std::move(log.log), drawn.name);
  if (!beams) return tl::unexpected(beams.error());
  if (path.nav) {
    if (const auto has = check_has_times(**beams, drawn.name); !has) return tl::unexpected(has.error());
  }
  const RecordingOptions& of = recording.options();
  const DeviceProfile* const device = (*beams)->device();
  drawn.beam = of.head.apply_to({}, device);
  drawn.assumes_beam = of.head.assumes_beam(device);
  Pose body_from_head = of.body_from_sonar;
  body_from_head.pretranslate(path.sonar_moved_m);
  BuildReport& report = drawn.report;
  std::optional<double> last_rad;
  for (;;) {
    Result<std::optional<Beam>> next = (*beams)->next();
    if (!next) return tl::unexpected(next.error());
    if (!*next) break;
    Beam& beam = **next;
    beam.bin_length_m *= sound_speed_ratio;
    report.first_s = std::min(report.first_s.value_or(beam.time_s), beam.time_s);
    report.last_s = std::max(report.last_s.value_or(beam.time_s), beam.time_s);
    const std::optional<double> before_rad = std::exchange(last_rad, beam.bearing_rad);
    if (const std::optional<Pose> map_from_body = path.trajectory.at(beam.time_s)) {
      const BeamExtent extent{.width_rad = drawn.beam.width_rad,
                              .height_rad = drawn.beam.height_rad,
                              .step_rad = before_rad ? step_between(*before_rad, beam.bearing_rad) : std::nullopt};
      if (const auto added = picture.add(*map_from_body * body_from_head, beam, extent); !added) {
        return fail(added.error().code, fmt::format("{}: {}", drawn.name, added.error().message));
      }
      ++report.beams;
    } else {
      report.no_pose.add(beam.time_s);
    }
    report.skipped = report.no_pose.count + (*beams)->skipped();
    if (progress) progress(report);
  }
  report.skipped = report.no_pose.count + (*beams)->skipped();
  drawn.damaged = (*beams)->skipped();
  drawn.first_damage = (*beams)->first_damage();
  drawn.note = (*beams)->note();
  return drawn;
}

/// Why nothing of a recording can be seen.
std::string why_empty(const MappedLog& log, const VehiclePath& path) {
  const auto& poses = path.trajectory.poses();
  std::string text;
  if (log.report.no_pose.count > 0) {
    text = fmt::format("{} outside the time of the poses, {:.3f} s to {:.3f} s{}", log.report.no_pose.count,
                       poses.front().time_s, poses.back().time_s,
                       path.trajectory.gaps() > 0 ? ", or in one of their gaps" : "");
  }
  if (log.damaged > 0) {
    text += fmt::format("{}{} damaged, the first: {}", text.empty() ? "" : "; ", log.damaged, log.first_damage);
  }
  if (!text.empty()) return text;
  return log.report.beams == 0 ? "it is empty" : "no bin of its beams is within min_range_m and max_range_m";
}

}  // namespace

Result<void> RecordingMosaicOptions::validate() const {
  OptionErrors errors;
  errors.add(mosaic_options(*this, resolution_m.value_or(MosaicOptions{}.resolution_m)).validate());
  errors.require("sound_speed_ratio", sound_speed_ratio, kSoundSpeedRatios);
  return errors.result("recording");
}

Result<RecordingMosaic> mosaic(const Recording& recording, const VehiclePath& path,
                               const RecordingMosaicOptions& options, const Progress& progress) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  BuildOptions build;
  build.echo.max_range_m = options.max_range_m;
  Result<MapForecast> forecast = forecast_map(recording, {.resolution_m = options.resolution_m}, build);
  if (!forecast) return tl::unexpected(forecast.error());
  // A pixel costs less than a cell: half its size keeps the detail of the beams.
  const double pixel_m = options.resolution_m.value_or(0.5 * forecast->resolution_m);
  Result<Mosaic> picture = Mosaic::make(mosaic_options(options, pixel_m));
  if (!picture) return tl::unexpected(picture.error());
  const double ratio = recording.water() ? sound_speed_ratio(*recording.water()) : options.sound_speed_ratio;
  RecordingMosaic made{.picture = {}, .forecast = *std::move(forecast), .report = {}, .logs = {}};
  std::optional<Background> background;
  for (std::size_t i = 0; i < recording.logs().size(); ++i) {
    auto opened = made.forecast.opened.extract(i);
    Result<OpenedLog> log = opened ? std::move(opened.mapped()) : recording.open_log(i);
    if (!log) return tl::unexpected(log.error());
    if (const auto done = subtract_background(recording, *log, background); !done) return tl::unexpected(done.error());
    Result<MappedLog> drawn = draw_log(recording, *std::move(log), path, ratio, *picture, progress);
    if (!drawn) return tl::unexpected(drawn.error());
    add(drawn->report, made.report);
    made.logs.push_back(*std::move(drawn));
  }
  if (picture->empty()) {
    const MappedLog& first = made.logs.front();
    return fail(Error::Code::kCorrupt, fmt::format("{}: nothing can be drawn: {}", first.name, why_empty(first, path)));
  }
  Result<Raster<float>> raster = picture->picture();
  if (!raster) return tl::unexpected(raster.error());
  made.picture = *std::move(raster);
  return made;
}

}  // namespace pingvox
