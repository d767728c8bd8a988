#include "calibration_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "console.hpp"
#include "mapping_options.hpp"
#include "option_values.hpp"
#include "pingvox/io/file.hpp"

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
  const Eigen::Matrix3d turn = pose.rotation();
  const double roll_rad = std::atan2(turn(2, 1), turn(2, 2)), yaw_rad = std::atan2(turn(1, 0), turn(0, 0)),
               pitch_rad = std::asin(std::clamp(-turn(2, 0), -1.0, 1.0));
  const Eigen::Vector3d at = pose.translation();
  return fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}", at.x(), at.y(), at.z(), roll_rad / kDegree_rad,
                     pitch_rad / kDegree_rad, yaw_rad / kDegree_rad);
}

struct Value {
  std::string text;
  bool is_string = false;
  std::size_t line = 0;
};

/// The keys under a [[name]], or those before the first.
struct Section {
  std::string name;
  std::size_t line = 1;
  std::map<std::string, Value, std::less<>> values;
};

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
  return first == std::string_view::npos ? std::string_view() : text.substr(first, last - first + 1);
}

/// A basic string without escapes but \" and \\, or a bare word; a comment may follow. nullopt: neither.
std::optional<Value> value_from(std::string_view text) {
  Value value;
  std::string_view rest;
  if (text.starts_with('"')) {
    value.is_string = true;
    std::size_t i = 1;
    for (; i < text.size() && text[i] != '"'; ++i) {
      if (text[i] == '\\' && (++i == text.size() || (text[i] != '"' && text[i] != '\\'))) return std::nullopt;
      value.text += text[i];
    }
    if (i >= text.size()) return std::nullopt;
    rest = trim(text.substr(i + 1));
  } else {
    const std::size_t end = std::min(text.find('#'), text.size());
    value.text = trim(text.substr(0, end));
    rest = text.substr(end);
  }
  if (value.text.empty() || (!rest.empty() && !rest.starts_with('#'))) return std::nullopt;
  return value;
}

tl::unexpected<Error> fail_at(const std::string& file, std::size_t line, const std::string& what) {
  return fail(Error::Code::kCorrupt, fmt::format("{}: line {}: {}", file, line, what));
}

/// The part of TOML that a calibration is written in: numbers, basic strings, and arrays of tables.
Result<std::vector<Section>> read_sections(const FileBytes& file) {
  std::vector<Section> sections(1);
  std::string_view text(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size());
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || line.starts_with('#')) continue;
    if (line.starts_with("[[") && line.ends_with("]]")) {
      sections.push_back({std::string(trim(line.substr(2, line.size() - 4))), number, {}});
      continue;
    }
    const std::size_t equals = line.find('=');
    std::optional<Value> value;
    if (equals != std::string_view::npos) value = value_from(trim(line.substr(equals + 1)));
    if (!value) return fail_at(file.name, number, "is not 'name = number', 'name = \"text\"' or '[[name]]'");
    value->line = number;
    const std::string name(trim(line.substr(0, equals)));
    if (!sections.back().values.emplace(name, *value).second) {
      return fail_at(file.name, number, fmt::format("{}: is there twice", on_one_line(name)));
    }
  }
  return sections;
}

/// Takes the keys of a section; the first error counts.
class Taker {
 public:
  Taker(std::string file, Section section) : file_(std::move(file)), section_(std::move(section)) {}

  std::string text(std::string_view name) {
    const std::optional<Value> value = take(name);
    if (value && !value->is_string) refuse(value->line, name, "must be a text in quotation marks");
    return value ? value->text : std::string();
  }
  Pose pose(std::string_view name) {
    const std::size_t line = line_of(name);
    Pose pose = Pose::Identity();
    if (const std::string numbers = text(name); !numbers.empty()) {
      if (const auto taken = store_mount(pose)(numbers); !taken) refuse(line, name, taken.error().message);
    }
    return pose;
  }
  template <class Of, std::size_t N>
  void estimates(Of& of, const std::array<Key<Of>, N>& keys) {
    for (const auto& [name, member, unit] : keys) {
      const std::string sd = fmt::format("{}-sd", name);
      const std::size_t line = line_of(sd);
      (of.*member).value = unit * number(name);
      (of.*member).deviation = unit * number(sd);
      if (!((of.*member).deviation > 0.0)) refuse(line, sd, "must be above 0");
    }
  }
  /// Whether all was there, and nothing else.
  Result<void> finish() {
    for (const auto& [name, value] : section_.values) refuse(value.line, on_one_line(name), "is unknown");
    return error_ ? Result<void>(tl::unexpected(*error_)) : Result<void>();
  }

 private:
  std::size_t line_of(std::string_view name) const {
    const auto found = section_.values.find(name);
    return found == section_.values.end() ? section_.line : found->second.line;
  }
  std::optional<Value> take(std::string_view name) {
    const auto found = section_.values.find(name);
    if (found == section_.values.end()) {
      const std::string in = section_.name.empty() ? "" : fmt::format(" in this [[{}]]", section_.name);
      refuse(section_.line, name, "is missing" + in);
      return std::nullopt;
    }
    Value value = std::move(found->second);
    section_.values.erase(found);
    return value;
  }
  double number(std::string_view name) {
    const std::optional<Value> value = take(name);
    if (!value) return 0.0;
    const Result<double> number = number_from<double>(value->text);
    if (value->is_string || !number || !std::isfinite(*number)) {
      refuse(value->line, name, fmt::format("'{}' is not a finite number", on_one_line(value->text)));
      return 0.0;
    }
    return *number;
  }
  void refuse(std::size_t line, std::string_view name, std::string_view what) {
    if (!error_) error_ = fail_at(file_, line, fmt::format("{}: {}", name, what)).value();
  }

  std::string file_;
  Section section_;
  std::optional<Error> error_;
};

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
  Result<std::vector<Section>> sections = read_sections(*bytes);
  if (!sections) return tl::unexpected(sections.error());
  CalibrationFile file;
  for (Section& section : *sections) {
    const std::string name = section.name;
    const std::size_t line = section.line;
    Taker taker(bytes->name, std::move(section));
    if (name.empty()) {
      file.calibration.velocity = taker.text(kVelocitySource);
      taker.estimates(file.calibration, kKeys);
    } else if (name == kHeading) {
      HeadingCalibration& heading = file.calibration.headings.emplace_back();
      heading.source = taker.text(kSource);
      taker.estimates(heading, kHeadingKeys);
    } else if (name == kMount) {
      const std::string source = taker.text(kSource);
      if (!file.body_from_source.emplace(source, taker.pose(kPose)).second) {
        return fail_at(bytes->name, line, fmt::format("the mount of {} is there twice", on_one_line(source)));
      }
    } else {
      return fail_at(bytes->name, line, fmt::format("[[{}]]: is unknown", on_one_line(name)));
    }
    if (const auto whole = taker.finish(); !whole) return tl::unexpected(whole.error());
  }
  if (const auto valid = file.calibration.validate(); !valid) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: {}", bytes->name, on_one_line(valid.error().message)));
  }
  return file;
}

Result<Eigen::Vector3d> use_calibration(const std::string& path, OdometryOptions& options) {
  Result<CalibrationFile> file = read_calibration(path);
  if (!file) return tl::unexpected(file.error());
  options.body_from_source.insert(file->body_from_source.begin(), file->body_from_source.end());
  Eigen::Vector3d moved_m(file->calibration.sonar_x_m.value, file->calibration.sonar_y_m.value, 0.0);
  options.calibration = std::move(file->calibration);
  return moved_m;
}

}  // namespace pingvox::app
