#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "io/internal/json.hpp"
#include "map_report.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "open_recording.hpp"
#include "option_names.hpp"
#include "option_values.hpp"
#include "origin_fix.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/grids.hpp"
#include "pingvox/io/png.hpp"
#include "pingvox/recording/map_origin.hpp"
#include "pingvox/viewer/render_mosaic.hpp"
#include "progress.hpp"
#include "recording_report.hpp"
#include "recording_warnings.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

/// The fix at 0, 0; nullopt: the picture stays in metres.
Result<std::optional<Eigen::Vector3d>> origin_fix_of(const MosaicCommand& command, const Recording& recording,
                                                     const VehiclePath& path) {
  if (command.format != Format::kTif) return std::nullopt;
  std::optional<MapOrigin> origin;
  if (path.nav) origin = map_origin(path, recording.nav().log, recording.nav_offset()->offset_s);
  if (!command.fix) return origin ? std::optional(origin->fix) : std::nullopt;
  if (path.axes == MapAxes::kRightAhead) {
    return usage_error("--origin: x and y are right and ahead of the vehicle at the start, not east and north");
  }
  if (origin) {
    return usage_error(fmt::format("--origin: by the fixes of {}, 0, 0 is at {:.7f},{:.7f}", recording.nav_names(),
                                   origin->fix.x() / kDegree_rad, origin->fix.y() / kDegree_rad));
  }
  return command.fix;
}

Result<void> write_picture(const RecordingMosaic& made, const std::optional<Eigen::Vector3d>& origin_fix,
                           const VehiclePath& path, const MosaicCommand& command) {
  if (command.format == Format::kTif) {
    return write_file(command.output, [&](std::ostream& out) {
      return write_geotiff(made.picture, origin_fix, "sonar intensity, 0 to 255", out);
    });
  }
  const bool stands_still = path.trajectory.poses().size() == 1;
  const PictureUp up = command.up.value_or(stands_still ? PictureUp::kX : PictureUp::kY);
  const GreyPicture picture = render_mosaic(made.picture, up, command.gamma);
  Result<void> written = write_file(command.output, [&](std::ostream& out) {
    return write_grey_png(picture.width, picture.height, picture.grey_alpha, out);
  });
  if (!written || command.output == "-") return written;
  return write_file(world_file(command.output),
                    [&](std::ostream& out) { return write_world_file(made.picture, up, out); });
}

/// The corners of a picture, at height 0.
Box box_of(const Raster<float>& picture) {
  const Eigen::Vector2d size_m(static_cast<double>(picture.columns), static_cast<double>(picture.rows));
  const Eigen::Vector2d high_m = picture.corner_m + picture.cell_m * size_m;
  return {{picture.corner_m.x(), picture.corner_m.y(), 0.0}, {high_m.x(), high_m.y(), 0.0}};
}

std::size_t heard_pixels(const Raster<float>& picture) {
  const auto is_heard = [](float intensity) { return !std::isnan(intensity); };
  return static_cast<std::size_t>(std::ranges::count_if(picture.values, is_heard));
}

std::string mosaic_json(const RecordingMosaic& made, const std::optional<Eigen::Vector3d>& origin_fix,
                        const Recording& recording, const VehiclePath& path, const MosaicCommand& command,
                        double total_s) {
  std::size_t damaged = 0;
  for (const MappedLog& log : made.logs) damaged += log.damaged;
  JsonObject skipped_for, picture, bounds, json;
  skipped_for.add("damage", damaged).add("no_pose", made.report.no_pose.count);
  const Box box = box_of(made.picture);
  const std::array low = {box.min.x(), box.min.y()}, high = {box.max.x(), box.max.y()};
  bounds.add("min", std::span<const double>(low)).add("max", std::span<const double>(high));
  picture.add("columns", made.picture.columns)
      .add("rows", made.picture.rows)
      .add("resolution", made.picture.cell_m)
      .add("heard_pixels", heard_pixels(made.picture))
      .add("bounds", bounds);
  json.add("beams", made.report.beams)
      .add("skipped", made.report.skipped)
      .add("skipped_for", skipped_for)
      .add("picture", picture)
      .add("resolution_from", resolution_json(made.forecast, {.resolution_m = command.mosaic.resolution_m}));
  if (origin_fix) {
    JsonObject origin;
    origin.add("latitude_deg", origin_fix->x() / kDegree_rad).add("longitude_deg", origin_fix->y() / kDegree_rad);
    json.add("origin", origin);
  } else {
    json.add_null("origin");
  }
  if (path.nav) {
    JsonObject nav;
    nav.add("attitude", path.nav->attitude)
        .add("position", path.nav->position)
        .add("velocity", path.nav->velocity)
        .add("clock", json_of(*recording.nav_offset()))
        .add("frame", frame_text(path));
    json.add("nav", nav);
  }
  return json.add("seconds", JsonObject().add("total", round_to_us(total_s))).text() + "\n";
}

std::string pixel_text(const RecordingMosaic& made, const MosaicCommand& command) {
  std::string pixel = fmt::format("{:.6g} m", made.picture.cell_m);
  if (command.mosaic.resolution_m) return pixel;
  return fmt::format("{}, half a cell of a map: {}", pixel, resolution_text(made.forecast, {}));
}

std::string mosaic_text(const RecordingMosaic& made, const std::optional<Eigen::Vector3d>& origin_fix,
                        const Recording& recording, const VehiclePath& path, const MosaicCommand& command) {
  const Raster<float>& picture = made.picture;
  const Box box = box_of(picture);
  return fmt::format("{}: {} x {} pixels of {:.6g} m{}\n", command.output == "-" ? "standard output" : command.output,
                     picture.columns, picture.rows, picture.cell_m,
                     command.format == Format::kTif ? place_text(origin_fix, path.axes) : "") +
         report_line("read", counted(made.report.beams, "beam")) +
         (path.nav ? report_line("nav", nav_text(path, recording.nav().damaged)) + others_line(path.nav->others) +
                         report_line("nav clock", app::text_of(*recording.nav_offset(), std::nullopt)) +
                         report_line("frame", frame_text(path)) + mount_line(command.recording)
                   : "") +
         report_line("bounds", fmt::format("{:.6g} {:.6g} .. {:.6g} {:.6g} m", box.min.x(), box.min.y(), box.max.x(),
                                           box.max.y())) +
         report_line("resolution", pixel_text(made, command));
}

/// What is odd about the logs.
void say_doubts(const RecordingMosaic& made, const Recording& recording, const VehiclePath& path,
                const Console& console) {
  const Lattice lattice(made.picture.cell_m);
  for (std::size_t i = 0; i < made.logs.size(); ++i) {
    const MappedLog& log = made.logs[i];
    for (const std::string& warning : warnings_of(recording, path, log, lattice)) console.say(warning);
    const std::string still = still_vehicle_text(recording.logs()[i], recording.options());
    if (!still.empty()) console.say(still);
  }
}

}  // namespace

Result<int> run(const MosaicCommand& typed, Console& console) {
  const Stopwatch total;
  MosaicCommand command = typed;
  if (const auto found = expand_folders(command.recording.logs, console); !found) return tl::unexpected(found.error());
  const Result<OpenedRecording> opened = open_with_path(command.recording);
  if (!opened) return tl::unexpected(opened.error());
  const auto& [recording, path] = *opened;
  const auto origin_fix = origin_fix_of(command, recording, path);
  if (!origin_fix) return tl::unexpected(origin_fix.error());
  for (const std::string& warning : warnings_of(recording, path)) console.say(warning);
  ProgressBar bar(command.output_options);
  const Result<RecordingMosaic> made = mosaic(recording, path, command.mosaic, [&](const BuildReport& report) {
    if (bar.is_due()) bar.draw(std::nullopt, counted(report.beams, "beam"));
  });
  bar.clear();
  if (!made) return fail(made.error().code, with_option_names(made.error().message));
  if (const auto written = write_picture(*made, *origin_fix, path, command); !written) {
    return tl::unexpected(written.error());
  }
  say_doubts(*made, recording, path, console);
  const Result<void> printed =
      command.output_options.report == Report::kJson
          ? console.print(mosaic_json(*made, *origin_fix, recording, path, command, total.seconds()))
          : console.summarise(mosaic_text(*made, *origin_fix, recording, path, command), command.output);
  if (!printed) return tl::unexpected(printed.error());
  return 0;
}

}  // namespace pingvox::app
