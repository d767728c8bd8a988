#include "io/bags/sonar_messages.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "io/internal/ping_frame.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {
namespace {

using NoBeam = tl::unexpected<Unusable>;

constexpr std::string_view kNoSamples = "ping without samples", kOtherSamples = "samples that are not of 8 bits";

NoBeam no_beam(std::string_view kind, std::string why = {}) {
  return NoBeam(Unusable{kind, std::move(why)});
}

/// A beam that looks ahead: it is turned by who knows the unit of its angle.
Beams beam_of(double bin_length_m, std::vector<std::uint8_t> intensities) {
  if (intensities.size() < 2) return no_beam(kNoSamples);
  const double range_m = bin_length_m * static_cast<double>(intensities.size());
  if (!(range_m > 0.0 && range_m <= kMaxBeamRange_m)) {
    return no_beam(kImpossible, fmt::format("a range of {:.6g} m is too long for a scanning sonar", range_m));
  }
  return std::vector{Beam{0.0, 0.0, bin_length_m, std::move(intensities)}};
}

/// A length that a driver computed with its own speed of sound, at the assumed one, as that of all beams.
double at_assumed_speed(double length_m, double sound_speed_m_s) {
  constexpr double kSlowest_m_s = 1300.0, kFastest_m_s = 1700.0;
  const bool is_speed = sound_speed_m_s >= kSlowest_m_s && sound_speed_m_s <= kFastest_m_s;
  return is_speed ? length_m * (kAssumedSoundSpeed_m_s / sound_speed_m_s) : length_m;
}

/// Of a range, in as many samples as there are.
Beams range_beam(double range_m, std::vector<std::uint8_t> samples) {
  const double bin_length_m = range_m / static_cast<double>(samples.size());
  return beam_of(bin_length_m, std::move(samples));
}

/// The intensities in a field; the error names numbers that are another scale's: of 12 bits, decibels, or 0 to 1.
tl::expected<std::vector<std::uint8_t>, Unusable> intensities_of(const RosFields& message, std::size_t field) {
  constexpr double kLowest = -0.5, kHighest = 255.5;
  if (message.has_bytes(field) || message.count(field) == 0) return message.bytes(field);
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  bool has_fractions = false;
  for (std::size_t i = 0; i < message.count(field); ++i) {
    const double number = message.number(field, i);
    if (std::isnan(number)) continue;
    lowest = std::min(lowest, number);
    highest = std::max(highest, number);
    has_fractions = has_fractions || number != std::floor(number);
  }
  const bool are_of_1 = has_fractions && lowest >= 0.0 && highest <= 1.0;
  if (lowest < kLowest || highest >= kHighest || are_of_1) {
    return no_beam(kImpossible,
                   fmt::format("intensities are {:.6g} to {:.6g}, but 0 to 255 are expected", lowest, highest));
  }
  return message.bytes(field);
}

/// A beam of a range, with the intensities in a field.
Beams range_beam_of(double range_m, const RosFields& message, std::size_t field) {
  auto intensities = intensities_of(message, field);
  if (!intensities) return NoBeam(intensities.error());
  return range_beam(range_m, *std::move(intensities));
}

Beams echo_beam(const RosFields& message, SonarSettings&) {
  return range_beam_of(message.number(1), message, 2);
}

Beams slice_beam_with_count(const RosFields& message, SonarSettings& settings) {
  const auto samples = static_cast<double>(message.count(2));
  if (message.number(3) != samples) {
    return no_beam(kContradiction, fmt::format("nbins {} does not fit {} data", message.number(3), samples));
  }
  return echo_beam(message, settings);
}

Beams echo_beam_with_speed(const RosFields& message, SonarSettings& settings) {
  Beams beams = echo_beam(message, settings);
  if (beams) beams->front().bin_length_m = at_assumed_speed(beams->front().bin_length_m, message.number(3));
  return beams;
}

Beams echo_beam_with_count(const RosFields& message, SonarSettings& settings) {
  const auto samples = static_cast<double>(message.count(2));
  if (samples >= 2.0 && message.number(4) != samples) {
    return no_beam(kContradiction,
                   fmt::format("number_of_samples {} does not fit {} intensities", message.number(4), samples));
  }
  return echo_beam_with_speed(message, settings);
}

Beams beam_of_ping(std::uint16_t angle_grad, std::uint16_t period_25ns, std::span<const std::uint8_t> samples) {
  Ping360Ping ping;
  ping.angle_grad = angle_grad;
  ping.period_25ns = period_25ns;
  ping.data = samples;
  auto beam = pingvox::beam_of(ping, 0.0);
  if (!beam) return no_beam(kImpossible, beam.error());
  return std::vector{*std::move(beam)};
}

Beams ping_beam(const RosFields& message, SonarSettings& settings) {
  const std::vector<std::uint8_t> samples = message.bytes(2);
  if (samples.size() < 2) return no_beam(kNoSamples);  // recorded when the head did not answer
  const auto angle_grad = whole<std::uint16_t>(message.number(0));
  const auto period_25ns = whole<std::uint16_t>(settings.period_25ns.value_or(message.number(1)));
  if (!angle_grad || !period_25ns) return no_beam(kImpossible);
  return beam_of_ping(*angle_grad, *period_25ns, samples);
}

/// A ping as Ping Viewer 2 records it. What a 2300 lacks (sector, step, delay) has the values of a full turn there, and
/// the head's angles tell better. There may be fewer samples than were asked for.
Beams recorded_ping_beam(const RosFields& message, SonarSettings&) {
  const std::vector<std::uint8_t> samples = message.bytes(2);
  if (samples.size() < 2) return no_beam(kNoSamples);  // the answer to a request for the head's state
  if (!message.has_bytes(2)) return no_beam(kOtherSamples);
  const auto angle_grad = whole<std::uint16_t>(message.number(0));
  const auto period_25ns = whole<std::uint16_t>(message.number(1));
  const auto asked_for = whole<std::uint16_t>(message.number(3));
  if (!angle_grad || !period_25ns || !asked_for) return no_beam(kImpossible);
  if (samples.size() > *asked_for) {
    return no_beam(kContradiction,
                   fmt::format("number_of_samples {} does not fit {} data", *asked_for, samples.size()));
  }
  return beam_of_ping(*angle_grad, *period_25ns, samples);
}

Beams ping_settings(const RosFields& message, SonarSettings& settings) {
  settings.period_25ns = message.number(0);
  return {};
}

/// Whether numbers differ by more than a driver rounds.
bool differ(double a, double b) {
  constexpr double kRounding = 0.1;
  return std::fabs(a - b) > kRounding * std::max(std::fabs(a), std::fabs(b));
}

Beams scan_line_beam(const RosFields& message, SonarSettings&) {
  auto intensities = intensities_of(message, 2);
  if (!intensities) return NoBeam(intensities.error());
  return beam_of(message.number(1), *std::move(intensities));
}

Beams scan_line_beam_with_distances(const RosFields& message, SonarSettings& settings) {
  const std::size_t count = message.count(3);
  const double step_m =
      count < 2 ? 0.0 : (message.number(3, count - 1) - message.number(3)) / static_cast<double>(count - 1);
  if (step_m > 0.0 && differ(step_m, message.number(1))) {
    return no_beam(kContradiction, fmt::format("bin_distance_step {:.6g} does not fit bins.distance in steps of {:.6g}",
                                               message.number(1), step_m));
  }
  return scan_line_beam(message, settings);
}

/// A scan is a beam when it looks in one direction and has the profile in its intensities.
Beams laser_beam(const RosFields& message, SonarSettings&) {
  if (message.number(0) != message.number(1)) return std::vector<Beam>{};
  return range_beam_of(message.number(2), message, 3);
}

/// The step of numbers that grow evenly; nullopt: they do not.
std::optional<double> even_step(const RosFields& message, std::size_t field) {
  const std::size_t count = message.count(field);
  if (count < 3) return std::nullopt;
  const double first = message.number(field),
               step = (message.number(field, count - 1) - first) / static_cast<double>(count - 1);
  if (!(step > 0.0) || !std::isfinite(step)) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(std::fabs(message.number(field, i) - first - step * static_cast<double>(i)) <= 0.5 * step)) {
      return std::nullopt;
    }
  }
  return step;
}

/// Where the ranges of a scan are those of its intensities, they tell where the bins are.
Beams laser_beam_with_ranges(const RosFields& message, SonarSettings& settings) {
  Beams beams = laser_beam(message, settings);
  if (!beams || beams->empty() || message.count(4) != message.count(3)) return beams;
  const std::optional<double> step_m = even_step(message, 4);
  if (!step_m) return beams;
  const double first_m = message.number(4), last_m = message.number(4, message.count(4) - 1);
  if (differ(last_m, message.number(2))) {
    return no_beam(kContradiction,
                   fmt::format("range_max {:.6g} does not fit ranges up to {:.6g}", message.number(2), last_m));
  }
  // A range is that of the middle of a bin or of its end.
  constexpr double kMiddle = 0.75, kMaxBinsBefore = 1e4;
  const double before = std::round(first_m / *step_m - kMiddle);
  if (!(before >= 1.0)) return beams;
  if (before > kMaxBinsBefore) return no_beam(kImpossible);
  Beam& beam = beams->front();
  beam.bin_length_m = *step_m;
  beam.intensities.insert(beam.intensities.begin(), static_cast<std::size_t>(before), std::uint8_t{0});
  return beams;
}

/// The points of a beam: the k-th of n (from 1) at k / n of the range, at the angle as the head counts.
Beams points_beam(const RosFields& message, SonarSettings&) {
  const std::size_t count = message.count(0);
  auto intensities = intensities_of(message, 2);
  if (!intensities) return NoBeam(intensities.error());
  std::vector<std::uint8_t> samples = *std::move(intensities);
  if (samples.size() != count) {
    return no_beam(kContradiction, fmt::format("{} values of a channel do not fit {} points", samples.size(), count));
  }
  if (count == 0) return no_beam(kNoSamples);
  const double x_m = message.number(0, count - 1), y_m = message.number(1, count - 1);
  Beams beams = range_beam(std::hypot(x_m, y_m), std::move(samples));
  if (beams) beams->front().bearing_rad = wrap_bearing(std::numbers::pi - std::atan2(y_m, x_m));
  return beams;
}

/// All beams of an imaging sonar at once, in its frame: z ahead, y right, x up.
Beams image_beams(const RosFields& message, SonarSettings&) {
  constexpr double kBytes = 0.0;
  if (message.number(4) != kBytes) return no_beam(kOtherSamples);
  const std::size_t beams = message.count(0), ranges = message.count(2);
  const std::vector<std::uint8_t> samples = message.bytes(5);
  const double count = message.number(3);
  if (ranges < 2 || beams == 0) return no_beam(kNoSamples);
  if (static_cast<double>(beams) != count) {
    return no_beam(kContradiction, fmt::format("beam_count {} does not fit {} directions", count, beams));
  }
  if (samples.size() / ranges != beams || samples.size() % ranges != 0) {
    return no_beam(kContradiction,
                   fmt::format("{} samples do not fit {} ranges of {} beams", samples.size(), ranges, beams));
  }
  // A range is that of the middle of its bin.
  const double bin_length_m = (message.number(2, ranges - 1) - message.number(2)) / static_cast<double>(ranges - 1);
  const double before = std::round(message.number(2) / bin_length_m - 0.5);
  constexpr double kMaxBefore = 1e5;
  if (!(before >= -1.0 && before <= kMaxBefore)) return no_beam(kImpossible);
  const auto first = static_cast<std::size_t>(std::max(before, 0.0));
  if (first > ranges * 16) return no_beam(kImpossible);
  std::vector<Beam> found;
  for (std::size_t i = 0; i < beams; ++i) {
    std::vector<std::uint8_t> intensities(first + ranges);
    for (std::size_t j = 0; j < ranges; ++j) intensities[first + j] = samples[j * beams + i];
    auto beam = beam_of(at_assumed_speed(bin_length_m, message.number(6)), std::move(intensities));
    if (!beam) return NoBeam(beam.error());
    const double bearing_rad = std::atan2(-message.number(0, i), message.number(1, i));
    if (!std::isfinite(bearing_rad)) return no_beam(kImpossible);
    beam->front().bearing_rad = wrap_bearing(bearing_rad);
    found.push_back(std::move(beam->front()));
  }
  return found;
}

constexpr HeadAngle kHeadRadians = {AngleUnit::kRadian, -1.0, std::numbers::pi},
                    kHeadDegrees = {AngleUnit::kDegree, -1.0, std::numbers::pi},
                    kClockwiseDegrees = {AngleUnit::kDegree, -1.0, 0.0}, kRosRadians = {};

constexpr std::array kSonarTypes = {
    SonarType{{"SonarEcho", {"angle", "range", "intensities", "speed_of_sound", "number_of_samples"}},
              "ping360",
              echo_beam_with_count,
              kHeadRadians},
    SonarType{{"SonarEcho", {"angle", "range", "intensities", "speed_of_sound"}},
              "ping360",
              echo_beam_with_speed,
              kHeadRadians},
    SonarType{{"SonarEcho", {"angle", "range", "intensities"}}, "ping360", echo_beam, kHeadRadians},
    SonarType{{"Ping360", {"angle_ping360", "sample_period", "data"}}, "ping360", ping_beam},
    SonarType{{"Ping360",
               {"angle", "sample_period", "data", "number_of_samples", "mode", "gain_setting", "transmit_duration",
                "transmit_frequency"},
               "",
               "",
               RosTypeName::kOfTopic},
              "ping360",
              recorded_ping_beam},
    SonarType{
        {"Ping360_config_2", {"sample_period"}}, "ping360", ping_settings, std::nullopt, SonarType::Holds::kSettings},
    SonarType{
        {"Ping360_config", {"sample_period"}}, "ping360", ping_settings, std::nullopt, SonarType::Holds::kSettings},
    SonarType{{"ScanLine", {"angle", "bin_distance_step", "bins.intensity", "bins.distance"}},
              "micron",
              scan_line_beam_with_distances,
              kClockwiseDegrees},
    SonarType{
        {"ScanLine", {"angle", "bin_distance_step", "bins.intensity"}}, "micron", scan_line_beam, kClockwiseDegrees},
    SonarType{
        {"TritechMicronSlice", {"angle", "range", "data", "nbins"}}, "micron", slice_beam_with_count, kHeadRadians},
    SonarType{{"TritechMicronSlice", {"angle", "range", "data"}}, "micron", echo_beam, kHeadRadians},
    SonarType{{"AcousticBeam", {"angle", "range_max", "intensities"}}, "miniking", echo_beam, kHeadDegrees},
    SonarType{{"PointCloud", {"points.x", "points.y", "channels.values"}, "tritech_micron/scan"},
              "micron",
              points_beam,
              std::nullopt,
              SonarType::Holds::kBeamsToo},
    SonarType{{"LaserScan", {"angle_min", "angle_max", "range_max", "intensities", "ranges"}},
              "",
              laser_beam_with_ranges,
              kRosRadians},
    SonarType{{"LaserScan", {"angle_min", "angle_max", "range_max", "intensities"}}, "", laser_beam, kRosRadians},
    SonarType{{"ProjectedSonarImage",
               {"beam_directions.y", "beam_directions.z", "ranges", "image.beam_count", "image.dtype", "image.data",
                "ping_info.sound_speed"}},
              "",
              image_beams},
};

}  // namespace

std::span<const SonarType> sonar_types() {
  return kSonarTypes;
}

Beams beam_of_fields(const RosFields& message, const BeamFields& fields) {
  auto intensities = intensities_of(message, 2);
  if (!intensities) return NoBeam(intensities.error());
  if (fields.length_of == BeamFields::Length::kBin) return beam_of(message.number(1), *std::move(intensities));
  return range_beam(message.number(1), *std::move(intensities));
}

std::optional<AngleUnit> unit_of(const BeamFields& fields) {
  constexpr double kSame = 1e-6;
  for (const AngleUnit unit : {AngleUnit::kRadian, AngleUnit::kDegree, AngleUnit::kGradian}) {
    if (std::fabs(std::fabs(fields.angle_unit_rad) / radians_of(unit) - 1.0) < kSame) return unit;
  }
  return std::nullopt;
}

bool is_sonar(const BagTopic& topic) {
  const std::optional<KnownTopic> known = known_topic(topic, sonar_types());
  return known && sonar_types()[known->type].holds != SonarType::Holds::kSettings;
}

}  // namespace pingvox
