#include "pingvox/io/bag_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "base/option_text.hpp"
#include "base/words.hpp"
#include "io/internal/toml_file.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

enum class AngleTurn { kCounterClockwise, kClockwise };
constexpr std::array kAngleTurns = {Choice<AngleTurn>{"ccw", AngleTurn::kCounterClockwise},
                                    Choice<AngleTurn>{"cw", AngleTurn::kClockwise}};
constexpr std::array kAngleUnits = {Choice<double>{"rad", 1.0}, Choice<double>{"deg", kDegree_rad},
                                    Choice<double>{"grad", std::numbers::pi / 200.0}};
constexpr std::array kFieldTimeUnits = {Choice<double>{"s", 1.0}, Choice<double>{"ms", 1e-3},
                                        Choice<double>{"us", 1e-6}, Choice<double>{"ns", 1e-9}};
constexpr std::array kFieldFrames = {
    Choice<NavFields::Frame>{"enu", NavFields::Frame::kEnu}, Choice<NavFields::Frame>{"flu", NavFields::Frame::kEnu},
    Choice<NavFields::Frame>{"ned", NavFields::Frame::kNed}, Choice<NavFields::Frame>{"frd", NavFields::Frame::kNed}};

/// A unit, and how many of `standard` it is.
struct NavUnit {
  std::string_view standard, word;
  double size;
};
constexpr std::array kNavUnits = {NavUnit{"m", "m", 1.0},
                                  NavUnit{"m", "cm", 0.01},
                                  NavUnit{"m", "mm", 0.001},
                                  NavUnit{"m/s", "m/s", 1.0},
                                  NavUnit{"m/s", "cm/s", 0.01},
                                  NavUnit{"m/s", "mm/s", 0.001},
                                  NavUnit{"rad", "rad", 1.0},
                                  NavUnit{"rad", "deg", kDegree_rad},
                                  NavUnit{"rad", "degE7", kDegree_rad * 1e-7},
                                  NavUnit{"rad/s", "rad/s", 1.0},
                                  NavUnit{"rad/s", "deg/s", kDegree_rad},
                                  NavUnit{"Pa", "Pa", 1.0},
                                  NavUnit{"Pa", "hPa", 1e2},
                                  NavUnit{"Pa", "mbar", 1e2},
                                  NavUnit{"Pa", "kPa", 1e3},
                                  NavUnit{"Pa", "bar", 1e5},
                                  NavUnit{"C", "C", 1.0}};

std::string_view standard_unit_of(NavQuantity quantity) {
  switch (quantity) {
    case NavQuantity::kVelocity:
      return "m/s";
    case NavQuantity::kAttitude:
    case NavQuantity::kHeading:
    case NavQuantity::kFix:
      return "rad";
    case NavQuantity::kTurnRate:
      return "rad/s";
    case NavQuantity::kPressure:
      return "Pa";
    case NavQuantity::kTemperature:
      return "C";
    case NavQuantity::kDepth:
    case NavQuantity::kPosition:
    case NavQuantity::kRange:
      break;
  }
  return "m";
}

Result<double> unit_from(NavQuantity quantity, const std::string& word) {
  std::vector<std::string> known;
  for (const NavUnit& unit : kNavUnits) {
    if (unit.standard != standard_unit_of(quantity)) continue;
    if (unit.word == word) return unit.size;
    known.emplace_back(unit.word);
  }
  return fail(Error::Code::kBadOption,
              fmt::format("must be {}, not '{}'", fmt::join(known, " or "), on_one_line(word)));
}

Result<NavQuantity> quantity_from(const std::string& name) {
  if (const auto quantity = nav_quantity_of(name)) return *quantity;
  std::vector<std::string> known;
  for (int i = 0; i <= static_cast<int>(NavQuantity::kTemperature); ++i) {
    known.emplace_back(name_of(static_cast<NavQuantity>(i)));
  }
  return fail(Error::Code::kBadOption, fmt::format("must be {}, not '{}'{}", fmt::join(known, " or "),
                                                   on_one_line(name), did_you_mean(name, known)));
}

/// Words with commas between them; blanks around them are left out.
std::vector<std::string> list_from(std::string_view text) {
  std::vector<std::string> words;
  for (;;) {
    const std::size_t comma = std::min(text.find(','), text.size());
    std::string_view word = text.substr(0, comma);
    const std::size_t first = std::min(word.find_first_not_of(" \t"), word.size());
    word = word.substr(first, word.find_last_not_of(" \t") + 1 - first);
    words.emplace_back(word);
    if (comma == text.size()) return words;
    text.remove_prefix(comma + 1);
  }
}

/// What makes messages beams, key by key.
class BeamKeys {
 public:
  Result<void> take(std::string_view key, const std::string& value) {
    if (key == "angle") {
      fields_.angle = value;
    } else if (key == "range" || key == "bin") {
      fields_.length = value;
      fields_.length_of = key == "bin" ? BeamFields::Length::kBin : BeamFields::Length::kBeam;
    } else if (key == "intensities") {
      fields_.intensities = value;
    } else if (key == "unit") {
      return choice_value(kAngleUnits, value).map([&](double unit) { unit_rad_ = unit; });
    } else if (key == "turn") {
      return choice_value(kAngleTurns, value).map([&](AngleTurn turn) {
        sense_ = turn == AngleTurn::kClockwise ? -1.0 : 1.0;
      });
    } else if (key == "ahead") {
      return number_from<double>(value).map([&](double ahead) { fields_.ahead = ahead; });
    } else {
      return fail(Error::Code::kBadOption, "must be one of angle, range, bin, intensities, unit, turn, ahead");
    }
    return {};
  }

  Result<BeamFields> finish() {
    if (fields_.angle.empty() || fields_.length.empty() || fields_.intensities.empty()) {
      return fail(Error::Code::kBadOption, "must name the fields of angle, range or bin, and intensities");
    }
    fields_.angle_unit_rad = sense_ * unit_rad_;
    return fields_;
  }

 private:
  BeamFields fields_;
  double unit_rad_ = 1.0, sense_ = 1.0;
};

/// The section [[beams]].
Result<BeamTopic> beam_topic_of(const std::string& file, const TomlSection& section) {
  BeamTopic beams;
  BeamKeys keys;
  for (const auto& [key, value] : section.values) {
    if (key == "topic") {
      beams.name = value.text;
    } else if (const auto taken = keys.take(key, value.text); !taken) {
      return toml_error(file, value.line, fmt::format("{}: {}", on_one_line(key), taken.error().message));
    }
  }
  if (beams.name.empty()) return toml_error(file, section.line, "topic: is missing in this [[beams]]");
  Result<BeamFields> fields = keys.finish();
  if (!fields) return toml_error(file, section.line, "[[beams]]: " + fields.error().message);
  beams.fields = *std::move(fields);
  return beams;
}

/// Calls `use` with what `parse` makes of the text of a key, if it is there.
template <class Parse, class Use>
void take_if_there(TomlKeys& keys, std::string_view name, Parse parse, Use use) {
  if (!keys.has(name)) return;
  const std::size_t line = keys.line_of(name);
  const std::string text = keys.text(name);
  if (text.empty()) return;
  const auto value = parse(text);
  value ? use(*value) : keys.refuse(line, name, value.error().message);
}

/// A section [[nav]].
Result<NavFields> nav_fields_of(const std::string& file, const TomlSection& section) {
  NavFields fields;
  fields.stated_in = fmt::format("{}: line {}", file, section.line);
  TomlKeys keys(file, section);
  const auto word = [](const std::string& value) { return Result<std::string>(value); };
  const auto list = [](const std::string& value) { return Result<std::vector<std::string>>(list_from(value)); };
  take_if_there(keys, "topic", word, [&](const std::string& name) { fields.topic = name; });
  take_if_there(keys, "type", word, [&](const std::string& name) { fields.type = name; });
  const std::size_t line = keys.line_of("quantity");
  const Result<NavQuantity> quantity = quantity_from(keys.text("quantity"));
  if (!quantity) keys.refuse(line, "quantity", quantity.error().message);
  fields.quantity = quantity.value_or(fields.quantity);
  fields.values = list_from(keys.text("fields"));
  if (fields.quantity == NavQuantity::kFix) fields.unit = kDegree_rad;
  const bool is_quaternion = fields.quantity == NavQuantity::kAttitude && fields.values.size() == 4;
  if (is_quaternion && keys.has("unit")) keys.refuse(keys.line_of("unit"), "unit", "a quaternion has none");
  take_if_there(
      keys, "unit", [&](const std::string& unit) { return unit_from(fields.quantity, unit); },
      [&](double unit) { fields.unit = unit; });
  if (!has_frame(fields.quantity) && keys.has("frame")) {
    keys.refuse(keys.line_of("frame"), "frame", fmt::format("{} has none", name_of(fields.quantity)));
  }
  take_if_there(
      keys, "frame", [](const std::string& frame) { return choice_value(kFieldFrames, frame); },
      [&](NavFields::Frame frame) { fields.frame = frame; });
  if (keys.has("sd") && keys.has("variance")) keys.refuse(keys.line_of("variance"), "variance", "excludes sd");
  take_if_there(keys, "sd", list, [&](const auto& paths) { fields.spread = paths; });
  take_if_there(keys, "variance", list, [&](const auto& paths) {
    fields.spread = paths;
    fields.spread_is = NavFields::Spread::kVariance;
  });
  take_if_there(keys, "valid", word, [&](const std::string& condition) { fields.valid = condition; });
  if (keys.has("time-unit") && !keys.has("time")) keys.refuse(keys.line_of("time-unit"), "time-unit", "needs time");
  take_if_there(keys, "time", word, [&](const std::string& path) { fields.time = path; });
  take_if_there(
      keys, "time-unit", [](const std::string& unit) { return choice_value(kFieldTimeUnits, unit); },
      [&](double unit_s) { fields.time_unit_s = unit_s; });
  if (const auto whole = keys.finish(); !whole) return tl::unexpected(whole.error());
  if (const auto valid = fields.validate(); !valid) return toml_error(file, section.line, valid.error().message);
  return fields;
}

}  // namespace

Result<BeamFields> beam_fields_from(std::string_view text) {
  BeamKeys keys;
  for (const std::string& part : list_from(text)) {
    const std::size_t equals = std::min(part.find('='), part.size());
    const std::string key = part.substr(0, equals), value = part.substr(std::min(equals + 1, part.size()));
    if (value.empty()) return fail(Error::Code::kBadOption, fmt::format("'{}': must be KEY=VALUE", part));
    if (const auto taken = keys.take(key, value); !taken) {
      return fail(Error::Code::kBadOption, fmt::format("'{}': {}", key, taken.error().message));
    }
  }
  return keys.finish();
}

Result<BagFields> read_bag_fields(const FileBytes& file) {
  const Result<std::vector<TomlSection>> sections = read_toml(file);
  if (!sections) return tl::unexpected(sections.error());
  BagFields bag;
  for (const TomlSection& section : *sections) {
    if (section.name.empty() && section.values.empty()) continue;
    if (section.name == "beams" && bag.beams) {
      return toml_error(file.name, section.line, "[[beams]]: is there twice: one file is for one sonar");
    }
    if (section.name == "beams") {
      Result<BeamTopic> found = beam_topic_of(file.name, section);
      if (!found) return tl::unexpected(found.error());
      bag.beams = *std::move(found);
    } else if (section.name == "nav") {
      Result<NavFields> fields = nav_fields_of(file.name, section);
      if (!fields) return tl::unexpected(fields.error());
      bag.nav.push_back(*std::move(fields));
    } else {
      return toml_error(file.name, section.line,
                        section.name.empty() ? "keys must be below [[beams]] or [[nav]]"
                                             : fmt::format("[[{}]]: is unknown: must be [[beams]] or [[nav]]",
                                                           on_one_line(section.name)));
    }
  }
  if (!bag.beams && bag.nav.empty()) return toml_error(file.name, 1, "has neither [[beams]] nor [[nav]]");
  return bag;
}

}  // namespace pingvox
