#include "device/internal/ros2_nav_receiver.hpp"

#include <fmt/core.h>

#include <chrono>
#include <thread>

#include "device/ros2_time.hpp"

namespace pingvox {

Result<std::string> wait_for_type(const Ros2Node& node, const std::string& topic) {
  constexpr int kLooks = 200;
  constexpr std::chrono::milliseconds kPause(50);
  for (int look = 0; look < kLooks; ++look) {
    if (std::optional<std::string> type = node.type_of(topic)) return *std::move(type);
    std::this_thread::sleep_for(kPause);
  }
  return fail(Error::Code::kIo, fmt::format("ros2:{}: nobody publishes it: waited for 10 s", topic));
}

std::optional<Ros2NavAddress> Ros2NavAddress::parse(const std::string& text) {
  if (!text.starts_with('/')) return std::nullopt;
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return Ros2NavAddress{text, std::nullopt};
  const std::string frames = text.substr(colon + 1);
  const std::size_t between = frames.find(':');
  if (between == 0 || between == std::string::npos) return std::nullopt;
  const std::string child = frames.substr(between + 1);
  if (child.empty() || child.find(':') != std::string::npos) return std::nullopt;
  return Ros2NavAddress{text.substr(0, colon), TfFrames{frames.substr(0, between), child}};
}

Result<Ros2NavReceiver> Ros2NavReceiver::make(const Ros2Node& node, const std::string& address, double since_1970_s) {
  const std::optional<Ros2NavAddress> from = Ros2NavAddress::parse(address);
  if (!from) return fail(Error::Code::kBadOption, fmt::format("ros2:{}: names no topic", address));
  const Result<std::string> type = wait_for_type(node, from->topic);
  if (!type) return tl::unexpected(type.error());
  const bool is_tf = is_ros2_tf(from->topic, *type);
  if (from->frames && !is_tf) {
    return fail(Error::Code::kBadOption,
                fmt::format("ros2:{}: frames are named of tf alone, not of {}", address, *type));
  }
  ReadRos2Tf tf;
  if (is_tf) tf = read_ros2_tf(from->topic, *type, from->frames);
  Result<ReadRos2Nav> read = is_tf ? std::move(tf.moving) : read_ros2_nav(from->topic, *type);
  if (!read) return tl::unexpected(read.error());
  Result<Ros2Reader> reader = node.read({from->topic, *type}, Ros2Delivery::kStream);
  if (!reader) return tl::unexpected(reader.error());
  Ros2NavReceiver receiver(address, {*std::move(reader), *std::move(read)}, since_1970_s);
  if (is_tf) {
    Result<Ros2Reader> still = node.read({from->topic + "_static", *type}, Ros2Delivery::kKeepsLast);
    if (!still) return tl::unexpected(still.error());
    receiver.still_ = Topic{*std::move(still), std::move(tf.still)};
  }
  return receiver;
}

/// What the next message tells; nullopt: there is none.
std::optional<Result<std::vector<NavSource>>> Ros2NavReceiver::next_of(const Topic& topic) {
  const std::optional<std::string> message = topic.reader.take(0.0);
  if (!message) return std::nullopt;
  Result<std::vector<NavSource>> sources = topic.read(*message, system_now_s());
  const bool is_damaged = !sources && sources.error().code == Error::Code::kCorrupt;
  ++(is_damaged ? status_.damaged : status_.messages);
  return is_damaged ? std::vector<NavSource>() : std::move(sources);
}

std::vector<NavSource> Ros2NavReceiver::read(double now_s) {
  constexpr std::size_t kMaxAtOnce = 256;
  // What moving transforms need.
  for (std::size_t count = 0; still_ && count < kMaxAtOnce && next_of(*still_); ++count) continue;
  std::vector<NavSource> all;
  for (std::size_t count = 0; count < kMaxAtOnce; ++count) {
    std::optional<Result<std::vector<NavSource>>> sources = next_of(topic_);
    if (!sources) break;
    last_s_ = now_s;
    if (!*sources) {
      status_.is_connected = false;
      status_.problem = sources->error().message;
      continue;
    }
    if (!std::exchange(status_.is_connected, true)) ++status_.connections;
    for (NavSource& source : **sources) {
      for (NavSample& sample : source.samples) sample.time_s -= since_1970_s_;
      all.push_back(std::move(source));
    }
  }
  if (now_s > last_s_ + kRos2Silence_s) {
    status_.is_connected = false;
    status_.problem = kRos2Silent;
  }
  return all;
}

}  // namespace pingvox
