#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "io/bags/bag_scans.hpp"
#include "io/bags/bag_topics.hpp"
#include "io/bags/sonar_messages.hpp"
#include "io/bags/stamped_queue.hpp"
#include "io/beams/device_log.hpp"
#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"
#include "io/readers.hpp"
#include "nav/internal/nav_frames.hpp"
#include "pingvox/sonar/device_profile.hpp"

// The beams in bags: drivers' messages, by their type and fields (docs/formats.md).
namespace pingvox {
namespace {

/// Beams whose angles are not understood yet.
class HeldBeams {
 public:
  explicit HeldBeams(const HeadAngle& angle) : angle_(angle), units_(angle.unit) {}

  void add(Beam beam, double angle) {
    bytes_ += beam.intensities.size();
    units_.add(angle);
    beams_.emplace_back(std::move(beam), angle);
  }
  bool are_enough() const {
    constexpr std::size_t kMaxBytes = 64U << 20U;
    return bytes_ >= kMaxBytes || units_.are_enough();
  }
  const AngleUnits& units() const { return units_; }
  const HeadAngle& angle() const { return angle_; }
  std::vector<std::pair<Beam, double>> take() { return std::move(beams_); }

 private:
  HeadAngle angle_;
  AngleUnits units_;
  std::size_t bytes_ = 0;
  std::vector<std::pair<Beam, double>> beams_;
};

/// Beyond any number of turns that a driver counts.
constexpr double kMaxCounted_rad = 1e3;

/// Turns beams by angles of a known unit.
struct KnownAngle {
  HeadAngle angle;
  double unit_rad = 1.0;
  double max_rad = 3.0 * std::numbers::pi;  ///< a turn, and any angle ahead; more where turns are counted
  double last_rad = 0.0;

  /// false: the angle is not possible.
  bool turn(Beam& beam, double number) {
    constexpr double kMaxStep_rad = 0.5;
    const double angle_rad = number * unit_rad;
    const bool goes_on = std::fabs(angle_rad - last_rad) <= kMaxStep_rad;
    if (!(std::fabs(angle_rad) <= (goes_on ? kMaxCounted_rad : max_rad))) return false;
    last_rad = angle_rad;
    beam.bearing_rad = wrap_bearing(angle.turn * (angle_rad - angle.ahead_rad));
    return true;
  }
};

/// Whether messages of the topic are beams that the driver sends in another topic, too.
bool is_second_sonar(const BagTopic& topic) {
  const std::optional<KnownTopic> known = known_topic(topic, sonar_types());
  return known && sonar_types()[known->type].holds == SonarType::Holds::kBeamsToo;
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
  std::string first_damage() const override { return first_damage_of(*bag_, unusable_); }
  std::string note() const override {
    return joined_notes(note_, queue_.stamps_stand_still() ? note_of_stamps(chosen_) : "");
  }
  std::optional<double> share_read() const override { return bag_->share_read(); }
  const std::string& name() const { return bag_->name(); }

 private:
  Result<std::optional<Beam>> read() override {
    while (beams_.empty() && !scan_ && !has_ended_) {
      const Result<std::optional<BagMessage>> message = bag_->next();
      if (!message) return tl::unexpected(message.error());
      has_ended_ = !*message;
      if (damage_ == Damage::kFail && !bag_->damage().empty()) return damage_error();
      const Result<void> added = has_ended_ ? add_last() : add(**message);
      if (!added) return tl::unexpected(added.error());
      if (damage_ == Damage::kFail && !unusable_.empty()) return damage_error();
    }
    if (beams_.empty()) return std::nullopt;
    Beam beam = std::move(beams_.front());
    beams_.pop_front();
    return beam;
  }

  /// The angle of a driver that we do not know, less the one ahead.
  HeadAngle by_fields() {
    const std::optional<AngleUnit> unit = unit_of(*fields_);
    const HeadAngle angle{unit.value_or(AngleUnit::kRadian), fields_->angle_unit_rad < 0.0 ? -1.0 : 1.0, 0.0};
    if (!unit && !known_angle_) known_angle_ = KnownAngle{angle, std::fabs(fields_->angle_unit_rad), kMaxCounted_rad};
    return angle;
  }

  /// The beams of a message, and its first field where that turns them.
  struct MessageBeams {
    std::vector<Beam> beams;
    std::optional<std::pair<double, HeadAngle>> angle;
    std::optional<std::uint64_t> file_byte;
  };

  /// Adds the beams whose times are known.
  Result<void> add_known() {
    while (auto known = queue_.take()) {
      auto& [message, later_s] = *known;
      for (Beam& beam : message.beams) beam.time_s += later_s;
      if (message.angle) {
        const auto& [angle, documented] = *message.angle;
        const auto added = add_turned(std::move(message.beams.front()), angle, documented, message.file_byte);
        if (!added) return added;
      } else {
        beams_.insert(beams_.end(), std::make_move_iterator(message.beams.begin()),
                      std::make_move_iterator(message.beams.end()));
      }
    }
    return {};
  }

  /// Adds what was held back, at the end of the log.
  Result<void> add_last() {
    queue_.end();
    if (const auto added = add_known(); !added) return added;
    return turn_held();
  }

  /// Turns a beam by the first field of its message, once enough of them tell in which unit it is.
  Result<void> add_turned(Beam beam, double angle, const HeadAngle& documented,
                          std::optional<std::uint64_t> file_byte) {
    constexpr double kAny = 1e6;  // what is no angle in any unit
    if (!(std::fabs(angle) <= kAny)) {
      unusable_.add({kImpossible, fmt::format("an angle of {:.6g}", angle)}, file_byte);
      return {};
    }
    if (!known_angle_) {
      if (!held_) held_.emplace(documented);
      held_->add(std::move(beam), angle);
      return held_->are_enough() ? turn_held() : Result<void>{};
    }
    if (known_angle_->turn(beam, angle)) {
      beams_.push_back(std::move(beam));
    } else {
      unusable_.add({kImpossible, fmt::format("an angle of {:.6g}", angle)}, file_byte);
    }
    return {};
  }

  /// Finds the unit of the angles so far, and turns their beams.
  Result<void> turn_held() {
    if (!held_) return {};
    HeldBeams held = *std::exchange(held_, std::nullopt);
    const AngleUnit documented = held.angle().unit;
    const std::optional<AngleUnit> unit = held.units().unit();
    const std::string wrong = fmt::format("the angles in {}, {}, cannot be {}", in_ascii(chosen_),
                                          held.units().range_text(), name_of(documented));
    if (!unit) {
      return fail(Error::Code::kUnsupported,
                  fmt::format("{}: {}: they may be degrees or gradians, which is ambiguous", bag_->name(), wrong));
    }
    if (fields_ && unit != documented) {
      return fail(Error::Code::kUnsupported,
                  fmt::format("{}: {}, as is stated: they seem to be {}", bag_->name(), wrong, name_of(*unit)));
    }
    if (unit != documented) note_ = fmt::format("{}, as is documented: read as {}", wrong, name_of(*unit));
    known_angle_ = KnownAngle{held.angle(), radians_of(*unit)};
    if (held.units().count_turns()) known_angle_->max_rad = kMaxCounted_rad;
    for (auto& [beam, angle] : held.take()) {
      if (known_angle_->turn(beam, angle)) {
        beams_.push_back(std::move(beam));
      } else {
        unusable_.add({kImpossible, fmt::format("an angle of {:.6g}", angle)}, std::nullopt);
      }
    }
    return {};
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
    const SonarType& type = sonar_types()[topic->type];
    if (!fields_ && is_unwanted(type, name)) return {};
    if (!message_.read(*topic->layout, message.bytes)) {
      unusable_.add({kNoFit}, message.file_byte);
      return {};
    }
    const RosFields values(message_, topic->fields);
    Beams beams = fields_ ? beam_of_fields(values, *fields_) : type.beams_in(values, settings_);
    if (!beams) {
      unusable_.add(beams.error(), message.file_byte);
      return {};
    }
    if (beams->empty()) return {};
    const double time_s = topic->time_of(message_, message.time_s);
    for (Beam& beam : *beams) {
      beam.time_s = time_s;
      if (const auto valid = validate(beam); !valid) {
        unusable_.add({kImpossible, valid.error().message}, message.file_byte);
        return {};
      }
    }
    if (chosen_.empty()) chosen_ = name;
    if (name != chosen_) return several_topics(*bag_, "beams", is_sonar);
    const std::string frame = in_ascii(topic->frame_of(message_));
    if (!is_of_first_head(number_of_frame(frame))) {
      unusable_.add({kOtherHead, fmt::format("a beam of {}, where the first are of {}", frame, frames_.front())},
                    message.file_byte);
      return {};
    }
    if (!fields_) device_ = find_device(type.device);
    std::optional<std::pair<double, HeadAngle>> turned;
    if (fields_) {
      turned.emplace(values.number(0) - fields_->ahead, by_fields());
    } else if (type.angle) {
      // The angles of a LaserScan are about z of its frame, those of other drivers are the head's own.
      const bool is_frd = type.type.name == "LaserScan" && axes_of(topic->frame_of(message_)) == FrameAxes::kDown;
      turned.emplace(is_frd ? -values.number(0) : values.number(0), *type.angle);
    }
    queue_.add({*std::move(beams), turned, message.file_byte}, {time_s, message.time_s});
    return add_known();
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
    if (!fields_) return known_topic(topic, sonar_types());
    if (topic.name != wanted_ || !topic.is_readable) return std::nullopt;
    return topic_with(topic, std::array<std::string_view, 3>{fields_->angle, fields_->length, fields_->intensities});
  }

  /// Heads of one topic are told apart by the frames of their messages.
  unsigned number_of_frame(const std::string& frame) {
    constexpr std::size_t kMaxKnown = 64;
    const auto known = std::ranges::find(frames_, frame);
    const auto number = static_cast<unsigned>(known - frames_.begin());
    if (known == frames_.end() && frames_.size() < kMaxKnown) frames_.push_back(frame);
    return number;
  }

  tl::unexpected<Error> missing_field(const BagTopic& topic) const {
    if (!topic.other_encoding.empty()) return no_beams();
    const auto layout = topic.layout ? topic.layout : shared_layout(topic.type, {}, topic.encoding);
    return fail(Error::Code::kBadOption,
                fmt::format("{}: {} ({}) lacks a field of {}, {}, {}{}", bag_->name(), topic.name, topic.type,
                            fields_->angle, fields_->length, fields_->intensities,
                            layout ? fmt::format(": it has {}", fields_text(*layout))
                                   : std::string(" and cannot be read: its definition is not in the bag")));
  }

  std::string why_none() const {
    if (!unusable_.empty()) {
      const DamageKind& first = unusable_.kinds().front();
      const bool has_more = !unusable_.first_text().ends_with(first.what);
      return fmt::format("{}: none of its messages can be used as a beam: {} x {}{}", bag_->name(), first.count,
                         first.what, has_more ? ", the first: " + unusable_.first_text() : "");
    }
    if (std::string encoding = other_encoding_text(); !encoding.empty()) return encoding;
    const std::string second = topics_text(*bag_, is_second_sonar);
    const std::string others =
        topics_text(*bag_, [](const BagTopic& topic) { return is_sonar(topic) || may_have_scans(topic); });
    if (!wanted_.empty()) {
      return fmt::format("{}: has no beams or scans in the topic {}{}", bag_->name(), wanted_,
                         others.empty() ? "" : ", only in " + others);
    }
    if (!second.empty()) return fmt::format("{}: choose the topic of its beams with --topic: {}", bag_->name(), second);
    return fmt::format("{}: is a bag without beams of a sonar that we know{}", bag_->name(),
                       damage().empty() ? "" : ", or it is damaged");
  }

  /// Names messages, of the wanted topic if there is one, in an encoding that is not read; empty: there are none.
  std::string other_encoding_text() const {
    const std::vector<BagTopic>& topics = bag_->topics();
    const auto other = std::ranges::find_if(topics, [&](const BagTopic& topic) {
      return !topic.other_encoding.empty() && (wanted_.empty() || topic.name == wanted_);
    });
    if (other == topics.end()) return {};
    return fmt::format("{}: holds messages in the encoding '{}', which is not read: {}", bag_->name(),
                       other->other_encoding,
                       topics_text(*bag_, [](const BagTopic& topic) { return !topic.other_encoding.empty(); }));
  }

  tl::unexpected<Error> damage_error() const {
    return fail(Error::Code::kCorrupt, fmt::format("{}: {}", bag_->name(), first_damage()));
  }

  std::unique_ptr<Bag> bag_;
  Damage damage_;
  std::string wanted_, chosen_;
  std::optional<BeamFields> fields_;
  std::vector<std::optional<KnownTopic>> topics_;
  std::vector<std::optional<KnownTopic>> scan_topics_;  ///< of each topic, where it is the wanted one
  std::vector<std::string> frames_;                     ///< of the beams so far
  SonarSettings settings_;
  RosMessage message_;
  std::optional<HeldBeams> held_;
  std::optional<KnownAngle> known_angle_;
  std::string note_;
  StampedQueue<MessageBeams> queue_;
  std::deque<Beam> beams_;
  bool has_ended_ = false;
  std::optional<BagMessage> scan_;  ///< the first of the wanted topic
  UnusableMessages unusable_;
};

}  // namespace

std::unique_ptr<BeamSource> beams_of(std::unique_ptr<Bag> bag) {
  // Messages that a driver sends once more have to be wanted; scans must not be.
  BeamTopic wanted;
  if (is_second_sonar(bag->topics().front())) wanted.name = bag->topics().front().name;
  return std::make_unique<BagBeams>(std::move(bag), Damage::kSkip, std::move(wanted));
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
