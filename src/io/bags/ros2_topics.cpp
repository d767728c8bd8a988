#include "io/internal/ros2_topics.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>

#include "io/bags/bag.hpp"
#include "io/bags/bag_scans.hpp"
#include "io/bags/bag_topics.hpp"
#include "io/bags/nav_messages.hpp"
#include "io/bags/sonar_messages.hpp"
#include "io/bags/tf_tree.hpp"
#include "io/nav/nav_sources.hpp"
#include "nav/internal/nav_frames.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {
namespace {

std::span<const std::uint8_t> as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

BagTopic bag_topic(const std::string& topic, const std::string& type) {
  BagTopic made;
  made.name = topic;
  made.type = type;
  made.encoding = RosEncoding::kCdr;
  return made;
}

/// A bag with one topic that does not end by itself.
class TopicBag final : public Bag {
 public:
  TopicBag(BagTopic topic, NextRos2Arrival next)
      : name_(topic.name), next_(std::move(next)), scans_(scan_topic(topic)) {
    topics_.push_back(std::move(topic));
  }
  const std::string& name() const override { return name_; }

 private:
  Result<std::optional<BagMessage>> read() override {
    std::optional<Ros2Arrival> arrival = next_();
    if (!arrival) return std::nullopt;
    last_ = *std::move(arrival);
    const BagMessage message{0, last_.time_s, last_.time_s, as_bytes(last_.bytes), std::nullopt};
    if (scans_ && is_scan(*scans_, message)) {
      return fail(
          Error::Code::kUnsupported,
          fmt::format("a message holds {} directions, as of a laser, and beams are read of those that hold one: "
                      "name the topic of the driver's single echoes",
                      directions_of(message)));
    }
    // What another node adds later ends nothing.
    scans_.reset();
    return message;
  }

  /// Of a scan.
  std::size_t directions_of(const BagMessage& message) const {
    const std::optional<KnownTopic> ranges = topic_with(topics().front(), std::array<std::string_view, 1>{"ranges"});
    RosMessage read;
    return ranges && read.read(*ranges->layout, message.bytes) ? RosFields(read, ranges->fields).count(0) : 0;
  }

  std::string name_;
  NextRos2Arrival next_;
  std::optional<KnownTopic> scans_;  ///< where messages may be scans of points, until one is not
  Ros2Arrival last_;
};

tl::unexpected<Error> not_read(const std::string& type, std::string_view what) {
  return fail(Error::Code::kUnsupported,
              fmt::format("messages of {} are not read as {}, or their definition is not known", type, what));
}

/// Turned into our frames. kUnsupported for poses whose frames contradict each other by their names, or are not those
/// of a vehicle's pose.
Result<std::vector<NavSource>> turned(std::vector<NavSource> sources) {
  for (const NavSource& source : sources) {
    if (std::string reason = reason_against_frames(source); !reason.empty()) {
      return fail(Error::Code::kUnsupported, std::move(reason));
    }
  }
  turn_frames(sources);
  const auto other = std::ranges::find(sources, NavSubject::kOther, &NavSource::subject);
  if (other != sources.end()) return fail(Error::Code::kUnsupported, other->note);
  return sources;
}

tl::unexpected<Error> damaged() {
  return fail(Error::Code::kCorrupt, std::string(kNoFit));
}

/// Reads the messages of one topic of navigation.
class NavTopicReader {
 public:
  NavTopicReader(std::string name, KnownTopic known) : name_(std::move(name)), known_(std::move(known)) {}

  Result<std::vector<NavSource>> read(std::string_view message, double time_s) {
    if (!message_.read(*known_.layout, as_bytes(message))) return damaged();
    const NavType& type = nav_types()[known_.type];
    const NavOrigin origin = origin_of(type.frame_id, known_, message_);
    NavSources sources;
    // Before the samples, which refer to it. What it gathers is for logs as a whole.
    state_.report_times.clear();
    state_.no_attitude.clear();
    NavSamples samples(sources, name_, known_.time_of(message_, time_s), state_, origin);
    type.add(RosFields(message_, known_.fields), samples);
    std::vector<NavSource> read = sources.take();
    // Which unit a pressure is in, only many of them tell.
    std::erase_if(read, [](const NavSource& source) { return source.quantity == NavQuantity::kPressure; });
    return turned(std::move(read)).map([this](std::vector<NavSource> told) { return judged(std::move(told)); });
  }

 private:
  /// With what is wrong with the attitude.
  std::vector<NavSource> judged(std::vector<NavSource> sources) const {
    if (state_.no_attitude.empty()) return sources;
    std::erase_if(sources, [](const NavSource& source) { return source.quantity == NavQuantity::kAttitude; });
    NavSource none{name_, NavQuantity::kAttitude, {}};
    none.fault = state_.no_attitude;
    sources.push_back(std::move(none));
    return sources;
  }

  std::string name_;
  KnownTopic known_;
  NavTopicState state_;
  RosMessage message_;
};

/// Reads the poses of the vehicle from transforms as they come.
class TfReader {
 public:
  TfReader(std::string topic, KnownTopic known, std::optional<TfFrames> frames)
      : topic_(std::move(topic)), known_(std::move(known)), frames_(std::move(frames)) {}

  Result<std::vector<NavSource>> read_static(std::string_view message, double time_s) {
    if (!add(message, time_s, TfTree::Link::kStatic)) return damaged();
    return std::vector<NavSource>();
  }

  Result<std::vector<NavSource>> read(std::string_view message, double time_s) {
    constexpr double kListen_s = 2.0, kEvery_s = 0.1, kNextTry_s = 1.0;
    if (!add(message, time_s, TfTree::Link::kMoving)) return damaged();
    // Nodes do not begin at once: what is missing may still come.
    if (!due_s_) due_s_ = time_s + kListen_s;
    if (time_s >= *due_s_) {
      poses_ = new_poses(time_s);
      due_s_ = time_s + (poses_ ? kEvery_s : kNextTry_s);
    }
    // A reason stays until it is gone.
    return poses_ ? std::exchange(*poses_, {}) : poses_;
  }

 private:
  bool add(std::string_view message, double time_s, TfTree::Link link) {
    if (!message_.read(*known_.layout, as_bytes(message))) return false;
    add_transforms(known_, as_bytes(message), time_s, link, message_, tree_);
    return true;
  }

  Result<std::vector<NavSource>> new_poses(double time_s) {
    constexpr double kKept_s = 10.0;  // as tf2 does
    tree_.forget_before(time_s - kKept_s);
    if (!frames_) {
      Result<TfFrames> found = tree_.vehicle_frames();
      if (!found) return tl::unexpected(found.error());
      frames_ = *std::move(found);
    }
    return tree_.path(topic_, *frames_, given_s_, time_s).and_then([&](std::vector<NavSource> sources) {
      if (!sources.empty()) given_s_ = sources.front().samples.back().time_s;
      return turned(std::move(sources));
    });
  }

  std::string topic_;
  KnownTopic known_;
  std::optional<TfFrames> frames_;
  RosMessage message_;
  TfTree tree_;
  std::optional<double> due_s_;  ///< when poses are told next
  double given_s_ = -std::numeric_limits<double>::infinity();
  Result<std::vector<NavSource>> poses_;  ///< not told yet
};

}  // namespace

Result<std::unique_ptr<BeamSource>> read_ros2_beams(const std::string& topic, const std::string& type,
                                                    NextRos2Arrival next) {
  BagTopic of_sonar = bag_topic(topic, type);
  if (!is_sonar(of_sonar)) return not_read(type, "beams");
  return beams_of(std::make_unique<TopicBag>(std::move(of_sonar), std::move(next)));
}

const DeviceProfile* device_of_ros2_type(const std::string& type) {
  const std::optional<KnownTopic> known = known_topic(bag_topic({}, type), sonar_types());
  return known ? find_device(sonar_types()[known->type].device) : nullptr;
}

Result<ReadRos2Nav> read_ros2_nav(const std::string& topic, const std::string& type) {
  std::optional<KnownTopic> known = known_topic(bag_topic(topic, type), nav_types());
  if (!known || nav_types()[known->type].add == nullptr) return not_read(type, "navigation");
  auto reader = std::make_shared<NavTopicReader>(topic, *std::move(known));
  return [reader](std::string_view message, double time_s) { return reader->read(message, time_s); };
}

bool is_ros2_tf(const std::string& topic, const std::string& type) {
  const std::optional<KnownTopic> known = known_topic(bag_topic(topic, type), nav_types());
  return known && nav_types()[known->type].frame_id == FrameId::kOfTransforms && !topic.ends_with("_static");
}

ReadRos2Tf read_ros2_tf(const std::string& topic, const std::string& type, const std::optional<TfFrames>& frames) {
  std::optional<TfFrames> named = frames;
  if (named) named = {std::string(without_slash(named->parent)), std::string(without_slash(named->child))};
  auto reader = std::make_shared<TfReader>(topic, *known_topic(bag_topic(topic, type), nav_types()), std::move(named));
  return {[reader](std::string_view message, double time_s) { return reader->read(message, time_s); },
          [reader](std::string_view message, double time_s) { return reader->read_static(message, time_s); }};
}

}  // namespace pingvox
