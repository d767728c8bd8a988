#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "base/median.hpp"
#include "base/without_exceptions.hpp"
#include "io/bags/bag_mavlink.hpp"
#include "io/bags/bag_scans.hpp"
#include "io/bags/bag_topics.hpp"
#include "io/bags/nav_messages.hpp"
#include "io/bags/sonar_messages.hpp"
#include "io/bags/stamped_queue.hpp"
#include "io/bags/tf_tree.hpp"
#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"
#include "io/nav/nav_fields.hpp"
#include "io/nav/nav_readers.hpp"
#include "io/nav/nav_sources.hpp"
#include "nav/internal/pressure_unit.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/bag.hpp"
#include "pingvox/nav/device_clock.hpp"

// The navigation in bags, by type and fields of the messages (docs/formats.md).
namespace pingvox {
namespace {

constexpr std::size_t kMaxFramesOfTopic = 16;
constexpr std::string_view kStaticTf = "_static";  ///< end of the name of a topic
constexpr std::string_view kTooManyFrames = "message in one of more than 16 frames of a topic";

/// Gathers the topics and the navigation of a bag.
class BagSurvey {
 public:
  BagSurvey(Bag& bag, std::span<const NavFields> fields) : bag_(bag), fields_(fields) {}

  Result<void> add(const BagMessage& message) {
    if (const auto added = add_topics(); !added) return added;
    Topic& topic = topics_[message.topic];
    BagTopicSummary& summary = summaries_[topic.summary];
    using Use = BagTopicSummary::Use;
    const bool is_first = ++summary.messages == 1;
    summary.from_s = is_first ? message.time_s : std::min(summary.from_s, message.time_s);
    summary.to_s = is_first ? message.time_s : std::max(summary.to_s, message.time_s);
    if (is_first && summary.use == Use::kBeams && topic.scans && is_scan(*topic.scans, message)) {
      summary.use = Use::kScans;
    }
    if (summary.use == Use::kBeams || summary.use == Use::kScans) {
      if (is_first) summary.frame = frame_in(bag_.topics()[message.topic], message);
      note_lag(message, topic);
    }
    if (topic.mavlink != MavlinkTopic::kNone) {
      if (!mavlink_.add(message, topic.mavlink)) unusable_.add({kNoFit}, message.file_byte);
      return {};
    }
    if (!topic.known) return {};
    if (!message_.read(*topic.known->layout, message.bytes)) {
      unusable_.add({kNoFit}, message.file_byte);
      return {};
    }
    ++records_;
    const NavType* const type = topic.readers.empty() ? &nav_types()[topic.known->type] : nullptr;
    if (type != nullptr && type->frame_id == FrameId::kOfTransforms) {
      add_to_tree(message, topic);
      return {};
    }
    const NavOrigin origin =
        type != nullptr ? origin_of(type->frame_id, *topic.known, message_) : origin_by_name(*topic.known, message_);
    const std::optional<std::string> name = name_of_source(topic, origin);
    if (!name) {
      unusable_.add({kTooManyFrames}, message.file_byte);
      return {};
    }
    for (const NavReader& reader : topic.readers) {
      reader.add(message_, *topic.known, message.time_s, *name, sources_, origin);
    }
    if (type == nullptr) return {};
    const MessageTime time{topic.known->time_of(message_, message.time_s), message.time_s};
    topic.state.times.push_back(time);
    topic.state.stamps.add(time);
    if (const auto stamp_s = topic.known->stamp_of(message_)) note_span(topic, {*stamp_s, message.time_s});
    NavSamples samples(sources_, *name, time.stamp_s, topic.state, origin);
    type->add(RosFields(message_, topic.known->fields), samples);
    return {};
  }

  std::vector<DamageKind> damage() const { return damage_of(bag_, unusable_); }

  Result<BagContents> finish() {
    if (const auto added = add_topics(); !added) return tl::unexpected(added.error());
    std::vector<NavSource> sources = sources_.take();
    set_times(sources);
    use_recorded_times(sources);
    tell_pressures(sources, named_by_fields());
    for (const auto& [name, tree] : trees_) std::ranges::move(tree.paths(name), std::back_inserter(sources));
    doubt_accelerations(sources);
    turn_frames(sources);
    NavReading mavlink;
    mavlink_.finish(mavlink);
    std::ranges::move(mavlink.sources, std::back_inserter(sources));
    Result<NavLog> log = NavLog::make(std::move(sources), NavClock::kUnix);
    if (!log) return fail(log.error().code, fmt::format("{}: {}", bag_.name(), log.error().message));
    NavFile nav{*std::move(log),          records_ + mavlink.records,  damage(),
                std::move(mavlink.notes), std::move(mavlink.settings), std::move(mavlink.runs)};
    if (std::string note = lag_note(); !note.empty()) nav.notes.push_back(std::move(note));
    if (std::string note = speed_note(); !note.empty()) nav.notes.push_back(std::move(note));
    if (std::string note = stopped_pose_note(); !note.empty()) nav.notes.push_back(std::move(note));
    BagContents contents{std::move(summaries_), std::move(nav), {}};
    add_mounts(contents);
    return contents;
  }

 private:
  struct Topic {
    std::size_t summary;
    std::optional<KnownTopic> known, scans;
    std::vector<NavReader> readers;  ///< by the fields that were named; none: by the type
    NavTopicState state;
    MavlinkTopic mavlink = MavlinkTopic::kNone;
    std::optional<KnownTopic> stamped = std::nullopt;  ///< of a sonar, where its messages have stamps
    std::vector<double> lags_s = {};                   ///< how long after their stamps its messages were recorded
    std::optional<std::pair<MessageTime, MessageTime>> span = std::nullopt;  ///< first and last, with their own stamps
  };

  /// Where the pose that a topic repeats was the same for so long that nothing came from the autopilot. Empty: nowhere.
  std::string stopped_pose_note() const {
    constexpr double kLongest_s = 1.0;
    for (const Topic& topic : topics_) {
      const RepeatedPose& pose = topic.state.pose;
      if (pose.longest_s <= kLongest_s) continue;
      return fmt::format(
          "{} repeats one pose for {:.1f} s, from {:.3f} s on: nothing came from the autopilot, and the vehicle's pose "
          "is "
          "not known",
          in_ascii(summaries_[topic.summary].name), pose.longest_s, pose.longest_from_s);
    }
    return {};
  }

  static void note_span(Topic& topic, const MessageTime& time) {
    if (!topic.span) topic.span.emplace(time, time);
    topic.span->second = time;
  }

  /// Where stamps that are not used, as they are far from the recording, go faster or slower than it: a bag that was
  /// played at another speed and recorded again. Empty: nowhere.
  std::string speed_note() const {
    constexpr std::size_t kMinMessages = 10;
    constexpr double kFar_s = 60.0, kShortest_s = 2.0, kMinTimes = 0.9, kMaxTimes = 1.1;
    for (const Topic& topic : topics_) {
      if (!topic.span || topic.state.times.size() < kMinMessages || topic.state.stamps.mostly_stand_still()) continue;
      const auto& [first, last] = *topic.span;
      const double stamped_s = last.stamp_s - first.stamp_s, recorded_s = last.recorded_s - first.recorded_s;
      const bool are_far = std::fabs(first.stamp_s - first.recorded_s) > kFar_s;
      const bool are_dates = first.stamp_s >= kFirstDate_s && first.recorded_s >= kFirstDate_s;
      if (!are_far || !are_dates || std::min(stamped_s, recorded_s) < kShortest_s) continue;
      const double times = stamped_s / recorded_s;
      if (times >= kMinTimes && times <= kMaxTimes) continue;
      return fmt::format(
          "the stamps of {} go {:.3g} times as fast as the recording, whose times are used: was it played at another "
          "speed and recorded again? Then all speeds are wrong",
          in_ascii(summaries_[topic.summary].name), times);
    }
    return {};
  }

  /// Notes how long after its stamp a message of a sonar was recorded.
  void note_lag(const BagMessage& message, Topic& topic) {
    constexpr std::size_t kEnough = 200;
    if (topic.lags_s.size() >= kEnough) return;
    const BagTopic& of = bag_.topics()[message.topic];
    if (!topic.stamped && of.is_readable) topic.stamped = topic_with(of, {});
    if (!topic.stamped || !message_.read(*topic.stamped->layout, message.bytes)) return;
    const MessageTime time{topic.stamped->time_of(message_, message.time_s), message.time_s};
    topic.state.stamps.add(time);
    topic.lags_s.push_back(time.recorded_s - time.stamp_s);
  }

  /// Where messages of a sonar were recorded seconds later after their stamps than those of navigation, or earlier: one
  /// of the two clocks is wrong, or one of the two topics was stamped late. Empty: nowhere.
  std::string lag_note() const {
    constexpr std::size_t kMinMessages = 10;
    constexpr double kApart_s = 2.0, kYears_s = 1e8;
    for (const Topic& sonar : topics_) {
      if (sonar.lags_s.size() < kMinMessages || sonar.state.stamps.stand_still()) continue;
      const double sonar_s = median(sonar.lags_s);
      for (const Topic& nav : topics_) {
        if (nav.state.times.size() < kMinMessages || nav.state.stamps.mostly_stand_still()) continue;
        std::vector<double> lags_s;
        for (const MessageTime& time : nav.state.times) lags_s.push_back(time.recorded_s - time.stamp_s);
        const double nav_s = median(std::move(lags_s));
        // Of a recorder without dates: the stamps of both are used.
        const bool are_stamps = std::max(sonar_s, nav_s) < -kYears_s;
        if (are_stamps || std::fabs(sonar_s - nav_s) <= kApart_s) continue;
        return fmt::format(
            "messages of {} are recorded {:.1f} s after their stamps, those of {} {:.1f} s after: if one "
            "of the clocks is wrong, beams and path do not belong together",
            in_ascii(summaries_[sonar.summary].name), sonar_s, in_ascii(summaries_[nav.summary].name), nav_s);
      }
    }
    return {};
  }

  /// Gives samples of topics whose stamps stand still the times of the recording.
  void use_recorded_times(std::span<NavSource> sources) const {
    for (const Topic& topic : topics_) {
      const std::vector<MessageTime>& times = topic.state.times;
      if (!topic.state.stamps.mostly_stand_still() || !topic.state.report_times.empty()) continue;
      const std::string& name = summaries_[topic.summary].name;
      for (NavSource& source : sources) {
        if (source.name != name && !source.name.starts_with(name + ":")) continue;
        // Each message has as many samples of a source.
        const std::size_t count = source.samples.size();
        for (std::size_t i = 0; i < count; ++i) source.samples[i].time_s = times[i * times.size() / count].recorded_s;
        source.note = joined_notes(source.note, note_of_stamps(name));
      }
    }
  }

  /// Doubts the attitudes of Imus whose acceleration points down, but for those whose frame says that z does.
  void doubt_accelerations(std::span<NavSource> sources) const {
    constexpr std::size_t kMinMessages = 10, kMinTimes = 20;
    for (const Topic& topic : topics_) {
      const NavTopicState& state = topic.state;
      if (state.downward < kMinMessages || state.downward < kMinTimes * state.upward) continue;
      for (NavSource& source : sources) {
        if (source.name != summaries_[topic.summary].name || source.quantity != NavQuantity::kAttitude) continue;
        if (axes_of(source.child) == FrameAxes::kDown) continue;
        source.doubt = "its acceleration points down by its attitude: are its axes north, east, down?";
      }
    }
  }

  /// The topic; messages in other frames than its first are of another source. nullopt: of too many.
  std::optional<std::string> name_of_source(Topic& topic, const NavOrigin& origin) const {
    const std::string& name = summaries_[topic.summary].name;
    std::vector<NavOrigin>& known = topic.state.origins;
    const auto same = std::ranges::find_if(
        known, [&](const NavOrigin& one) { return one.frame == origin.frame && one.child == origin.child; });
    if (same == known.end() && known.size() >= kMaxFramesOfTopic) return std::nullopt;
    if (known.empty() || same == known.begin()) {
      if (known.empty()) known.push_back(origin);
      return name;
    }
    if (same == known.end()) known.push_back(origin);
    return fmt::format("{}:{}:{}", name, origin.frame, origin.child);
  }

  static std::string frame_in(const BagTopic& topic, const BagMessage& message) {
    RosMessage read;
    const std::optional<KnownTopic> known = topic.is_readable ? topic_with(topic, {}) : std::nullopt;
    if (!known || !read.read(*known->layout, message.bytes)) return {};
    return std::string(known->frame_of(read));
  }

  /// Adds the transforms of a message to the tree of its vehicle. REQUIRES that the first of them was read.
  void add_to_tree(const BagMessage& message, const Topic& topic) {
    std::string name = summaries_[topic.summary].name;
    const bool is_static = name.ends_with(kStaticTf);
    if (is_static) name.resize(name.size() - kStaticTf.size());
    add_transforms(*topic.known, message.bytes, message.time_s,
                   is_static ? TfTree::Link::kStatic : TfTree::Link::kMoving, message_, trees_[name]);
  }

  /// How the sonars are mounted, and what tf cannot join.
  void add_mounts(BagContents& contents) const {
    for (const auto& [name, tree] : trees_) {
      for (BagTopicSummary& topic : contents.topics) {
        if (topic.frame.empty() || topic.mount) continue;
        if (auto mount = tree.mount_of(topic.frame)) {
          topic.mount = BagTopicSummary::Mount{name, std::move(mount->vehicle), mount->body_from_sensor};
        }
      }
      if (const std::string text = tree.unjoined_text(); !text.empty()) {
        contents.notes.push_back(fmt::format("{}: {}", name, text));
      }
    }
  }

  /// The topics whose fields, with their units, were named.
  std::vector<std::string> named_by_fields() const {
    std::vector<std::string> names;
    for (const Topic& topic : topics_) {
      if (!topic.readers.empty()) names.push_back(summaries_[topic.summary].name);
    }
    return names;
  }

  /// Sets the times of samples of DVLs that say when their reports were true.
  void set_times(std::span<NavSource> sources) const {
    std::map<std::string_view, std::map<double, double>> by_arrival;  // of each topic
    for (const Topic& topic : topics_) {
      const std::vector<DeviceTime>& times = topic.state.report_times;
      if (times.empty()) continue;
      std::map<double, double>& times_s = by_arrival[summaries_[topic.summary].name];
      const std::vector<double> found_s = device_times_s(times);
      for (std::size_t i = 0; i < times.size(); ++i) times_s.try_emplace(times[i].received_s, found_s[i]);
    }
    for (NavSource& source : sources) {
      const auto times_s = by_arrival.find(source.name);
      if (times_s == by_arrival.end()) continue;
      for (NavSample& sample : source.samples) {
        const auto time_s = times_s->second.find(sample.time_s);
        if (time_s != times_s->second.end() && std::isfinite(time_s->second)) sample.time_s = time_s->second;
      }
    }
  }

  Result<void> add_topics() {
    while (topics_.size() < bag_.topics().size()) {
      const BagTopic& topic = bag_.topics()[topics_.size()];
      const auto [place, is_new] = places_.try_emplace(topic.name, summaries_.size());
      Result<std::vector<NavReader>> readers = readers_of(topic);
      if (!readers) return tl::unexpected(readers.error());
      std::optional<KnownTopic> known = readers->empty() ? known_topic(topic, nav_types()) : topic_with(topic, {});
      std::optional<KnownTopic> scans = scan_topic(topic);
      const MavlinkTopic mavlink = readers->empty() ? mavlink_topic(topic) : MavlinkTopic::kNone;
      if (is_new) summaries_.push_back(summary_of(topic, known || is_navigation(topic, mavlink), scans.has_value()));
      topics_.push_back({place->second, std::move(known), std::move(scans), *std::move(readers), {}, mavlink});
    }
    return {};
  }

  /// By the fields that were named.
  Result<std::vector<NavReader>> readers_of(const BagTopic& topic) const {
    std::vector<NavReader> readers;
    for (const NavFields& fields : fields_) {
      if (!is_of(fields, topic.name, topic.type)) continue;
      const auto known = topic.is_readable ? topic_with(topic, {}) : std::nullopt;
      const Result<NavReader> reader = known ? NavReader::make(fields, *known->layout)
                                             : fail(Error::Code::kBadOption, "its definition is not in the bag");
      if (!reader) {
        return fail(reader.error().code,
                    fmt::format("{}: {} ({}): {}", bag_.name(), topic.name, topic.type, reader.error().message));
      }
      readers.push_back(*reader);
    }
    return readers;
  }

  static BagTopicSummary summary_of(const BagTopic& topic, bool has_navigation, bool may_have_scans) {
    using Use = BagTopicSummary::Use;
    BagTopicSummary summary{topic.name, topic.type,          0, is_sonar(topic) ? Use::kBeams : Use::kNone,
                            {},         topic.other_encoding};
    if (summary.use == Use::kNone && has_navigation) summary.use = Use::kNavigation;
    if (summary.use == Use::kNone && may_have_scans) summary.use = Use::kScans;
    if (summary.use == Use::kNone && topic.is_readable) {
      if (const auto known = topic_with(topic, {})) summary.fields = fields_text(*known->layout);
    }
    return summary;
  }

  Bag& bag_;
  std::span<const NavFields> fields_;
  std::vector<Topic> topics_;
  std::vector<BagTopicSummary> summaries_;
  std::map<std::string, std::size_t> places_;  ///< in summaries_
  NavSources sources_;
  std::map<std::string, TfTree> trees_;  ///< by the name of their topic
  BagMavlink mavlink_;
  RosMessage message_;
  std::size_t records_ = 0;
  UnusableMessages unusable_;
};

}  // namespace

Result<BagContents> read_bag(ByteStream stream, Damage damage, std::span<const NavFields> fields,
                             std::size_t max_bytes) {
  const std::string name = stream.name();
  return detail::without_exceptions(name, [&]() -> Result<BagContents> {
    const std::span<const std::uint8_t> beginning = stream.beginning();
    if (!looks_like_ros1_bag(beginning) && !looks_like_sqlite(beginning) && !looks_like_mcap(beginning)) {
      return fail(Error::Code::kUnsupported, fmt::format("{}: is not a bag", stream.name()));
    }
    const Result<std::unique_ptr<Bag>> bag = open_bag(std::move(stream));
    if (!bag) return tl::unexpected(bag.error());
    BagSurvey survey(**bag, fields);
    for (std::size_t bytes = 0;;) {
      const Result<std::optional<BagMessage>> message = (*bag)->next();
      if (!message) return tl::unexpected(message.error());
      if (*message) {
        if (const auto added = survey.add(**message); !added) return tl::unexpected(added.error());
      }
      if (const auto kinds = survey.damage(); damage == Damage::kFail && !kinds.empty()) {
        return fail(Error::Code::kCorrupt, fmt::format("{}: {}", (*bag)->name(), first_damage_text(kinds.front())));
      }
      bytes += *message ? (*message)->bytes.size() : 0;
      if (!*message || bytes >= max_bytes) return survey.finish();
    }
  });
}

Result<void> check_topics(std::span<const NavFields> fields, std::span<const BagTopicSummary> topics) {
  for (const NavFields& wanted : fields) {
    const auto is_there = [&](const BagTopicSummary& topic) { return is_of(wanted, topic.name, topic.type); };
    if (std::ranges::any_of(topics, is_there)) continue;
    std::vector<std::string> names;
    for (const BagTopicSummary& topic : topics) names.push_back(fmt::format("{} ({})", topic.name, topic.type));
    const std::string name = wanted.topic.empty() ? "" : fmt::format(" '{}'", wanted.topic);
    const std::string type = wanted.type.empty() ? "" : fmt::format(" of type '{}'", wanted.type);
    return fail(Error::Code::kBadOption,
                fmt::format("{}{}there is no topic{}{}, but {}", wanted.stated_in, wanted.stated_in.empty() ? "" : ": ",
                            name, type, names.empty() ? "none at all" : fmt::format("{}", fmt::join(names, ", "))));
  }
  return {};
}

}  // namespace pingvox
