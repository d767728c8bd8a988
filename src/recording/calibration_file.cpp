#include "pingvox/recording/calibration_file.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "base/words.hpp"
#include "geometry/internal/mount_text.hpp"
#include "io/internal/toml_file.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

/// A number of the calibration, as it stands in the file.
template <class Of>
struct CalibrationKey {
  const char* name;
  Estimate Of::* estimate;
  double unit;
};
constexpr std::array kCalibrationKeys = {
    CalibrationKey<SlamCalibration>{"velocity-yaw-deg", &SlamCalibration::velocity_yaw_rad, kDegree_rad},
    CalibrationKey<SlamCalibration>{"velocity-scale", &SlamCalibration::velocity_scale, 1.0},
    CalibrationKey<SlamCalibration>{"wall-in-echo", &SlamCalibration::wall_in_echo, 1.0},
    CalibrationKey<SlamCalibration>{"sonar-x", &SlamCalibration::sonar_x_m, 1.0},
    CalibrationKey<SlamCalibration>{"sonar-y", &SlamCalibration::sonar_y_m, 1.0}};
constexpr std::array kHeadingKeys = {
    CalibrationKey<HeadingCalibration>{"constant-deg", &HeadingCalibration::constant_rad, kDegree_rad},
    CalibrationKey<HeadingCalibration>{"sin1-deg", &HeadingCalibration::sin1_rad, kDegree_rad},
    CalibrationKey<HeadingCalibration>{"cos1-deg", &HeadingCalibration::cos1_rad, kDegree_rad},
    CalibrationKey<HeadingCalibration>{"sin2-deg", &HeadingCalibration::sin2_rad, kDegree_rad},
    CalibrationKey<HeadingCalibration>{"cos2-deg", &HeadingCalibration::cos2_rad, kDegree_rad}};
constexpr std::string_view kVelocitySource = "velocity-source", kSource = "source", kPose = "pose";
constexpr std::string_view kHeadingTable = "heading", kMountTable = "mount";

/// A basic string of TOML.
std::string toml_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : on_one_line(text)) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

template <class Of, std::size_t N>
std::string toml_lines(const Of& of, const std::array<CalibrationKey<Of>, N>& keys) {
  std::string toml;
  for (const auto& [name, member, unit] : keys) {
    const Estimate& estimate = of.*member;
    toml += fmt::format("{} = {:.6g}\n{}-sd = {:.2g}\n", name, estimate.value / unit, name, estimate.deviation / unit);
  }
  return toml;
}

Pose take_pose(TomlKeys& keys, std::string_view name) {
  const std::size_t line = keys.line_of(name);
  Pose pose = Pose::Identity();
  if (const std::string numbers = keys.text(name); !numbers.empty()) {
    const Result<Pose> mount = mount_from(numbers);
    if (!mount) keys.refuse(line, name, mount.error().message);
    pose = mount.value_or(pose);
  }
  return pose;
}

template <class Of, std::size_t N>
void take_estimates(TomlKeys& keys, Of& of, const std::array<CalibrationKey<Of>, N>& names) {
  for (const auto& [name, member, unit] : names) {
    const std::string sd = fmt::format("{}-sd", name);
    const std::size_t line = keys.line_of(sd);
    (of.*member).value = unit * keys.number(name);
    (of.*member).deviation = unit * keys.number(sd);
    if (!((of.*member).deviation > 0.0)) keys.refuse(line, sd, "must be above 0");
  }
}

}  // namespace

std::string calibration_toml(const CalibrationFile& file) {
  std::string toml = fmt::format("{} = {}\n", kVelocitySource, toml_string(file.calibration.velocity)) +
                     toml_lines(file.calibration, kCalibrationKeys);
  for (const HeadingCalibration& heading : file.calibration.headings) {
    toml += fmt::format("\n[[{}]]\n{} = {}\n", kHeadingTable, kSource, toml_string(heading.source)) +
            toml_lines(heading, kHeadingKeys);
  }
  for (const auto& [source, pose] : file.body_from_source) {
    toml += fmt::format("\n[[{}]]\n{} = {}\n{} = \"{}\"\n", kMountTable, kSource, toml_string(source), kPose,
                        mount_text(pose));
  }
  return toml;
}

Result<CalibrationFile> read_calibration(const FileBytes& bytes) {
  Result<std::vector<TomlSection>> sections = read_toml(bytes);
  if (!sections) return tl::unexpected(sections.error());
  CalibrationFile file;
  for (TomlSection& section : *sections) {
    const std::string name = section.name;
    const std::size_t line = section.line;
    TomlKeys keys(bytes.name, std::move(section));
    if (name.empty()) {
      file.calibration.velocity = keys.text(kVelocitySource);
      take_estimates(keys, file.calibration, kCalibrationKeys);
    } else if (name == kHeadingTable) {
      HeadingCalibration& heading = file.calibration.headings.emplace_back();
      heading.source = keys.text(kSource);
      take_estimates(keys, heading, kHeadingKeys);
    } else if (name == kMountTable) {
      const std::string source = keys.text(kSource);
      if (!file.body_from_source.emplace(source, take_pose(keys, kPose)).second) {
        return toml_error(bytes.name, line, fmt::format("duplicate mount of {}", on_one_line(source)));
      }
    } else {
      return toml_error(bytes.name, line, fmt::format("[[{}]]: is unknown", on_one_line(name)));
    }
    if (const auto whole = keys.finish(); !whole) return tl::unexpected(whole.error());
  }
  if (const auto valid = file.calibration.validate(); !valid) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: {}", bytes.name, on_one_line(valid.error().message)));
  }
  return file;
}

}  // namespace pingvox
