#include "io/bags/bag_mavlink.hpp"

#include <cmath>
#include <string_view>

#include "io/bags/bag_topics.hpp"
#include "io/bytes/text.hpp"
#include "io/nav/mavlink_json.hpp"

namespace pingvox {

MavlinkTopic mavlink_topic(const BagTopic& topic) {
  if (topic.encoding != RosEncoding::kJson || !topic.layout) return MavlinkTopic::kNone;
  for (const std::string_view field : {"header.system_id", "header.component_id", "message.type"}) {
    if (!topic.layout->field(field)) return MavlinkTopic::kNone;
  }
  if (topic.name.ends_with("mavlink/in")) return MavlinkTopic::kNone;  // what the vehicle is sent
  return topic.name.ends_with("mavlink/out") ? MavlinkTopic::kAll : MavlinkTopic::kOfMessage;
}

bool is_navigation(const BagTopic& topic, MavlinkTopic kind) {
  return kind == MavlinkTopic::kAll ||
         (kind == MavlinkTopic::kOfMessage && is_converted_mavlink(last_part(topic.name)));
}

bool BagMavlink::add(const BagMessage& message, MavlinkTopic topic) {
  constexpr double kNear_s = 60.0;
  const bool is_again = topic == MavlinkTopic::kAll && of_messages_;
  if (is_again) return true;
  if (topic == MavlinkTopic::kOfMessage) all_.reset();
  const std::optional<MavlinkFrame> frame = mavlink_frame_of_json(text_of(message.bytes));
  if (!frame) return false;
  std::optional<MavlinkMessages>& messages = topic == MavlinkTopic::kAll ? all_ : of_messages_;
  if (!messages) messages.emplace();
  const bool is_published = std::fabs(message.published_s - message.time_s) <= kNear_s;
  messages->log.add(*frame, is_published ? message.published_s : message.time_s);
  ++messages->count;
  return true;
}

void BagMavlink::finish(NavReading& reading) {
  std::optional<MavlinkMessages>& messages = of_messages_ ? of_messages_ : all_;
  if (!messages) return;
  messages->log.finish(reading);
  reading.records += messages->count;
}

}  // namespace pingvox
