#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"
#include "io/nav/nav_readers.hpp"
#include "io/nav/nav_sources.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"

// Text logs of the vehicle Ictineu (docs/formats.md): DVL, MTi or DGPS, told by the comment that names the columns.
namespace pingvox {
namespace {

/// How the instruments stand in the vehicle: clockwise from ahead, seen from above.
constexpr double kDvlYaw_rad = 60.0 * kDegree_rad, kMtiYaw_rad = 86.0 * kDegree_rad;

enum class Log { kDvl, kMti, kDgps };

bool is_comment(std::string_view line) {
  return line.starts_with('%');
}

/// By the comments before the first row.
std::optional<Log> log_in(std::string_view text) {
  Lines lines(text);
  while (const auto line = lines.next_with_content()) {
    if (!is_comment(*line)) return std::nullopt;
    const auto names = [&](std::string_view column) { return line->find(column) != std::string_view::npos; };
    if (names("bottomVelX") && names("pressure")) return Log::kDvl;
    if (names("accelerationX") && names("velocityX")) return Log::kMti;
    if (names("latitude") && names("longitude") && names("altitude")) return Log::kDgps;
  }
  return std::nullopt;
}

std::size_t columns_of(Log log) {
  return log == Log::kDvl ? 32 : 10;
}

/// nullopt: not so many finite numbers.
std::optional<std::vector<double>> row_in(std::string_view line, std::size_t columns) {
  std::vector<double> row;
  while (const auto word = cut_word(line)) {
    const auto number = number_in(*word);
    if (!number || row.size() == columns) return std::nullopt;
    row.push_back(*number);
  }
  if (row.size() != columns) return std::nullopt;
  return row;
}

NavSample sample_at(double time_s, const Eigen::Vector3d& value, NavSample sample = {}) {
  sample.time_s = time_s;
  sample.value = value;
  return sample;
}

void add_dvl(NavSources& sources, const std::vector<double>& row) {
  // Ahead, left and up of the instrument, in cm/s; a velocity of 327 m/s marks an invalid one.
  const Eigen::Vector3d velocity_cm_s(row[11], row[12], row[13]);
  NavSample velocity;
  velocity.valid = row[14] != 0.0 && velocity_cm_s.cwiseAbs().maxCoeff() < 32767.0;
  const Eigen::AngleAxisd body_from_dvl(-kDvlYaw_rad, Eigen::Vector3d::UnitZ());
  sources.add("DVL", NavQuantity::kVelocity, sample_at(row[0], body_from_dvl * velocity_cm_s / 100.0, velocity));
  sources.add("DVL", NavQuantity::kHeading,
              sample_at(row[0], {from_ned::yaw(row[22] * kDegree_rad - kDvlYaw_rad), 0.0, 0.0}));
  sources.add("DVL", NavQuantity::kTemperature, sample_at(row[0], {row[25], 0.0, 0.0}));
  constexpr double kMetresOfCount = 0.00377225, kSurfaceCount = 1440.0;
  sources.add("DVL", NavQuantity::kDepth, sample_at(row[0], {kMetresOfCount * (row[26] - kSurfaceCount), 0.0, 0.0}));
}

void add_mti(NavSources& sources, const std::vector<double>& row) {
  // Forward, right and down of the instrument, of which forward is 86 degrees right of the vehicle's.
  const Eigen::Matrix3d ned_from_mti =
      pose_from_rpy(Eigen::Vector3d::Zero(), row[1] * kDegree_rad, row[2] * kDegree_rad, row[3] * kDegree_rad).linear();
  const Eigen::Matrix3d body_from_mti = Eigen::AngleAxisd(kMtiYaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d attitude = rpy_of(ned_from_mti * body_from_mti.transpose());
  sources.add("MTi", NavQuantity::kAttitude, sample_at(row[0], from_ned::attitude(attitude)));
  sources.add("MTi", NavQuantity::kTurnRate,
              sample_at(row[0], from_ned::body(body_from_mti * Eigen::Vector3d(row[4], row[5], row[6]))));
}

/// Whether it is a place on the earth.
bool add_dgps(NavSources& sources, const std::vector<double>& row) {
  const Eigen::Vector3d fix(angle_of_degrees_minutes(row[1]), angle_of_degrees_minutes(row[2]), row[4]);
  if (std::fabs(fix.x()) > std::numbers::pi / 2.0 || std::fabs(fix.y()) > std::numbers::pi) return false;
  NavSample sample;
  sample.valid = row[3] != 0.0;
  sources.add("DGPS", NavQuantity::kFix, sample_at(row[0], fix, sample));
  return true;
}

}  // namespace

bool looks_like_ictineu(std::span<const std::uint8_t> bytes) {
  return log_in(text_of(bytes)).has_value();
}

NavReading read_ictineu(std::span<const std::uint8_t> bytes) {
  NavReading reading;
  const std::string_view text = text_of(bytes);
  const std::optional<Log> log = log_in(text);
  if (!log) return reading;
  NavSources sources;
  Lines lines(text);
  for (std::size_t at = 0; const auto line = lines.next_with_content(); at = text.size() - lines.left()) {
    if (is_comment(*line)) continue;
    const auto row = row_in(*line, columns_of(*log));
    const bool is_sample = row && (*log != Log::kDgps || add_dgps(sources, *row));
    if (!is_sample) {
      add_damage(reading.damage, "line that is not a sample", at);
      continue;
    }
    if (*log == Log::kDvl) add_dvl(sources, *row);
    if (*log == Log::kMti) add_mti(sources, *row);
    ++reading.records;
  }
  reading.sources = sources.take();
  return reading;
}

}  // namespace pingvox
