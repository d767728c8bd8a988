#include "io/nav/dvl_a50.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

#include "io/bytes/text.hpp"
#include "nav/internal/nav_frames.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

constexpr std::string_view kNoNumbers = "report without its numbers", kChecksum = "wrong checksum",
                           kNoChecksum = "line without checksum";

/// Reads JSON from the front of a text.
class JsonText {
 public:
  explicit JsonText(std::string_view text) : rest_(text) {}

  bool eat(char c) {
    skip_blanks();
    if (!rest_.starts_with(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }

  /// The text between quotation marks, escapes unchanged.
  std::optional<std::string_view> string() {
    if (!eat('"')) return std::nullopt;
    for (std::size_t i = 0; i < rest_.size(); ++i) {
      if (rest_[i] == '\\') {
        ++i;
      } else if (rest_[i] == '"') {
        return take(i, i + 1);
      }
    }
    return std::nullopt;
  }

  std::optional<std::string_view> value() {
    skip_blanks();
    if (rest_.starts_with('"')) return string();
    const bool has_parts = rest_.starts_with('{') || rest_.starts_with('[');
    if (has_parts) return parts();
    const std::size_t end = std::min(rest_.find_first_of(",]} \t\""), rest_.size());
    if (end == 0) return std::nullopt;
    return take(end, end);
  }

  bool is_at_end() {
    skip_blanks();
    return rest_.empty();
  }

 private:
  /// An object or list, up to the bracket that ends it.
  std::optional<std::string_view> parts() {
    const std::string_view from = rest_;
    std::string open;  // the brackets that are open
    do {
      if (rest_.empty()) return std::nullopt;
      const char c = rest_.front();
      if (c == '"') {
        if (!string()) return std::nullopt;
        continue;
      }
      rest_.remove_prefix(1);
      if (c == '{' || c == '[') open.push_back(c == '{' ? '}' : ']');
      if (c != '}' && c != ']') continue;
      if (open.back() != c) return std::nullopt;
      open.pop_back();
    } while (!open.empty());
    return from.substr(0, from.size() - rest_.size());
  }

  std::string_view take(std::size_t size, std::size_t passed) {
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(passed);
    return taken;
  }

  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r"), rest_.size())); }

  std::string_view rest_;
};

std::string_view value_of(const TextMembers& members, std::string_view name) {
  const auto found = std::ranges::find(members, name, [](const auto& member) { return member.first; });
  return found != members.end() ? found->second : std::string_view();
}

std::optional<Eigen::Vector3d> three(std::string_view x, std::string_view y, std::string_view z) {
  const auto a = number_in(x), b = number_in(y), c = number_in(z);
  if (!a || !b || !c) return std::nullopt;
  return Eigen::Vector3d(*a, *b, *c);
}

/// NaN: there is none.
double deviation_in(std::string_view text) {
  const double deviation = number_in(text).value_or(-1.0);
  return deviation >= 0.0 ? deviation : std::numeric_limits<double>::quiet_NaN();
}

/// What the forms of a velocity report have in common, as text.
struct VelocityText {
  std::string_view x, y, z, deviation, altitude, step_ms, made_us, sent_us;
  bool valid;
};

A50Reading velocity_report(const VelocityText& text) {
  const auto velocity = three(text.x, text.y, text.z);
  if (!velocity) return tl::unexpected(kNoNumbers);
  A50Report report;
  report.kind = A50Report::Kind::kVelocity;
  report.velocity_m_s = *velocity;
  report.valid = text.valid;
  report.deviation = deviation_in(text.deviation);
  report.altitude_m = number_in(text.altitude).value_or(-1.0);
  if (const auto step_ms = number_in(text.step_ms)) report.step_s = *step_ms * 1e-3;
  if (const auto made_us = number_in(text.made_us)) {
    report.made_s = *made_us * 1e-6;
    if (const auto sent_us = number_in(text.sent_us)) report.latency_s = std::max(0.0, (*sent_us - *made_us) * 1e-6);
  }
  return report;
}

/// The same of a position report.
struct PositionText {
  std::string_view time_s, x, y, z, deviation, roll_deg, pitch_deg, yaw_deg, status;
};

A50Reading position_report(const PositionText& text) {
  const auto position_m = three(text.x, text.y, text.z), rpy_deg = three(text.roll_deg, text.pitch_deg, text.yaw_deg);
  if (!position_m || !rpy_deg) return tl::unexpected(kNoNumbers);
  A50Report report;
  report.kind = A50Report::Kind::kPosition;
  report.valid = number_in(text.status).value_or(0.0) == 0.0;
  report.position_m = *position_m;
  report.deviation = deviation_in(text.deviation);
  report.rpy_rad = *rpy_deg * kDegree_rad;
  report.made_s = number_in(text.time_s);
  return report;
}

/// CRC-8 of the serial protocol: polynomial 0x07 from the highest bit on, from 0.
unsigned crc8(std::string_view text) {
  unsigned crc = 0;
  for (const char c : text) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x80U) != 0 ? (crc << 1U ^ 0x07U) & 0xffU : crc << 1U;
  }
  return crc;
}

}  // namespace

std::optional<TextMembers> json_members(std::string_view text) {
  JsonText json(text);
  TextMembers members;
  if (!json.eat('{')) return std::nullopt;
  if (!json.eat('}')) {
    do {
      const auto name = json.string();
      if (!name || !json.eat(':')) return std::nullopt;
      const auto value = json.value();
      if (!value) return std::nullopt;
      members.emplace_back(*name, *value);
    } while (json.eat(','));
    if (!json.eat('}')) return std::nullopt;
  }
  if (!json.is_at_end()) return std::nullopt;
  return members;
}

A50Reading a50_report(const TextMembers& members) {
  const auto text = [&members](std::string_view name) { return value_of(members, name); };
  const auto with_host_clock = [&](A50Report report) {
    report.host_clock_s = number_in(text("timestamp"));
    return report;
  };
  const std::string_view type = text("type"), valid = text("velocity_valid");
  const bool is_velocity = type == "velocity" || (type.empty() && !valid.empty());
  if (is_velocity) {
    return velocity_report({text("vx"), text("vy"), text("vz"), text("fom"), text("altitude"), text("time"),
                            text("time_of_validity"), text("time_of_transmission"),
                            valid == "true" || valid == "True" || valid == "1"})
        .map(with_host_clock);
  }
  if (type == "position_local") {
    return position_report({text("ts"), text("x"), text("y"), text("z"), text("std"), text("roll"), text("pitch"),
                            text("yaw"), text("status")})
        .map(with_host_clock);
  }
  return A50Report{};
}

A50Reading a50_serial_report(std::string_view line) {
  const std::size_t star = line.rfind('*');
  if (!line.starts_with('w')) return tl::unexpected(kNoReport);
  if (star == std::string_view::npos || line.size() != star + 3) return tl::unexpected(kNoChecksum);
  std::string_view rest = line.substr(0, star);
  if (hex_byte_in(line.substr(star + 1)) != crc8(rest)) return tl::unexpected(kChecksum);
  std::vector<std::string_view> fields;
  constexpr std::size_t kMaxFields = 32;
  while (fields.size() < kMaxFields) {
    const auto field = cut_field(rest, ',');
    if (!field) break;
    fields.push_back(*field);
  }
  const std::string_view name = fields.front();
  const auto has = [&](std::string_view wanted, std::size_t count) { return name == wanted && fields.size() == count; };
  // Velocity over ground; that through the water (wrs) is no displacement.
  if (has("wrz", 12)) {
    return velocity_report(
        {fields[1], fields[2], fields[3], fields[6], fields[5], fields[10], fields[8], fields[9], fields[4] == "y"});
  }
  if (has("wrx", 9)) {
    A50Reading report =
        velocity_report({fields[2], fields[3], fields[4], fields[5], fields[6], fields[1], {}, {}, fields[7] == "y"});
    if (report) report->is_deprecated = true;
    return report;
  }
  if (has("wrp", 10)) {
    return position_report(
        {fields[1], fields[2], fields[3], fields[4], fields[5], fields[6], fields[7], fields[8], fields[9]});
  }
  const bool is_short = name == "wrz" || name == "wrx" || name == "wrp";
  if (is_short) return tl::unexpected(kNoNumbers);
  return A50Report{};
}

void add_a50_report(NavSources& sources, const std::string& name, double time_s, const A50Report& report) {
  const bool is_reckoned = report.kind == A50Report::Kind::kPosition;
  const NavOrigin origin{
      .subject = NavSubject::kVehicle, .frame = std::string(is_reckoned ? kStartFrame : ""), .child = {}};
  const auto add = [&](NavQuantity quantity, const Eigen::Vector3d& value, bool valid) {
    NavSample sample;
    sample.time_s = time_s;
    sample.value = value;
    sample.valid = valid;
    return sources.add(name, quantity, sample, origin);
  };
  if (report.kind == A50Report::Kind::kVelocity) {
    NavSample* const velocity = add(NavQuantity::kVelocity, from_ned::body(report.velocity_m_s), report.valid);
    if (velocity != nullptr) velocity->deviation.setConstant(report.deviation);
    add(NavQuantity::kRange, {report.altitude_m, 0.0, 0.0}, report.valid && report.altitude_m > 0.0);
  }
  if (report.kind == A50Report::Kind::kPosition) {
    NavSample* const position = add(NavQuantity::kPosition, from_ned::world(report.position_m), report.valid);
    if (position != nullptr) position->deviation.setConstant(report.deviation);
    add(NavQuantity::kAttitude, from_ned::attitude(report.rpy_rad), report.valid);
  }
}

}  // namespace pingvox
