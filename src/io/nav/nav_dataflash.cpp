#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "io/nav/dataflash.hpp"
#include "io/nav/nav_readers.hpp"
#include "io/nav/nav_sources.hpp"
#include "pingvox/geometry/degree.hpp"

// The navigation in the log that an ArduPilot autopilot keeps itself.
namespace pingvox {
namespace {

class DataflashNav {
 public:
  void add(const DataflashRecord& record) {
    const std::string_view name = record.type.name;
    const std::optional<double> time_s = time_of(record);
    if (!time_s) return;
    time_s_ = *time_s;
    name_ = name;
    // Records of repeated sensors have an index; older logs have a type for each instead.
    for (const std::string_view label : {"I", "C", "Instance"}) {
      if (const auto instance = record.number_of(label)) name_ = fmt::format("{}[{:.0f}]", name, *instance);
    }
    using enum NavQuantity;
    if (name == "ATT" || name == "AHR2") put_attitude(record);
    if (name.starts_with("XKF1") || name.starts_with("NKF1") || name == "NKF6") {
      put_attitude(record);
      put_position(record);
    }
    if (name.starts_with("IMU")) {
      if (const auto rates = three(record, "GyrX", "GyrY", "GyrZ")) put(kTurnRate, from_ned::body(*rates));
    }
    if (name.starts_with("BAR")) {
      if (const auto pressure_pa = record.number_of("Press")) put(kPressure, {*pressure_pa, 0, 0});
      if (const auto temperature_c = record.number_of("Temp")) put(kTemperature, {*temperature_c, 0, 0});
    }
    if (name == "CTUN" && record.type.field("DAlt") != nullptr) {
      if (const auto up_m = record.number_of("Alt")) put(kDepth, {-*up_m, 0, 0});
    }
    if (name == "RFND") put_range(record);
    if (name == "VISO") put_velocity(record);
    if (name.starts_with("GPS")) put_fix(record);
  }

  std::vector<NavSource> take() { return sources_.take(); }

 private:
  static std::optional<double> time_of(const DataflashRecord& record) {
    if (const auto us = record.number_of("TimeUS")) return *us * 1e-6;
    // Logs of 2014: a GPS has its own time in TimeMS, and that of the autopilot in T.
    const auto ms = record.number_of(record.type.field("T") != nullptr ? "T" : "TimeMS");
    return ms ? std::optional(*ms * 1e-3) : std::nullopt;
  }

  static std::optional<Eigen::Vector3d> three(const DataflashRecord& record, std::string_view x, std::string_view y,
                                              std::string_view z) {
    const auto a = record.number_of(x), b = record.number_of(y), c = record.number_of(z);
    if (!a || !b || !c) return std::nullopt;
    return Eigen::Vector3d(*a, *b, *c);
  }

  NavSample* put(NavQuantity quantity, const Eigen::Vector3d& value) {
    NavSample sample;
    sample.time_s = time_s_;
    sample.value = value;
    return sources_.add(name_, quantity, sample);
  }

  void put_attitude(const DataflashRecord& record) {
    if (const auto rpy_deg = three(record, "Roll", "Pitch", "Yaw")) {
      put(NavQuantity::kAttitude, from_ned::attitude(*rpy_deg * kDegree_rad));
    }
  }

  /// The filter gives 0, 0 until it has a position.
  void put_position(const DataflashRecord& record) {
    const auto ned = three(record, "PN", "PE", "PD");
    if (!ned) return;
    NavSample* const sample = put(NavQuantity::kPosition, from_ned::world(*ned));
    if (sample != nullptr) sample->valid = ned->x() != 0.0 || ned->y() != 0.0;
  }

  void put_range(const DataflashRecord& record) {
    constexpr double kGood = 4.0;
    const auto range_m = record.number_of("Dist");
    if (!range_m) return;
    NavSample* const sample = put(NavQuantity::kRange, {*range_m, 0, 0});
    if (sample != nullptr) sample->valid = record.number_of("Stat").value_or(kGood) == kGood;
  }

  /// How far the vehicle moved in the time before: the velocity in the middle of it.
  void put_velocity(const DataflashRecord& record) {
    const auto moved_m = three(record, "PosDX", "PosDY", "PosDZ");
    const auto step_s = record.number_of("dt");
    if (!moved_m || !step_s || !(*step_s > 0.0)) return;
    time_s_ -= *step_s / 2.0;
    put(NavQuantity::kVelocity, from_ned::body(*moved_m) / *step_s);
  }

  void put_fix(const DataflashRecord& record) {
    const auto fix = three(record, "Lat", "Lng", "Alt");
    if (!fix) return;
    NavSample* const sample = put(NavQuantity::kFix, {fix->x() * kDegree_rad, fix->y() * kDegree_rad, fix->z()});
    if (sample == nullptr) return;
    sample->valid = record.number_of("Status").value_or(0.0) >= 2.0 && (fix->x() != 0.0 || fix->y() != 0.0);
  }

  NavSources sources_;
  std::string name_;
  double time_s_ = 0.0;
};

}  // namespace

bool looks_like_dataflash(std::span<const std::uint8_t> bytes) {
  // A log begins with the definitions of its types.
  constexpr std::array<std::uint8_t, 3> kFirst = {0xa3, 0x95, 128};
  return bytes.size() >= 89 && std::equal(kFirst.begin(), kFirst.end(), bytes.begin());
}

NavReading read_dataflash(std::span<const std::uint8_t> bytes) {
  NavReading reading;
  reading.clock = NavClock::kBoot;
  DataflashNav nav;
  reading.records =
      for_each_dataflash_record(bytes, reading.damage, [&nav](const DataflashRecord& record) { nav.add(record); });
  reading.sources = nav.take();
  return reading;
}

}  // namespace pingvox
