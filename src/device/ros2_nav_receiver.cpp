#include "device/internal/ros2_nav_receiver.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "device/ros2_time.hpp"

namespace pingvox {
namespace {

std::string_view without_slash(std::string_view frame) {
  if (frame.starts_with('/')) frame.remove_prefix(1);
  return frame;
}

}  // namespace

std::optional<Ros2NavAddress> Ros2NavAddress::parse(const std::string& text) {
  const std::size_t colon = text.find(':');
  Ros2NavAddress address{text.substr(0, colon), std::nullopt};
  if (!is_ros2_topic(address.topic)) return std::nullopt;
  if (colon == std::string::npos) return address;
  const std::string frames = text.substr(colon + 1);
  const std::size_t between = frames.find(':');
  if (between == std::string::npos || !address.is_tf()) return std::nullopt;
  const std::string parent = frames.substr(0, between), child = frames.substr(between + 1);
  const bool are_names = !without_slash(parent).empty() && !without_slash(child).empty();
  if (!are_names || child.find(':') != std::string::npos) return std::nullopt;
  if (without_slash(parent) == without_slash(child)) return std::nullopt;
  address.frames = TfFrames{parent, child};
  return address;
}

Result<Ros2NavReceiver> Ros2NavReceiver::make(const Ros2Node& node, const std::string& address, double since_1970_s) {
  std::optional<Ros2NavAddress> from = Ros2NavAddress::parse(address);
  if (!from) return fail(Error::Code::kBadOption, fmt::format("ros2:{}: names no topic", address));
  return Ros2NavReceiver(node, address, *std::move(from), since_1970_s);
}

/// Looks for a publisher of the topic, which has its type.
void Ros2NavReceiver::open(double now_s) {
  constexpr double kPause_s = 0.1;
  if (now_s < look_s_) return;
  look_s_ = now_s + kPause_s;
  const std::optional<std::string> type = node_.type_of(from_.topic);
  if (!type) {
    // Once, as other nodes come and go.
    const bool is_long = now_s > last_s_ + kRos2Silence_s && status_.problem.empty();
    if (is_long) status_.problem = why_not_published(node_);
    return;
  }
  if (const Result<void> opened = open_as(*type); !opened) return refuse(opened.error().message);
  last_s_ = now_s;
}

Result<void> Ros2NavReceiver::open_as(const std::string& type) {
  const bool is_tf = is_ros2_tf(from_.topic, type);
  if (from_.frames && !is_tf) {
    return fail(Error::Code::kUnsupported, fmt::format("frames are named of tf alone, not of {}", type));
  }
  ReadRos2Tf tf;
  if (is_tf) tf = read_ros2_tf(from_.topic, type, from_.frames);
  Result<ReadRos2Nav> read = is_tf ? std::move(tf.moving) : read_ros2_nav(from_.topic, type);
  if (!read) return tl::unexpected(read.error());
  Result<Ros2Reader> reader = node_.read({from_.topic, type}, Ros2Delivery::kStream);
  if (!reader) return tl::unexpected(reader.error());
  if (is_tf) {
    Result<Ros2Reader> still = node_.read({from_.topic + "_static", type}, Ros2Delivery::kKeepsLast);
    if (!still) return tl::unexpected(still.error());
    still_ = Topic{*std::move(still), std::move(tf.still)};
  }
  topic_ = Topic{*std::move(reader), *std::move(read)};
  return {};
}

void Ros2NavReceiver::refuse(const std::string& reason) {
  status_.is_connected = false;
  status_.problem = status_.refused = reason;
}

/// The samples of the next message; nullopt: there is none.
std::optional<Result<std::vector<NavSource>>> Ros2NavReceiver::next_of(const Topic& topic, double now_s) {
  const std::optional<Ros2Sample> message = topic.reader.take_sample(0.0);
  if (!message) return std::nullopt;
  // Transforms of one tree come from several nodes.
  if (!still_) publishers_.note(message->publisher, now_s);
  Result<std::vector<NavSource>> sources = topic.read(message->bytes, system_now_s());
  const bool is_damaged = !sources && sources.error().code == Error::Code::kCorrupt;
  ++(is_damaged ? status_.damaged : status_.messages);
  return sources;
}

/// @param attitude  without samples where its fault has the reason
void Ros2NavReceiver::note_attitude(const NavSource& attitude, double now_s) {
  constexpr double kLong_s = 5.0;
  if (attitude.fault.empty()) {
    without_attitude_s_.reset();
    status_.no_attitude.clear();
    return;
  }
  if (!without_attitude_s_) without_attitude_s_ = now_s;
  if (now_s > *without_attitude_s_ + kLong_s) status_.no_attitude = attitude.fault;
}

std::vector<NavSource> Ros2NavReceiver::read(double now_s) {
  constexpr std::size_t kMaxAtOnce = 256, kFewDamaged = 3;
  if (!topic_) open(now_s);
  if (!topic_) return {};
  // What moving transforms need.
  for (std::size_t count = 0; still_ && count < kMaxAtOnce && next_of(*still_, now_s); ++count) continue;
  std::vector<NavSource> all;
  for (std::size_t count = 0; count < kMaxAtOnce; ++count) {
    std::optional<Result<std::vector<NavSource>>> sources = next_of(*topic_, now_s);
    if (!sources) break;
    last_s_ = now_s;
    if (!*sources && sources->error().code == Error::Code::kCorrupt) {
      // Some between others are only counted.
      const bool is_long = !used_s_ || now_s > *used_s_ + kRos2Silence_s;
      if (++damaged_ >= kFewDamaged && is_long) refuse(sources->error().message);
      continue;
    }
    if (!*sources) {
      refuse(sources->error().message);
      continue;
    }
    used_s_ = now_s;
    damaged_ = 0;
    status_.refused.clear();
    if (!std::exchange(status_.is_connected, true)) ++status_.connections;
    for (NavSource& source : **sources) {
      if (source.quantity == NavQuantity::kAttitude) note_attitude(source, now_s);
      for (NavSample& sample : source.samples) sample.time_s -= since_1970_s_;
      all.push_back(std::move(source));
    }
  }
  status_.publishers = publishers_.together();
  if (now_s > last_s_ + kRos2Silence_s) {
    status_.is_connected = false;
    status_.refused.clear();
    status_.problem = kRos2Silent;
  }
  return all;
}

}  // namespace pingvox
