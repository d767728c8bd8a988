#include "io/internal/ping_json.hpp"

#include <array>
#include <span>
#include <utility>

#include "io/bags/bag_topics.hpp"
#include "io/bags/ros_message.hpp"
#include "io/internal/ping_frame.hpp"

namespace pingvox {
namespace {

constexpr std::uint8_t kHead = 2;

/// Numbers of a message in JSON, as they come in the frame.
class PingFields {
 public:
  PingFields(const RosLayout& layout, const RosMessage& message, std::string prefix)
      : layout_(layout), message_(message), prefix_(std::move(prefix)) {}

  template <class T>
  void put(std::string_view name) {
    const std::optional<std::size_t> field = layout_.field(prefix_ + std::string(name));
    const std::optional<T> number = field ? whole<T>(message_.number(*field)) : std::nullopt;
    if (!number && problem_.empty()) problem_ = "a ping without its " + std::string(name);
    put_number(number.value_or(T{}));
  }
  template <class T>
  void put_number(T number) {
    for (std::size_t i = 0; i < sizeof(T); ++i) payload_.push_back(static_cast<std::uint8_t>(number >> (8 * i) & 0xff));
  }
  void put_samples() {
    constexpr std::size_t kMaxSamples = 4000;
    const std::optional<std::size_t> field = layout_.field(prefix_ + "data");
    const std::span<const std::uint8_t> samples = field ? message_.byte_array(*field) : std::span<const std::uint8_t>();
    const bool are_samples = field && samples.size() == message_.count(*field) && samples.size() <= kMaxSamples;
    if (!are_samples && problem_.empty()) problem_ = "a ping without samples of 8 bits";
    if (!are_samples) return;
    // The head may send fewer samples than were asked for, which a log of its line has in both.
    const auto count = static_cast<std::uint16_t>(samples.size());
    if (count == 0) {
      put<std::uint16_t>("number_of_samples");
    } else {
      put_number(count);
    }
    put_number(count);
    payload_.insert(payload_.end(), samples.begin(), samples.end());
  }

  const std::string& problem() const { return problem_; }
  const std::vector<std::uint8_t>& payload() const { return payload_; }

 private:
  const RosLayout& layout_;
  const RosMessage& message_;
  std::string prefix_, problem_;
  std::vector<std::uint8_t> payload_;
};

}  // namespace

tl::expected<std::optional<PingJson>, std::string> ping_in_json(std::string_view text) {
  const std::optional<RosLayout> layout = RosLayout::of_json(text);
  if (!layout) return tl::unexpected<std::string>("a text that is no JSON");
  constexpr std::string_view kPing = "DeviceMessage.PingMessage.Ping360.";
  for (const auto& [name, number] : {std::pair{"DeviceData.", PingMessage::kDeviceData},
                                     std::pair{"AutoDeviceData.", PingMessage::kAutoDeviceData}}) {
    const std::string prefix = std::string(kPing) + name;
    if (!layout->field(prefix + "angle")) continue;
    RosMessage message;
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    if (!message.read(*layout, bytes)) return tl::unexpected<std::string>("a text that is no JSON");
    PingFields fields(*layout, message, prefix);
    fields.put<std::uint8_t>("mode");
    fields.put<std::uint8_t>("gain_setting");
    fields.put<std::uint16_t>("angle");
    fields.put<std::uint16_t>("transmit_duration");
    fields.put<std::uint16_t>("sample_period");
    fields.put<std::uint16_t>("transmit_frequency");
    if (number == PingMessage::kAutoDeviceData) {
      fields.put<std::uint16_t>("start_angle");
      fields.put<std::uint16_t>("stop_angle");
      fields.put<std::uint8_t>("num_steps");
      fields.put<std::uint8_t>("delay");
    }
    fields.put_samples();
    if (!fields.problem().empty()) return tl::unexpected(fields.problem());
    const std::optional<std::size_t> device = layout->field("DeviceMessage.device_id");
    return PingJson{device ? std::string(message.text(*device)) : "",
                    make_ping_frame(number, kHead, 0, fields.payload())};
  }
  return std::nullopt;
}

}  // namespace pingvox
