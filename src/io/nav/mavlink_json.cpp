#include "io/nav/mavlink_json.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/bytes/json_events.hpp"

namespace pingvox {
namespace {

using JsonKind = JsonEvent::Kind;

enum class JsonWire : std::uint8_t { kNone, kU8, kU16, kI16, kU32, kI32, kU64, kF32 };

/// A number of a payload.
struct JsonField {
  std::string_view name;
  JsonWire wire = JsonWire::kNone;
  std::size_t offset = 0;
  std::size_t count = 1;  ///< of an array
};

struct JsonMessage {
  std::string_view name;
  std::uint32_t number = 0;
  std::array<JsonField, 8> fields;  ///< those that MavlinkNav needs
};

constexpr std::array<JsonField, 8> kPressureFields = {
    {{"time_boot_ms", JsonWire::kU32, 0}, {"press_abs", JsonWire::kF32, 4}, {"temperature", JsonWire::kI16, 12}}};

constexpr std::array kJsonMessages = {
    JsonMessage{"GPS_RAW_INT",
                24,
                {{{"lat", JsonWire::kI32, 8},
                  {"lon", JsonWire::kI32, 12},
                  {"alt", JsonWire::kI32, 16},
                  {"fix_type", JsonWire::kU8, 28}}}},
    JsonMessage{"SCALED_PRESSURE", 29, kPressureFields},
    JsonMessage{"ATTITUDE",
                30,
                {{{"time_boot_ms", JsonWire::kU32, 0},
                  {"roll", JsonWire::kF32, 4},
                  {"pitch", JsonWire::kF32, 8},
                  {"yaw", JsonWire::kF32, 12},
                  {"rollspeed", JsonWire::kF32, 16},
                  {"pitchspeed", JsonWire::kF32, 20},
                  {"yawspeed", JsonWire::kF32, 24}}}},
    JsonMessage{"ATTITUDE_QUATERNION",
                31,
                {{{"time_boot_ms", JsonWire::kU32, 0},
                  {"q1", JsonWire::kF32, 4},
                  {"q2", JsonWire::kF32, 8},
                  {"q3", JsonWire::kF32, 12},
                  {"q4", JsonWire::kF32, 16},
                  {"rollspeed", JsonWire::kF32, 20},
                  {"pitchspeed", JsonWire::kF32, 24},
                  {"yawspeed", JsonWire::kF32, 28}}}},
    JsonMessage{"LOCAL_POSITION_NED",
                32,
                {{{"time_boot_ms", JsonWire::kU32, 0},
                  {"x", JsonWire::kF32, 4},
                  {"y", JsonWire::kF32, 8},
                  {"z", JsonWire::kF32, 12}}}},
    JsonMessage{"GLOBAL_POSITION_INT",
                33,
                {{{"time_boot_ms", JsonWire::kU32, 0},
                  {"lat", JsonWire::kI32, 4},
                  {"lon", JsonWire::kI32, 8},
                  {"alt", JsonWire::kI32, 12},
                  {"relative_alt", JsonWire::kI32, 16}}}},
    JsonMessage{"VFR_HUD", 74, {{{"heading", JsonWire::kI16, 16}}}},
    JsonMessage{"VISION_POSITION_ESTIMATE",
                102,
                {{{"x", JsonWire::kF32, 8},
                  {"y", JsonWire::kF32, 12},
                  {"z", JsonWire::kF32, 16},
                  {"roll", JsonWire::kF32, 20},
                  {"pitch", JsonWire::kF32, 24},
                  {"yaw", JsonWire::kF32, 28}}}},
    JsonMessage{"DISTANCE_SENSOR",
                132,
                {{{"time_boot_ms", JsonWire::kU32, 0},
                  {"min_distance", JsonWire::kU16, 4},
                  {"max_distance", JsonWire::kU16, 6},
                  {"current_distance", JsonWire::kU16, 8},
                  {"id", JsonWire::kU8, 11}}}},
    JsonMessage{"SCALED_PRESSURE2", 137, kPressureFields},
    JsonMessage{"SCALED_PRESSURE3", 143, kPressureFields},
    JsonMessage{
        "AHRS2", 178, {{{"roll", JsonWire::kF32, 0}, {"pitch", JsonWire::kF32, 4}, {"yaw", JsonWire::kF32, 8}}}},
    JsonMessage{"GPS_INPUT",
                232,
                {{{"lat", JsonWire::kI32, 12},
                  {"lon", JsonWire::kI32, 16},
                  {"alt", JsonWire::kF32, 20},
                  {"fix_type", JsonWire::kU8, 61}}}},
    JsonMessage{"VISION_POSITION_DELTA",
                11011,
                {{{"time_delta_usec", JsonWire::kU64, 8}, {"position_delta", JsonWire::kF32, 28, 3}}}}};

constexpr std::array kFixTypes = {
    std::string_view("GPS_FIX_TYPE_NO_GPS"),    std::string_view("GPS_FIX_TYPE_NO_FIX"),
    std::string_view("GPS_FIX_TYPE_2D_FIX"),    std::string_view("GPS_FIX_TYPE_3D_FIX"),
    std::string_view("GPS_FIX_TYPE_DGPS"),      std::string_view("GPS_FIX_TYPE_RTK_FLOAT"),
    std::string_view("GPS_FIX_TYPE_RTK_FIXED"), std::string_view("GPS_FIX_TYPE_STATIC"),
    std::string_view("GPS_FIX_TYPE_PPP")};

/// A value within one of the two objects of a message, header and message.
struct JsonMember {
  std::string_view object, name;
  JsonEvent value;    ///< of an enum its name
  std::size_t i = 0;  ///< of the values of an array
};

/// false: the text is no JSON.
template <class Take>
bool for_each_member(std::string_view text, Take take) {
  JsonEvents events(text);
  JsonMember member;
  std::size_t values = 0;
  while (const auto event = events.next()) {
    if (event->kind == JsonKind::kEnd) continue;
    const bool begins = event->kind == JsonKind::kObject || event->kind == JsonKind::kArray;
    const std::size_t depth = events.depth() - (begins ? 1 : 0);
    if (depth == 1) member.object = event->key;
    if (depth == 2) {
      member.name = event->key;
      values = 0;
    }
    const bool is_value = !begins && (depth == 2 || depth == 3);
    if (!is_value) continue;
    member.value = *event;
    member.i = values++;
    take(member);
  }
  return events.is_whole();
}

template <class T>
std::optional<T> json_value(std::string_view text) {
  T value = {};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Writes numbers of a message into its payload.
class JsonPayload {
 public:
  explicit JsonPayload(MavlinkFrame& frame) : frame_(frame) {}

  /// false: the value is none of the field's type.
  bool put(const JsonField& field, const JsonMember& member) {
    if (member.i >= field.count) return true;
    const JsonEvent& value = member.value;
    switch (field.wire) {
      case JsonWire::kU8:
        if (value.kind == JsonKind::kText) return put_fix_type(field, value.text);
        return put_number<std::uint8_t>(field, member);
      case JsonWire::kU16:
        return put_number<std::uint16_t>(field, member);
      case JsonWire::kI16:
        return put_number<std::int16_t>(field, member);
      case JsonWire::kU32:
        return put_number<std::uint32_t>(field, member);
      case JsonWire::kI32:
        return put_number<std::int32_t>(field, member);
      case JsonWire::kU64:
        return put_number<std::uint64_t>(field, member);
      case JsonWire::kF32:
        // What is not finite is null in some writers.
        if (value.kind == JsonKind::kNull) return put_value(field, member.i, std::numeric_limits<float>::quiet_NaN());
        return put_number<float>(field, member);
      case JsonWire::kNone:
        break;
    }
    return false;
  }

  std::size_t count() const { return count_; }

 private:
  template <class T>
  bool put_value(const JsonField& field, std::size_t i, T value) {
    std::memcpy(frame_.payload.data() + field.offset + i * sizeof(T), &value, sizeof(T));
    ++count_;
    return true;
  }

  template <class T>
  bool put_number(const JsonField& field, const JsonMember& member) {
    if (member.value.kind != JsonKind::kNumber) return false;
    const std::optional<T> value = json_value<T>(member.value.text);
    return value && put_value(field, member.i, *value);
  }

  bool put_fix_type(const JsonField& field, std::string_view name) {
    const auto* const found = std::ranges::find(kFixTypes, name);
    return found != kFixTypes.end() && put_value(field, 0, static_cast<std::uint8_t>(found - kFixTypes.begin()));
  }

  MavlinkFrame& frame_;
  std::size_t count_ = 0;  ///< numbers
};

const JsonMessage* json_message(std::string_view name) {
  const auto* const found = std::ranges::find(kJsonMessages, name, &JsonMessage::name);
  return found == kJsonMessages.end() ? nullptr : found;
}

}  // namespace

std::optional<MavlinkFrame> mavlink_frame_of_json(std::string_view text) {
  constexpr std::uint32_t kNotConverted = 0xffffff;
  constexpr std::string_view kHeader = "header", kMessage = "message";
  std::optional<std::uint8_t> system, component;
  std::string_view name;
  const bool is_whole = for_each_member(text, [&](const JsonMember& member) {
    const bool is_number = member.object == kHeader && member.value.kind == JsonKind::kNumber;
    if (is_number && member.name == "system_id") system = json_value<std::uint8_t>(member.value.text);
    if (is_number && member.name == "component_id") component = json_value<std::uint8_t>(member.value.text);
    const bool is_name = member.object == kMessage && member.name == "type" && member.value.kind == JsonKind::kText;
    if (is_name) name = member.value.text;
  });
  if (!is_whole || !system || !component || name.empty()) return std::nullopt;
  MavlinkFrame frame;
  frame.system = *system;
  frame.component = *component;
  frame.check = MavlinkFrame::Check::kRight;
  frame.message = kNotConverted;
  const JsonMessage* const message = json_message(name);
  if (message == nullptr) return frame;
  frame.message = message->number;
  JsonPayload payload(frame);
  bool fits = true;
  for_each_member(text, [&](const JsonMember& member) {
    if (member.object != kMessage) return;
    const auto* const field = std::ranges::find(message->fields, member.name, &JsonField::name);
    const bool is_wanted = field != message->fields.end() && field->wire != JsonWire::kNone;
    if (is_wanted) fits = payload.put(*field, member) && fits;
  });
  std::size_t wanted = 0;
  for (const JsonField& field : message->fields) wanted += field.wire == JsonWire::kNone ? 0 : field.count;
  if (!fits || payload.count() != wanted) return std::nullopt;
  return frame;
}

bool is_converted_mavlink(std::string_view name) {
  return json_message(name) != nullptr;
}

}  // namespace pingvox
