#include "pingvox/io/geojson.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "io/bytes/date.hpp"
#include "io/internal/json.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox {
namespace {

/// "2017-11-02T08:58:46.723Z" (RFC 3339); nullopt: before 1970 or after 9999.
std::optional<std::string> date_of(double unix_s) {
  constexpr double kAfter9999_s = 253402300800.0, kMilliseconds = 1e3;
  if (!(unix_s >= 0.0 && unix_s < kAfter9999_s)) return std::nullopt;
  std::string text = date_time_text(static_cast<std::uint64_t>(unix_s * kMilliseconds));
  constexpr std::string_view kForm = "0000-00-00T00:00:00.000Z";
  text.push_back('Z');
  for (std::size_t at = 0; at < kForm.size(); ++at) {
    if (kForm[at] != '0') text[at] = kForm[at];
  }
  return text;
}

/// [longitude,latitude] in degrees, to a tenth of a millimetre.
std::string coordinates_of_fix(const Eigen::Vector3d& fix) {
  return fmt::format("[{:.9f},{:.9f}]", fix.y() / kDegree_rad, fix.x() / kDegree_rad);
}

std::string feature(std::string_view type, std::string_view coordinates, const JsonObject& properties) {
  return fmt::format(R"({{"type":"Feature","geometry":{{"type":"{}","coordinates":{}}},"properties":{}}})", type,
                     coordinates, properties.text());
}

/// Standard deviations east, north and up [m] at a time, between the samples around it; nullopt: not known.
std::optional<Eigen::Vector3d> deviation_at(const NavSource& positions, double time_s) {
  const auto in_metres = [&](const NavSample& sample) -> Eigen::Vector3d {
    if (positions.quantity != NavQuantity::kFix) return sample.deviation;
    return position_of_fix(sample.value + sample.deviation, sample.value);
  };
  const auto after = std::ranges::lower_bound(positions.samples, time_s, {}, &NavSample::time_s);
  if (after == positions.samples.end()) return std::nullopt;
  Eigen::Vector3d deviation_m = in_metres(*after);
  if (after != positions.samples.begin() && after->time_s > time_s) {
    const NavSample& before = *std::prev(after);
    const double share = (time_s - before.time_s) / (after->time_s - before.time_s);
    deviation_m = (1.0 - share) * in_metres(before) + share * deviation_m;
  }
  return deviation_m.head<2>().allFinite() ? std::optional(deviation_m) : std::nullopt;
}

JsonObject properties_of(const StampedPose& pose, const GeoJsonOptions& options) {
  JsonObject properties;
  properties.add("time_s", pose.time_s);
  if (options.clock == NavClock::kUnix) {
    if (const auto date = date_of(pose.time_s)) properties.add("time", *date);
  }
  const Eigen::Vector3d at_m = pose.map_from_body.translation();
  properties.add("x_m", at_m.x()).add("y_m", at_m.y()).add("z_m", at_m.z());
  if (options.has_attitude) {
    constexpr double kTurn_deg = 360.0, kNorth_deg = 90.0;
    const Eigen::Vector3d ahead = pose.map_from_body.rotation().col(0);
    const double heading_deg = kNorth_deg - std::atan2(ahead.y(), ahead.x()) / kDegree_rad;
    properties.add("heading_deg", heading_deg < 0.0 ? heading_deg + kTurn_deg : heading_deg);
  }
  const auto deviation_m = options.positions != nullptr ? deviation_at(*options.positions, pose.time_s) : std::nullopt;
  if (deviation_m) {
    properties.add("deviation_east_m", deviation_m->x()).add("deviation_north_m", deviation_m->y());
    if (std::isfinite(deviation_m->z())) properties.add("deviation_up_m", deviation_m->z());
  }
  return properties;
}

}  // namespace

Result<std::size_t> write_geojson(const Trajectory& map_from_body, const GeoJsonOptions& options, std::ostream& out) {
  const std::vector<StampedPose>& poses = map_from_body.poses();
  const auto fix_of = [&](const StampedPose& pose) {
    return fix_of_position(pose.map_from_body.translation(), options.origin_fix);
  };
  // A line also ends where it would cross the longitude of 180 degrees.
  const auto is_cut = [&](std::size_t after) {
    return poses[after].time_s - poses[after - 1].time_s > map_from_body.longest_step_s() ||
           std::ranges::binary_search(map_from_body.cuts(), after) ||
           std::fabs(fix_of(poses[after]).y() - fix_of(poses[after - 1]).y()) > std::numbers::pi;
  };
  out << "{\"type\":\"FeatureCollection\",\"features\":[\n";
  for (std::size_t first = 0, end = 1; first < poses.size(); first = end, ++end) {
    while (end < poses.size() && !is_cut(end)) ++end;
    if (end - first < 2) continue;
    std::string line;
    for (std::size_t i = first; i < end; ++i) line += (i > first ? "," : "") + coordinates_of_fix(fix_of(poses[i]));
    JsonObject properties;
    properties.add("name", options.name).add("from_s", poses[first].time_s).add("to_s", poses[end - 1].time_s);
    out << feature("LineString", "[" + line + "]", properties) << ",\n";
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    out << feature("Point", coordinates_of_fix(fix_of(poses[i])), properties_of(poses[i], options))
        << (i + 1 < poses.size() ? ",\n" : "\n");
  }
  out << "]}\n";
  if (!out.flush()) return fail(Error::Code::kIo, "the path could not be written");
  return poses.size();
}

}  // namespace pingvox
