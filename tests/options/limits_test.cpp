// Options of all layers: the limits that validate() names, and those of the comments, are those that count.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <regex>
#include <string>
#include <type_traits>
#include <utility>

#include "device/internal/head_emulator.hpp"
#include "device/internal/nav_emulator.hpp"
#include "mapping/internal/obstacle_sectors.hpp"
#include "pingvox/sim/nav_sensors.hpp"
#include "pingvox/sim/sonar.hpp"
#include "pingvox/sim/tank.hpp"
#include "pingvox/sim/vehicle.hpp"
#include "pingvox/sonar/cartesian_image.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"

namespace pingvox {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What the message says of a field: "0..1", "> 0 and at most 2 pi"; empty: nothing.
template <class Options>
std::string rule_of(const Options& options, const std::string& name) {
  const Result<void> valid = options.validate();
  if (valid) return "";
  std::smatch found;
  const std::string message = " " + valid.error().message;
  return std::regex_search(message, found, std::regex(" " + name + " must be (.*?), is")) ? found[1].str() : "";
}

/// The number behind a word of a rule; NaN: the word is not there.
double limit_in(const std::string& rule, const std::string& words) {
  std::smatch found;
  if (!std::regex_search(rule, found, std::regex("(?:" + words + ")(-?[0-9.e+-]*[0-9])( pi)?"))) return std::nan("");
  return std::stod(found[1].str()) * (found[2].matched ? std::numbers::pi : 1.0);
}

/// The range "LOW..HIGH" in the comment of a field. The comment may go on below it.
std::optional<std::pair<double, double>> documented(const std::string& header, const std::string& name) {
  std::ifstream in(std::filesystem::path(PINGVOX_FUZZ_CORPUS) / "../.." / header);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  std::smatch field, range;
  if (!std::regex_search(text, field, std::regex("[ ,]" + name + " ?=[^;]*;([^\n]*(\n *///<[^\n]*)*)")))
    return std::nullopt;
  const std::string comment = field[1].str();
  if (!std::regex_search(comment, range, std::regex("(-?[0-9][0-9.,]*?)\\.\\.(-?[0-9][0-9.,]*)"))) return std::nullopt;
  const auto number = [](std::string digits) {
    std::erase(digits, ',');
    return std::stod(digits);
  };
  return std::pair(number(range[1].str()), number(range[2].str()));
}

/// The least and the largest value of a field are those of its comment. REQUIRES that whole numbers do not begin at 0.
template <class Options, class Number>
void expect_as_documented(const std::string& header, const std::string& name, Number Options::* field) {
  SCOPED_TRACE(name);
  const auto range = documented(header, name);
  ASSERT_TRUE(range) << header;
  const auto is_allowed = [&](double value) {
    Options options;
    options.*field = static_cast<Number>(value);
    return rule_of(options, name).empty();
  };
  const double margin = std::is_integral_v<Number> ? 1.0 : 1e-9;
  EXPECT_TRUE(is_allowed(range->first)) << range->first;
  EXPECT_TRUE(is_allowed(range->second)) << range->second;
  EXPECT_FALSE(is_allowed(range->first - margin)) << range->first;
  EXPECT_FALSE(is_allowed(range->second + margin)) << range->second;
}

// Kills a limit that is another one than is documented.
TEST(Limits, AreThoseOfTheComments) {
  const std::string heads = "src/device/internal/head_emulator.hpp", vehicles = "src/device/internal/nav_emulator.hpp";
  expect_as_documented(heads, "pings_per_s", &HeadEmulatorOptions::pings_per_s);
  expect_as_documented(heads, "damaged", &HeadEmulatorOptions::damaged);
  expect_as_documented(heads, "stall_s", &HeadEmulatorOptions::stall_s);
  expect_as_documented(vehicles, "reports_per_s", &NavEmulatorOptions::reports_per_s);
  expect_as_documented(vehicles, "damaged", &NavEmulatorOptions::damaged);
  const std::string sonar = "include/pingvox/sim/sonar.hpp", sensors = "include/pingvox/sim/nav_sensors.hpp";
  expect_as_documented(sonar, "beams_per_turn", &SonarOptions::beams_per_turn);
  expect_as_documented(sonar, "bins", &SonarOptions::bins);
  expect_as_documented(sonar, "gain", &SonarOptions::gain);
  expect_as_documented(sonar, "compression", &SonarOptions::compression);
  expect_as_documented(sonar, "absorption_db_per_m", &SonarOptions::absorption_db_per_m);
  expect_as_documented(sonar, "noise", &SonarOptions::noise);
  expect_as_documented(sonar, "silent", &SonarOptions::silent);
  expect_as_documented(sensors, "dvl_noise_m_s", &NavSensorOptions::dvl_noise_m_s);
  expect_as_documented(sensors, "dvl_outliers", &NavSensorOptions::dvl_outliers);
  expect_as_documented(sensors, "dvl_yaw_rad", &NavSensorOptions::dvl_yaw_rad);
  expect_as_documented(sensors, "dvl_scale", &NavSensorOptions::dvl_scale);
  expect_as_documented(sensors, "attitude_noise_rad", &NavSensorOptions::attitude_noise_rad);
  expect_as_documented(sensors, "compass_deviation_rad", &NavSensorOptions::compass_deviation_rad);
  expect_as_documented(sensors, "gyro_noise_rad_s", &NavSensorOptions::gyro_noise_rad_s);
  expect_as_documented(sensors, "gyro_drift_rad_s", &NavSensorOptions::gyro_drift_rad_s);
  expect_as_documented(sensors, "depth_noise_m", &NavSensorOptions::depth_noise_m);
  expect_as_documented(sensors, "delay_s", &NavSensorOptions::delay_s);
}

/// REQUIRES options that are valid but for the field.
template <class Options, class Field>
void expect_limits(const std::string& name, Field field, Options options = {}) {
  SCOPED_TRACE(name);
  const auto is_allowed = [&](double value) {
    field(options) = value;
    return rule_of(options, name).empty();
  };
  field(options) = std::nan("");
  const std::string rule = rule_of(options, name);
  ASSERT_NE(rule, "");
  SCOPED_TRACE(rule);
  const double at_least = limit_in(rule, "^in |^(?=-?[0-9.e-]+\\.\\.)|at least |>= |^(?=0 or more)"),
               above = limit_in(rule, "> |above ");
  const double at_most = limit_in(rule, "\\.\\.|at most |<= "), below = limit_in(rule, "less than ");
  ASSERT_TRUE(std::isfinite(at_least) || std::isfinite(above));
  if (std::isfinite(at_least)) {
    EXPECT_TRUE(is_allowed(at_least));
    EXPECT_FALSE(is_allowed(std::nextafter(at_least, -kInfinity)));
  } else {
    EXPECT_FALSE(is_allowed(above));
    EXPECT_TRUE(is_allowed(std::nextafter(above, kInfinity)));
  }
  if (std::isfinite(at_most)) {
    EXPECT_TRUE(is_allowed(at_most));
    EXPECT_FALSE(is_allowed(std::nextafter(at_most, kInfinity)));
  } else if (std::isfinite(below)) {
    EXPECT_FALSE(is_allowed(below));
    EXPECT_TRUE(is_allowed(std::nextafter(below, -kInfinity)));
  }
}

TEST(Limits, OfSonarAndMappingAreAsSaid) {
  expect_limits<FilterOptions>("sigma", [](auto& o) -> double& { return o.sigma; });
  expect_limits<CartesianOptions>("beam_width_rad", [](auto& o) -> double& { return o.beam_width_rad; });
  expect_limits<EchoOptions>("cfar.false_alarm_rate", [](auto& o) -> double& { return o.cfar.false_alarm_rate; });
  expect_limits<ObstacleOptions>("min_range_m", [](auto& o) -> double& { return o.min_range_m; });
  expect_limits<ObstacleOptions>("half_height_m", [](auto& o) -> double& { return o.half_height_m; });
}

TEST(Limits, OfTheSimulatorAreAsSaid) {
  expect_limits<TankOptions>("side_m", [](auto& o) -> double& { return o.side_m; });
  expect_limits<TankOptions>("depth_m", [](auto& o) -> double& { return o.depth_m; });
  expect_limits<SonarOptions>("bin_length_m", [](auto& o) -> double& { return o.bin_length_m; });
  expect_limits<SonarOptions>("beam_width_rad", [](auto& o) -> double& { return o.beam_width_rad; });
  expect_limits<SonarOptions>("beam_height_rad", [](auto& o) -> double& { return o.beam_height_rad; });
  expect_limits<SonarOptions>("lost", [](auto& o) -> double& { return o.lost; });
  expect_limits<TravelOptions>("speed_m_s", [](auto& o) -> double& { return o.speed_m_s; });
  expect_limits<TravelOptions>("pose_every_s", [](auto& o) -> double& { return o.pose_every_s; });
  expect_limits<NavSensorOptions>("dvl_per_s", [](auto& o) -> double& { return o.dvl_per_s; });
  expect_limits<NavSensorOptions>("attitude_per_s", [](auto& o) -> double& { return o.attitude_per_s; });
  expect_limits<NavSensorOptions>("depth_per_s", [](auto& o) -> double& { return o.depth_per_s; });
  expect_limits<NavSensorOptions>("dvl_lost", [](auto& o) -> double& { return o.dvl_lost; });
  expect_limits<NavSensorOptions>("delay_s", [](auto& o) -> double& { return o.delay_s; });
}

}  // namespace
}  // namespace pingvox
