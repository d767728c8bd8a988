#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "io/nav/nav_sources.hpp"

// The reports of Water Linked's DVLs A50 and A125 (docs/formats.md).
namespace pingvox {

struct A50Report {
  enum class Kind { kVelocity, kPosition, kOther };
  Kind kind = Kind::kOther;
  bool valid = false;
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();       ///< forward, right, down
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();         ///< by dead reckoning, in its axes at the last reset
  Eigen::Vector3d rpy_rad = Eigen::Vector3d::Zero();            ///< since then
  double altitude_m = -1.0;                                     ///< along its axis; not above 0: none
  double deviation = std::numeric_limits<double>::quiet_NaN();  ///< of the velocity [m/s] or the position [m]
  bool is_deprecated = false;          ///< a form that devices send besides the one that replaces it
  std::optional<double> step_s;        ///< since the report before
  std::optional<double> made_s;        ///< when it was true, on the device's clock
  double latency_s = 0.0;              ///< from then until it was sent
  std::optional<double> host_clock_s;  ///< when it was received, since 1970
};

/// Names and values as they are written, without the quotation marks of strings.
using TextMembers = std::vector<std::pair<std::string_view, std::string_view>>;
/// The members of a JSON object; those of inner objects and lists stay one value. nullopt: `text` is none.
std::optional<TextMembers> json_members(std::string_view text);

/// The error is the kind of damage.
inline constexpr std::string_view kNoReport = "line that is not a report";
using A50Reading = tl::expected<A50Report, std::string_view>;
/// A line of JSON, or of a table of the same names.
A50Reading a50_report(const TextMembers& members);
/// A line of the serial protocol.
A50Reading a50_serial_report(std::string_view line);

/// Adds what a report says as samples of `name` at `time_s`.
void add_a50_report(NavSources& sources, const std::string& name, double time_s, const A50Report& report);

}  // namespace pingvox
