#include "calibration_file.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "console.hpp"
#include "mapping_options.hpp"
#include "option_values.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/file.hpp"
#include "toml_file.hpp"

namespace pingvox::app {
namespace {

/// A number of the calibration, as it stands in the file.
template <class Of>
struct Key {
  const char* name;
  Estimate Of::* estimate;
  double unit;
};
constexpr std::array kKeys = {Key<SlamCalibration>{"velocity-yaw-deg", &SlamCalibration::velocity_yaw_rad, kDegree_rad},
                              Key<SlamCalibration>{"velocity-scale", &SlamCalibration::velocity_scale, 1.0},
                              Key<SlamCalibration>{"wall-in-echo", &SlamCalibration::wall_in_echo, 1.0},
                              Key<SlamCalibration>{"sonar-x", &SlamCalibration::sonar_x_m, 1.0},
                              Key<SlamCalibration>{"sonar-y", &SlamCalibration::sonar_y_m, 1.0}};
constexpr std::array kHeadingKeys = {
    Key<HeadingCalibration>{"constant-deg", &HeadingCalibration::constant_rad, kDegree_rad},
    Key<HeadingCalibration>{"sin1-deg", &HeadingCalibration::sin1_rad, kDegree_rad},
    Key<HeadingCalibration>{"cos1-deg", &HeadingCalibration::cos1_rad, kDegree_rad},
    Key<HeadingCalibration>{"sin2-deg", &HeadingCalibration::sin2_rad, kDegree_rad},
    Key<HeadingCalibration>{"cos2-deg", &HeadingCalibration::cos2_rad, kDegree_rad}};
constexpr std::string_view kVelocitySource = "velocity-source", kSource = "source", kPose = "pose";
constexpr std::string_view kHeading = "heading", kMount = "mount";

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
std::string toml_lines(const Of& of, const std::array<Key<Of>, N>& keys) {
  std::string toml;
  for (const auto& [name, member, unit] : keys) {
    const Estimate& estimate = of.*member;
    toml += fmt::format("{} = {:.6g}\n{}-sd = {:.2g}\n", name, estimate.value / unit, name, estimate.deviation / unit);
  }
  return toml;
}

/// As --nav-mount takes it.
std::string mount_text(const Pose& pose) {
  const Eigen::Vector3d rpy_deg = rpy_of(pose.rotation()) / kDegree_rad;
  const Eigen::Vector3d at = pose.translation();
  return fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}", at.x(), at.y(), at.z(), rpy_deg.x(), rpy_deg.y(),
                     rpy_deg.z());
}

Pose take_pose(TomlKeys& keys, std::string_view name) {
  const std::size_t line = keys.line_of(name);
  Pose pose = Pose::Identity();
  if (const std::string numbers = keys.text(name); !numbers.empty()) {
    if (const auto taken = store_mount(pose)(numbers); !taken) keys.refuse(line, name, taken.error().message);
  }
  return pose;
}

template <class Of, std::size_t N>
void take_estimates(TomlKeys& keys, Of& of, const std::array<Key<Of>, N>& names) {
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
  std::string toml =
      fmt::format("# Calibration for --use-calibration; -sd is the standard deviation of the line above.\n{} = {}\n",
                  kVelocitySource, toml_string(file.calibration.velocity)) +
      toml_lines(file.calibration, kKeys);
  for (const HeadingCalibration& heading : file.calibration.headings) {
    toml += fmt::format("\n[[{}]]\n{} = {}\n", kHeading, kSource, toml_string(heading.source)) +
            toml_lines(heading, kHeadingKeys);
  }
  for (const auto& [source, pose] : file.body_from_source) {
    toml +=
        fmt::format("\n[[{}]]\n{} = {}\n{} = \"{}\"\n", kMount, kSource, toml_string(source), kPose, mount_text(pose));
  }
  return toml;
}

Result<CalibrationFile> read_calibration(const std::string& path) {
  const Result<FileBytes> bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<std::vector<TomlSection>> sections = read_toml(*bytes);
  if (!sections) return tl::unexpected(sections.error());
  CalibrationFile file;
  for (TomlSection& section : *sections) {
    const std::string name = section.name;
    const std::size_t line = section.line;
    TomlKeys keys(bytes->name, std::move(section));
    if (name.empty()) {
      file.calibration.velocity = keys.text(kVelocitySource);
      take_estimates(keys, file.calibration, kKeys);
    } else if (name == kHeading) {
      HeadingCalibration& heading = file.calibration.headings.emplace_back();
      heading.source = keys.text(kSource);
      take_estimates(keys, heading, kHeadingKeys);
    } else if (name == kMount) {
      const std::string source = keys.text(kSource);
      if (!file.body_from_source.emplace(source, take_pose(keys, kPose)).second) {
        return toml_error(bytes->name, line, fmt::format("the mount of {} is there twice", on_one_line(source)));
      }
    } else {
      return toml_error(bytes->name, line, fmt::format("[[{}]]: is unknown", on_one_line(name)));
    }
    if (const auto whole = keys.finish(); !whole) return tl::unexpected(whole.error());
  }
  if (const auto valid = file.calibration.validate(); !valid) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: {}", bytes->name, on_one_line(valid.error().message)));
  }
  return file;
}

}  // namespace pingvox::app
