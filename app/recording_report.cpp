#include "recording_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "map_report.hpp"
#include "nav_report.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox::app {

std::string nav_text(const VehiclePath& path, std::size_t damaged) {
  assert(path.nav);
  std::string text =
      fmt::format("{} from {}", counted(path.trajectory.poses().size(), "pose"), nav_sources_text(*path.nav));
  if (const std::size_t gaps = path.trajectory.gaps(); gaps > 0) {
    text += ", " + counted(gaps, "gap");
  }
  if (damaged > 0) text += fmt::format("; skipped {}", counted(damaged, "damaged record"));
  return text;
}

namespace {

bool follows_log(const MapForecast& forecast, const MapOptions& asked) {
  return !asked.resolution_m && forecast.range_m;
}

/// "40 s", "5 minutes", "2.1 hours"
std::string about_text(double seconds) {
  constexpr double kMinute_s = 60.0, kHour_s = 3600.0;
  if (seconds < 2.0 * kMinute_s) return fmt::format("{:.0f} s", seconds);
  if (seconds < 2.0 * kHour_s) return fmt::format("{:.0f} minutes", seconds / kMinute_s);
  return fmt::format("{:.1f} hours", seconds / kHour_s);
}

}  // namespace

std::string resolution_text(const MapForecast& forecast, const MapOptions& asked) {
  std::string text = fmt::format("{} m", forecast.resolution_m);
  if (follows_log(forecast, asked)) {
    text += fmt::format(", by a range of {:.3g} m and a beam {:.3g} degrees wide", *forecast.range_m,
                        rounded_degrees(forecast.beam_width_rad));
  }
  return text;
}

JsonObject resolution_json(const MapForecast& forecast, const MapOptions& asked) {
  JsonObject json;
  if (!follows_log(forecast, asked)) return json.add_null("range_m").add_null("beam_width_deg");
  return json.add("range_m", *forecast.range_m).add("beam_width_deg", rounded_degrees(forecast.beam_width_rad));
}

std::string cost_text(const MapForecast& forecast) {
  constexpr double kLong_s = 30.0, kMuch_bytes = 2e9;
  const auto& cost = forecast.cost;
  if (!cost || (cost->seconds < kLong_s && cost->bytes < kMuch_bytes)) return {};
  return fmt::format(
      "{:.0f} beams of {:.3g} m in cells of {} m may take up to {} and {}; cells of twice the size (--resolution {}) "
      "take an eighth of it",
      cost->beams, forecast.range_m.value_or(0.0), forecast.resolution_m, about_text(cost->seconds),
      bytes_text(static_cast<std::size_t>(cost->bytes)), 2.0 * forecast.resolution_m);
}

std::string frame_text(const VehiclePath& path) {
  assert(path.nav);
  const VehiclePath::Nav& nav = *path.nav;
  if (nav.position.empty()) return frame_text(nav.attitude);
  if (!nav.origin_fix) {
    const std::string note = nav.frame_note.empty() ? "" : ": " + nav.frame_note;
    if (path.axes == MapAxes::kRightAhead) {
      return on_one_line(
          fmt::format("origin where {} began; x right, y ahead of the vehicle at that time{}", nav.position, note));
    }
    if (!nav.north_by.empty()) {
      return on_one_line(
          fmt::format("origin where {} began; x east, y north by {}{}", nav.position, nav.north_by, note));
    }
    return on_one_line(fmt::format("origin and axes are those of {}{}", nav.position, note));
  }
  return fmt::format("x east, y north of latitude {:.7f}, longitude {:.7f} degrees", nav.origin_fix->x() / kDegree_rad,
                     nav.origin_fix->y() / kDegree_rad);
}

std::string frame_text(const RecordingSlam& slam) {
  const std::string& heading = slam.solution.report.heading;
  if (!slam.frame_of || (slam.frame_of->position.empty() && !slam.frame_of->origin_fix)) return frame_text(heading);
  VehiclePath path = still_path();
  path.nav = slam.frame_of;
  path.axes = MapAxes::kEastNorth;
  const std::string text = frame_text(path);
  return path.nav->north_by == heading ? text : fmt::format("{}; north by {}", text, on_one_line(heading));
}

std::string frame_text(std::string_view heading) {
  return fmt::format("origin at the first pose; x east, y north by {}", on_one_line(heading));
}

Result<void> check_ranges(const BuildOptions& options) {
  const double nearest_m = options.echo.min_range_m.value_or(0.0);
  if (options.echo.max_range_m > nearest_m) return {};
  return fail(Error::Code::kBadOption,
              fmt::format("--max-range: must be above --min-range ({:.6g} m{}), is {:.6g} m", nearest_m,
                          nearest_m == EchoOptions::kDefaultBlanking_m ? " by default" : "", options.echo.max_range_m));
}

Result<void> check_reach(const Recording& recording, const VehiclePath& path, const Lattice& lattice) {
  constexpr int kMaxDepth = 32;
  constexpr double kKilometre_m = 1000.0;
  const double reach_m = std::ldexp(lattice.resolution_m(), lattice.depth() - 1);
  const auto is_outside = [&](const StampedPose& pose) {
    return pose.map_from_body.translation().cwiseAbs().maxCoeff() > reach_m;
  };
  const auto& poses = path.trajectory.poses();
  if (poses.empty() || !std::ranges::all_of(poses, is_outside)) return {};
  const std::string name = recording.options().poses ? recording.options().poses->name() : recording.nav_names();
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: the poses are {:.6g} km from the origin, and the map reaches {:.6g} km: {}make them "
                          "relative to a place near the dive",
                          name, poses.front().map_from_body.translation().norm() / kKilometre_m, reach_m / kKilometre_m,
                          lattice.depth() < kMaxDepth ? "use --depth 32 with -o FILE.pvx, or " : ""));
}

std::string text_of_nothing(const std::string& name, const std::string& skipped) {
  return fmt::format("{}: nothing could be mapped: {}", name, skipped.empty() ? "it is empty" : skipped);
}

Result<void> say_nothing_mapped(const std::vector<std::string>& texts, std::size_t logs, Console& console) {
  if (texts.size() == logs) return fail(Error::Code::kCorrupt, texts.front());
  for (const std::string& text : texts) console.say(text);
  return {};
}

}  // namespace pingvox::app
