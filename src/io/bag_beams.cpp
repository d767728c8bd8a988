#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <set>
#include <string>
#include <tl/expected.hpp>

#include "io/bag_scans.hpp"
#include "io/bag_topics.hpp"
#include "io/device_log.hpp"
#include "io/readers.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/frame_finder.hpp"
#include "pingvox/io/ping_frame.hpp"
#include "pingvox/sonar/device_profile.hpp"

// The beams in bags: drivers' messages, by their type and fields (docs/formats.md).
namespace pingvox {
namespace {

/// Settings from a message, valid for the beams after it.
struct SonarSettings {
  std::optional<double> period_25ns;
};

/// The reason why a message is no beam.
using NoBeam = tl::unexpected<std::string_view>;
using Beams = tl::expected<std::vector<Beam>, std::string_view>;

constexpr std::string_view kNoSamples = "ping without samples", kOtherSamples = "samples that are not of 8 bits";

Beams beam_of(double bearing_rad, double bin_length_m, std::vector<std::uint8_t> intensities) {
  constexpr double kMaxAngle_rad = 1e3;  // beyond any number of turns that a driver counts
  if (intensities.size() < 2) return NoBeam(kNoSamples);
  if (!(std::fabs(bearing_rad) <= kMaxAngle_rad)) return NoBeam(kImpossible);
  return std::vector{Beam{0.0, wrap_bearing(bearing_rad), bin_length_m, std::move(intensities)}};
}

/// From angles as the head counts them, clockwise with half a turn ahead.
double bearing_of(double head_angle_rad) {
  return std::numbers::pi - head_angle_rad;
}

/// A length that a driver computed with its own speed of sound, at the assumed one, as that of all beams.
double at_assumed_speed(double length_m, double sound_speed_m_s) {
  constexpr double kSlowest_m_s = 1300.0, kFastest_m_s = 1700.0;
  const bool is_speed = sound_speed_m_s >= kSlowest_m_s && sound_speed_m_s <= kFastest_m_s;
  return is_speed ? length_m * (kAssumedSoundSpeed_m_s / sound_speed_m_s) : length_m;
}

Beams echo_beam(const RosFields& message, SonarSettings&) {
  std::vector<std::uint8_t> samples = message.bytes(2);
  const double bin_length_m = message.number(1) / static_cast<double>(samples.size());
  return beam_of(bearing_of(message.number(0)), bin_length_m, std::move(samples));
}

Beams echo_beam_with_speed(const RosFields& message, SonarSettings& settings) {
  Beams beams = echo_beam(message, settings);
  if (beams) beams->front().bin_length_m = at_assumed_speed(beams->front().bin_length_m, message.number(3));
  return beams;
}

Beams ping_beam(const RosFields& message, SonarSettings& settings) {
  const std::vector<std::uint8_t> samples = message.bytes(2);
  if (samples.size() < 2) return NoBeam(kNoSamples);  // recorded when the head did not answer
  const auto angle_grad = whole<std::uint16_t>(message.number(0));
  const auto period_25ns = whole<std::uint16_t>(settings.period_25ns.value_or(message.number(1)));
  if (!angle_grad || !period_25ns) return NoBeam(kImpossible);
  Ping360Ping ping;
  ping.angle_grad = *angle_grad;
  ping.period_25ns = *period_25ns;
  ping.data = samples;
  auto beam = pingvox::beam_of(ping, 0.0);
  if (!beam) return NoBeam(kImpossible);
  return std::vector{*std::move(beam)};
}

Beams ping_settings(const RosFields& message, SonarSettings& settings) {
  settings.period_25ns = message.number(0);
  return {};
}

Beams scan_line_beam(const RosFields& message, SonarSettings&) {
  return beam_of(-message.number(0) * kDegree_rad, message.number(1), message.bytes(2));
}

Beams slice_beam(const RosFields& message, SonarSettings&) {
  std::vector<std::uint8_t> samples = message.bytes(2);
  const double bin_length_m = message.number(1) / static_cast<double>(samples.size());
  return beam_of(bearing_of(message.number(0)), bin_length_m, std::move(samples));
}

Beams acoustic_beam(const RosFields& message, SonarSettings&) {
  std::vector<std::uint8_t> samples = message.bytes(2);
  const double bin_length_m = message.number(1) / static_cast<double>(samples.size());
  return beam_of(bearing_of(message.number(0) * kDegree_rad), bin_length_m, std::move(samples));
}

/// A scan is a beam when it looks in one direction and has the profile in its intensities.
Beams laser_beam(const RosFields& message, SonarSettings&) {
  if (message.number(0) != message.number(1)) return std::vector<Beam>{};
  std::vector<std::uint8_t> samples = message.bytes(3);
  const double bin_length_m = message.number(2) / static_cast<double>(samples.size());
  return beam_of(message.number(0), bin_length_m, std::move(samples));
}

/// The points of a beam: the k-th of n (from 1) at k / n of the range, at the angle as the head counts.
Beams points_beam(const RosFields& message, SonarSettings&) {
  const std::size_t count = message.count(0);
  std::vector<std::uint8_t> samples = message.bytes(2);
  if (samples.size() != count) return NoBeam(kImpossible);
  if (count == 0) return NoBeam(kNoSamples);
  const double x_m = message.number(0, count - 1), y_m = message.number(1, count - 1);
  const double bin_length_m = std::hypot(x_m, y_m) / static_cast<double>(count);
  return beam_of(bearing_of(std::atan2(y_m, x_m)), bin_length_m, std::move(samples));
}

/// All beams of an imaging sonar at once, in its frame: z ahead, y right, x up.
Beams image_beams(const RosFields& message, SonarSettings&) {
  constexpr double kBytes = 0.0;
  if (message.number(4) != kBytes) return NoBeam(kOtherSamples);
  const std::size_t beams = message.count(0), ranges = message.count(2);
  const std::vector<std::uint8_t> samples = message.bytes(5);
  const double count = message.number(3);
  if (ranges < 2 || beams == 0 || static_cast<double>(beams) != count || samples.size() / ranges != beams ||
      samples.size() % ranges != 0) {
    return NoBeam(kImpossible);
  }
  // A range is that of the middle of its bin.
  const double bin_length_m = (message.number(2, ranges - 1) - message.number(2)) / static_cast<double>(ranges - 1);
  const double before = std::round(message.number(2) / bin_length_m - 0.5);
  constexpr double kMaxBefore = 1e5;
  if (!(before >= -1.0 && before <= kMaxBefore)) return NoBeam(kImpossible);
  const auto first = static_cast<std::size_t>(std::max(before, 0.0));
  if (first > ranges * 16) return NoBeam(kImpossible);
  std::vector<Beam> found;
  for (std::size_t i = 0; i < beams; ++i) {
    std::vector<std::uint8_t> intensities(first + ranges);
    for (std::size_t j = 0; j < ranges; ++j) intensities[first + j] = samples[j * beams + i];
    auto beam = beam_of(std::atan2(-message.number(0, i), message.number(1, i)),
                        at_assumed_speed(bin_length_m, message.number(6)), std::move(intensities));
    if (!beam) return NoBeam(beam.error());
    found.push_back(std::move(beam->front()));
  }
  return found;
}

/// Of a driver that we do not know.
Beams beam_of_fields(const RosFields& message, const BeamFields& fields) {
  std::vector<std::uint8_t> samples = message.bytes(2);
  const double length_m = message.number(1), parts = static_cast<double>(samples.size());
  const double bin_length_m = fields.length_of == BeamFields::Length::kBin ? length_m : length_m / parts;
  return beam_of((message.number(0) - fields.ahead) * fields.angle_unit_rad, bin_length_m, std::move(samples));
}

struct SonarType {
  RosType type;
  std::string_view device;  ///< empty: unknown
  Beams (*beams_in)(const RosFields& message, SonarSettings& settings);
  enum class Holds { kBeams, kBeamsToo, kSettings } holds = Holds::kBeams;  ///< kBeamsToo: the driver's, once more
};

constexpr std::array kSonarTypes = {
    SonarType{{"SonarEcho", {"angle", "range", "intensities", "speed_of_sound"}}, "ping360", echo_beam_with_speed},
    SonarType{{"SonarEcho", {"angle", "range", "intensities"}}, "ping360", echo_beam},
    SonarType{{"Ping360", {"angle_ping360", "sample_period", "data"}}, "ping360", ping_beam},
    SonarType{{"Ping360_config_2", {"sample_period"}}, "ping360", ping_settings, SonarType::Holds::kSettings},
    SonarType{{"Ping360_config", {"sample_period"}}, "ping360", ping_settings, SonarType::Holds::kSettings},
    SonarType{{"ScanLine", {"angle", "bin_distance_step", "bins.intensity"}}, "micron", scan_line_beam},
    SonarType{{"TritechMicronSlice", {"angle", "range", "data"}}, "micron", slice_beam},
    SonarType{{"AcousticBeam", {"angle", "range_max", "intensities"}}, "miniking", acoustic_beam},
    SonarType{{"PointCloud", {"points.x", "points.y", "channels.values"}, "tritech_micron/scan"},
              "micron",
              points_beam,
              SonarType::Holds::kBeamsToo},
    SonarType{{"LaserScan", {"angle_min", "angle_max", "range_max", "intensities"}}, "", laser_beam},
    SonarType{{"ProjectedSonarImage",
               {"beam_directions.y", "beam_directions.z", "ranges", "image.beam_count", "image.dtype", "image.data",
                "ping_info.sound_speed"}},
              "",
              image_beams},
};

/// Whether messages of the topic are beams that the driver sends in another topic, too.
bool is_second_sonar(const BagTopic& topic) {
  const std::optional<KnownTopic> known = known_topic(topic, kSonarTypes);
  return known && kSonarTypes[known->type].holds == SonarType::Holds::kBeamsToo;
}

class BagBeams final : public DeviceLog {
 public:
  BagBeams(std::unique_ptr<Bag> bag, Damage damage, BeamTopic wanted)
      : bag_(std::move(bag)), damage_(damage), wanted_(std::move(wanted.name)), fields_(std::move(wanted.fields)) {}

  enum class Start { kBeam, kScan, kNothing };

  /// Reads to the first beam, or the first scan of the wanted topic.
  Result<Start> start() {
    Result<std::optional<Beam>> first = read();
    if (!first) return tl::unexpected(first.error());
    if (scan_) return Start::kScan;
    if (!*first) return Start::kNothing;
    set_first(std::move(first));
    return Start::kBeam;
  }

  /// Goes on with the scans of the topic. REQUIRES that one was met at the start.
  Result<std::unique_ptr<ScanSource>> into_scans() && { return bag_scans(std::move(bag_), damage_, wanted_, scan_); }

  /// Names and types of the topics that may have scans where no topic has beams; empty: there are none.
  std::string scan_topics() const {
    const bool has_fields_or_topic = fields_ || !wanted_.empty();
    if (has_fields_or_topic || !topics_text(*bag_, is_second_sonar).empty()) return {};
    return topics_text(*bag_, may_have_scans);
  }

  /// REQUIRES that there are no beams.
  tl::unexpected<Error> no_beams() const { return fail(Error::Code::kUnsupported, why_none()); }

  std::vector<DamageKind> damage() const override { return damage_of(*bag_, unusable_); }
  std::optional<double> share_read() const override { return bag_->share_read(); }
  const std::string& name() const { return bag_->name(); }

 private:
  Result<std::optional<Beam>> read() override {
    while (beams_.empty() && !scan_) {
      const Result<std::optional<BagMessage>> message = bag_->next();
      if (!message) return tl::unexpected(message.error());
      if (damage_ == Damage::kFail && !bag_->damage().empty()) return damage_error(bag_->damage().front());
      if (!*message) return std::nullopt;
      if (const Result<void> added = add(**message); !added) return tl::unexpected(added.error());
      if (damage_ == Damage::kFail && !unusable_.empty()) return damage_error(unusable_.front());
    }
    if (scan_) return std::nullopt;
    Beam beam = std::move(beams_.front());
    beams_.pop_front();
    return beam;
  }

  Result<void> add(const BagMessage& message) {
    while (topics_.size() <= message.topic) {
      const BagTopic& next = bag_->topics()[topics_.size()];
      topics_.push_back(sonar_topic(next));
      scan_topics_.push_back(next.name == wanted_ && !fields_ ? scan_topic(next) : std::nullopt);
    }
    const std::optional<KnownTopic>& topic = topics_[message.topic];
    const std::string& name = bag_->topics()[message.topic].name;
    if (!topic && fields_ && name == wanted_) return missing_field(bag_->topics()[message.topic]);
    if (is_wanted_scan(message)) {
      scan_ = message;
      return {};
    }
    if (!topic) return {};
    const SonarType& type = kSonarTypes[topic->type];
    if (!fields_ && is_unwanted(type, name)) return {};
    if (!message_.read(*topic->layout, message.bytes)) {
      add_damage(unusable_, kNoFit, message.file_byte);
      return {};
    }
    const RosFields values(message_, topic->fields);
    Beams beams = fields_ ? beam_of_fields(values, *fields_) : type.beams_in(values, settings_);
    if (!beams) {
      add_damage(unusable_, beams.error(), message.file_byte);
      return {};
    }
    if (beams->empty()) return {};
    const double time_s = topic->time_of(message_, message.time_s);
    for (Beam& beam : *beams) {
      beam.time_s = time_s;
      if (!validate(beam)) {
        add_damage(unusable_, kImpossible, message.file_byte);
        return {};
      }
    }
    if (chosen_.empty()) chosen_ = name;
    if (name != chosen_) return several_topics(*bag_, "beams", is_sonar);
    if (!fields_) device_ = find_device(type.device);
    beams_.insert(beams_.end(), std::make_move_iterator(beams->begin()), std::make_move_iterator(beams->end()));
    return {};
  }

  bool is_wanted_scan(const BagMessage& message) const {
    const std::optional<KnownTopic>& topic = scan_topics_[message.topic];
    return topic && chosen_.empty() && is_scan(*topic, message);
  }

  bool is_unwanted(const SonarType& type, const std::string& name) const {
    if (type.holds == SonarType::Holds::kSettings || name == wanted_) return false;
    return !wanted_.empty() || type.holds == SonarType::Holds::kBeamsToo;
  }

  std::optional<KnownTopic> sonar_topic(const BagTopic& topic) const {
    if (!fields_) return known_topic(topic, kSonarTypes);
    if (topic.name != wanted_ || !topic.is_readable) return std::nullopt;
    return topic_with(topic, std::array<std::string_view, 3>{fields_->angle, fields_->length, fields_->intensities});
  }

  tl::unexpected<Error> missing_field(const BagTopic& topic) const {
    const auto layout = topic.layout ? topic.layout : shared_layout(topic.type, {}, topic.encoding);
    return fail(Error::Code::kBadOption,
                fmt::format("{}: {} ({}) lacks a field of {}, {}, {}{}", bag_->name(), topic.name, topic.type,
                            fields_->angle, fields_->length, fields_->intensities,
                            layout ? fmt::format(": it has {}", fields_text(*layout))
                                   : std::string(" and cannot be read: its definition is not in the bag")));
  }

  std::string why_none() const {
    if (!unusable_.empty()) {
      const DamageKind& first = unusable_.front();
      return fmt::format("{}: none of its messages can be used as a beam: {} x {}", bag_->name(), first.count,
                         first.what);
    }
    const std::string second = topics_text(*bag_, is_second_sonar);
    const std::string others =
        topics_text(*bag_, [](const BagTopic& topic) { return is_sonar(topic) || may_have_scans(topic); });
    if (!wanted_.empty()) {
      return fmt::format("{}: has no beams or scans in the topic {}{}", bag_->name(), wanted_,
                         others.empty() ? "" : ", only in " + others);
    }
    if (!second.empty()) return fmt::format("{}: choose the topic of its beams with --topic: {}", bag_->name(), second);
    return fmt::format("{}: is a ROS bag without beams of a sonar that we know{}", bag_->name(),
                       damage().empty() ? "" : ", or it is damaged");
  }

  tl::unexpected<Error> damage_error(const DamageKind& kind) const {
    return fail(Error::Code::kCorrupt, fmt::format("{}: {}", bag_->name(), first_damage_text(kind)));
  }

  std::unique_ptr<Bag> bag_;
  Damage damage_;
  std::string wanted_, chosen_;
  std::optional<BeamFields> fields_;
  std::vector<std::optional<KnownTopic>> topics_;
  std::vector<std::optional<KnownTopic>> scan_topics_;  ///< of each topic, where it is the wanted one
  SonarSettings settings_;
  RosMessage message_;
  std::deque<Beam> beams_;
  std::optional<BagMessage> scan_;  ///< the first of the wanted topic
  std::vector<DamageKind> unusable_;
};

}  // namespace

std::optional<KnownTopic> topic_with(const BagTopic& topic, std::span<const std::string_view> paths) {
  // Some writers leave only a part of the definition; a common type has another.
  for (const bool is_common : {false, true}) {
    std::shared_ptr<const RosLayout> layout = is_common ? shared_layout(topic.type, {}, topic.encoding) : topic.layout;
    if (!layout) continue;
    std::vector<std::size_t> fields;
    bool has_all = true;
    for (const std::string_view path : paths) {
      if (path.empty()) break;
      const std::optional<std::size_t> field = layout->field(path);
      has_all = has_all && field;
      fields.push_back(field.value_or(0));
    }
    if (!has_all) continue;
    const bool has_stamp = layout->field("header.stamp.sec").has_value();
    const std::string stamp = has_stamp ? "header.stamp." : "transforms.header.stamp.";
    const auto stamp_s = layout->field(stamp + "sec"), stamp_ns = layout->field(stamp + "nanosec");
    return KnownTopic{0, std::move(layout), std::move(fields), stamp_s, stamp_ns};
  }
  return std::nullopt;
}

std::vector<DamageKind> damage_of(const Bag& bag, const std::vector<DamageKind>& unusable) {
  std::vector<DamageKind> kinds = bag.damage();
  kinds.insert(kinds.end(), unusable.begin(), unusable.end());
  return kinds;
}

std::string topics_text(const Bag& bag, bool (*is_of_kind)(const BagTopic&)) {
  std::set<std::string> names;
  for (const BagTopic& topic : bag.topics()) {
    if (is_of_kind(topic)) names.insert(fmt::format("{} ({})", topic.name, topic.type));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

tl::unexpected<Error> several_topics(const Bag& bag, std::string_view what, bool (*is_of_kind)(const BagTopic&)) {
  return fail(Error::Code::kBadOption, fmt::format("{}: holds several topics with {}: {}: choose one with --topic",
                                                   bag.name(), what, topics_text(bag, is_of_kind)));
}

bool is_sonar(const BagTopic& topic) {
  const std::optional<KnownTopic> known = known_topic(topic, kSonarTypes);
  return known && kSonarTypes[known->type].holds != SonarType::Holds::kSettings;
}

Result<std::unique_ptr<Bag>> open_bag(ByteStream stream) {
  if (looks_like_ros1_bag(stream.beginning())) return open_ros1_bag(std::move(stream));
  if (looks_like_mcap(stream.beginning())) return open_mcap(std::move(stream));
  return open_sqlite_bag(std::move(stream));
}

Result<BagLog> open_any_bag(ByteStream stream, Damage damage, const BeamTopic& topic) {
  if (topic.fields && topic.name.empty()) {
    return fail(Error::Code::kBadOption,
                fmt::format("{}: --fields: needs the --topic whose messages have them", stream.name()));
  }
  const std::optional<std::string> path = stream.path();
  std::optional<FileBytes> bytes;
  if (stream.is_all_held() && topic.name.empty()) bytes = stream.held();
  Result<std::unique_ptr<Bag>> bag = open_bag(std::move(stream));
  if (!bag) return tl::unexpected(bag.error());
  auto beams = std::make_unique<BagBeams>(*std::move(bag), damage, topic);
  const Result<BagBeams::Start> start = beams->start();
  if (!start) return tl::unexpected(start.error());
  const auto as_log = [](std::unique_ptr<ScanSource> scans) { return BagLog(std::move(scans)); };
  if (*start == BagBeams::Start::kBeam) return BagLog(std::move(beams));
  if (*start == BagBeams::Start::kScan) return std::move(*beams).into_scans().map(as_log);
  const std::string scan_topics = beams->scan_topics();
  if (scan_topics.empty()) return beams->no_beams();
  if (!path && !bytes) {
    return fail(Error::Code::kBadOption,
                fmt::format("{}: choose the topic of its scans with --topic, as it can be read only once: {}",
                            beams->name(), scan_topics));
  }
  // Beams may have come behind the first scans.
  const tl::unexpected<Error> no_beams = beams->no_beams();
  beams.reset();
  Result<std::unique_ptr<ScanSource>> scans =
      (path ? ByteStream::open(*path) : Result<ByteStream>(*std::move(bytes)))
          .and_then(open_bag)
          .and_then([&](std::unique_ptr<Bag> again) { return bag_scans(std::move(again), damage, topic.name); });
  if (!scans && scans.error().code == Error::Code::kUnsupported) return no_beams;
  return std::move(scans).map(as_log);
}

}  // namespace pingvox
