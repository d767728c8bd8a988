// The messages of MAVLink as its definitions have them (common.xml, ardupilotmega.xml), and what its documentation
// derives from these: the layout of the payload and the byte of the checksum that stands for it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/internal/mavlink.hpp"
#include "io/nav/mavlink_json.hpp"

namespace pingvox {
namespace {

struct MessageText {
  std::uint32_t number;
  std::string_view text;  ///< NAME: TYPE FIELD, ... | extension fields
};

constexpr std::array kMessageTexts = std::to_array<MessageText>(
    {{0,
      "HEARTBEAT: uint8_t type, uint8_t autopilot, uint8_t base_mode, uint32_t custom_mode, uint8_t "
      "system_status, uint8_t mavlink_version"},
     {2, "SYSTEM_TIME: uint64_t time_unix_usec, uint32_t time_boot_ms"},
     {22,
      "PARAM_VALUE: char[16] param_id, float param_value, uint8_t param_type, uint16_t param_count, "
      "uint16_t param_index"},
     {24,
      "GPS_RAW_INT: uint64_t time_usec, uint8_t fix_type, int32_t lat, int32_t lon, int32_t alt, "
      "uint16_t eph, uint16_t epv, uint16_t vel, uint16_t cog, uint8_t satellites_visible | int32_t "
      "alt_ellipsoid, uint32_t h_acc, uint32_t v_acc, uint32_t vel_acc, uint32_t hdg_acc, uint16_t yaw"},
     {29,
      "SCALED_PRESSURE: uint32_t time_boot_ms, float press_abs, float press_diff, int16_t temperature | "
      "int16_t temperature_press_diff"},
     {30,
      "ATTITUDE: uint32_t time_boot_ms, float roll, float pitch, float yaw, float rollspeed, float "
      "pitchspeed, float yawspeed"},
     {31,
      "ATTITUDE_QUATERNION: uint32_t time_boot_ms, float q1, float q2, float q3, float q4, float "
      "rollspeed, float pitchspeed, float yawspeed | float[4] repr_offset_q"},
     {32,
      "LOCAL_POSITION_NED: uint32_t time_boot_ms, float x, float y, float z, float vx, float vy, float "
      "vz"},
     {33,
      "GLOBAL_POSITION_INT: uint32_t time_boot_ms, int32_t lat, int32_t lon, int32_t alt, int32_t "
      "relative_alt, int16_t vx, int16_t vy, int16_t vz, uint16_t hdg"},
     {49, "GPS_GLOBAL_ORIGIN: int32_t latitude, int32_t longitude, int32_t altitude | uint64_t time_usec"},
     {74,
      "VFR_HUD: float airspeed, float groundspeed, int16_t heading, uint16_t throttle, float alt, float "
      "climb"},
     {102,
      "VISION_POSITION_ESTIMATE: uint64_t usec, float x, float y, float z, float roll, float pitch, "
      "float yaw | float[21] covariance, uint8_t reset_counter"},
     {103,
      "VISION_SPEED_ESTIMATE: uint64_t usec, float x, float y, float z | float[9] covariance, uint8_t "
      "reset_counter"},
     {132,
      "DISTANCE_SENSOR: uint32_t time_boot_ms, uint16_t min_distance, uint16_t max_distance, uint16_t "
      "current_distance, uint8_t type, uint8_t id, uint8_t orientation, uint8_t covariance | float "
      "horizontal_fov, float vertical_fov, float[4] quaternion, uint8_t signal_quality"},
     {137,
      "SCALED_PRESSURE2: uint32_t time_boot_ms, float press_abs, float press_diff, int16_t temperature "
      "| int16_t temperature_press_diff"},
     {143,
      "SCALED_PRESSURE3: uint32_t time_boot_ms, float press_abs, float press_diff, int16_t temperature "
      "| int16_t temperature_press_diff"},
     {173, "RANGEFINDER: float distance, float voltage"},
     {178, "AHRS2: float roll, float pitch, float yaw, float altitude, int32_t lat, int32_t lng"},
     {232,
      "GPS_INPUT: uint64_t time_usec, uint8_t gps_id, uint16_t ignore_flags, uint32_t time_week_ms, "
      "uint16_t time_week, uint8_t fix_type, int32_t lat, int32_t lon, float alt, float hdop, float "
      "vdop, float vn, float ve, float vd, float speed_accuracy, float horiz_accuracy, float "
      "vert_accuracy, uint8_t satellites_visible | uint16_t yaw"},
     {251, "NAMED_VALUE_FLOAT: uint32_t time_boot_ms, char[10] name, float value"},
     {253, "STATUSTEXT: uint8_t severity, char[50] text | uint16_t id, uint8_t chunk_seq"},
     {330,
      "OBSTACLE_DISTANCE: uint64_t time_usec, uint8_t sensor_type, uint16_t[72] distances, uint8_t "
      "increment, uint16_t min_distance, uint16_t max_distance | float increment_f, float angle_offset, "
      "uint8_t frame"},
     {331,
      "ODOMETRY: uint64_t time_usec, uint8_t frame_id, uint8_t child_frame_id, float x, float y, float "
      "z, float[4] q, float vx, float vy, float vz, float rollspeed, float pitchspeed, float yawspeed, "
      "float[21] pose_covariance, float[21] velocity_covariance | uint8_t reset_counter, uint8_t "
      "estimator_type, int8_t quality"},
     {11011,
      "VISION_POSITION_DELTA: uint64_t time_usec, uint64_t time_delta_usec, float[3] angle_delta, "
      "float[3] position_delta, float confidence"}});

struct DefinedField {
  std::string type, name;
  std::size_t size = 0, count = 0;  ///< count: 0 of what is no array
  std::size_t offset = 0;

  std::size_t bytes() const { return size * std::max<std::size_t>(count, 1); }
};

struct DefinedMessage {
  std::uint32_t number = 0;
  std::string name;
  std::vector<DefinedField> fields, extensions;  ///< in the order of the payload
  std::size_t bytes = 0;

  std::vector<DefinedField> all() const {
    std::vector<DefinedField> joined = fields;
    joined.insert(joined.end(), extensions.begin(), extensions.end());
    return joined;
  }
};

std::vector<std::string> split(std::string_view text, std::string_view at) {
  std::vector<std::string> parts;
  for (std::size_t end = 0; end != std::string_view::npos; text.remove_prefix(end + at.size())) {
    end = text.find(at);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) break;
  }
  return parts;
}

DefinedField field_of(const std::string& text) {
  const std::map<std::string, std::size_t> sizes = {{"char", 1},     {"int8_t", 1},   {"uint8_t", 1},
                                                    {"int16_t", 2},  {"uint16_t", 2}, {"int32_t", 4},
                                                    {"uint32_t", 4}, {"uint64_t", 8}, {"float", 4}};
  const std::vector<std::string> words = split(text, " ");
  const std::vector<std::string> type = split(words.at(0), "[");
  return {type[0], words.at(1), sizes.at(type[0]), type.size() > 1 ? std::stoul(type[1]) : 0};
}

/// Fields are sent by falling size of their type, extensions behind them as they are defined.
DefinedMessage defined(const MessageText& message) {
  const std::vector<std::string> parts = split(message.text, ": "), kinds = split(parts.at(1), " | ");
  DefinedMessage made{message.number, parts.at(0), {}, {}, 0};
  for (const std::string& field : split(kinds.at(0), ", ")) made.fields.push_back(field_of(field));
  std::ranges::stable_sort(made.fields, std::greater<>(), &DefinedField::size);
  if (kinds.size() > 1) {
    for (const std::string& field : split(kinds[1], ", ")) made.extensions.push_back(field_of(field));
  }
  for (std::vector<DefinedField>* fields : {&made.fields, &made.extensions}) {
    for (DefinedField& field : *fields) {
      field.offset = made.bytes;
      made.bytes += field.bytes();
    }
  }
  return made;
}

/// CRC-16/MCRF4XX, a bit at a time.
unsigned crc_of(std::string_view bytes) {
  unsigned value = 0xffff;
  for (const char byte : bytes) {
    value ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) value = (value & 1U) != 0 ? (value >> 1U) ^ 0x8408U : value >> 1U;
  }
  return value;
}

/// CRC_EXTRA: extensions are not part of it.
char extra_of(const DefinedMessage& message) {
  std::string text = message.name + " ";
  for (const DefinedField& field : message.fields) {
    text += field.type + " " + field.name + " ";
    if (field.count > 0) text += static_cast<char>(field.count);
  }
  const unsigned crc = crc_of(text);
  return static_cast<char>((crc & 0xffU) ^ (crc >> 8U));
}

/// A frame of MAVLink 2 with the first bytes of a payload, and the checksum of `checked` bytes of it.
std::string frame_of(const DefinedMessage& message, const std::string& payload, std::size_t sent, std::size_t checked) {
  const auto header = [&](std::size_t bytes) {
    std::string text = {static_cast<char>(bytes), 0, 0, 7, 1, 1};
    for (const unsigned shift : {0U, 8U, 16U}) text += static_cast<char>(message.number >> shift & 0xffU);
    return text;
  };
  const unsigned crc = crc_of(header(checked) + payload.substr(0, checked) + extra_of(message));
  return "\xfd" + header(sent) + payload.substr(0, sent) + static_cast<char>(crc & 0xffU) +
         static_cast<char>(crc >> 8U);
}

MavlinkFrame::Check check_of_frame(const std::string& frame) {
  const std::vector<std::uint8_t> bytes(frame.begin(), frame.end());
  const MavlinkRead read = read_mavlink(bytes);
  EXPECT_EQ(read.length, bytes.size());
  return read.frame ? read.frame->check : MavlinkFrame::Check::kWrong;
}

// Kills a wrong CRC_EXTRA: frames of that message would be dropped as damaged.
TEST(MavlinkDefinitions, ChecksumsAreThoseOfTheDefinitions) {
  for (const MessageText& text : kMessageTexts) {
    const DefinedMessage message = defined(text);
    SCOPED_TRACE(message.name);
    const std::string payload(message.bytes, '\1');
    EXPECT_EQ(check_of_frame(frame_of(message, payload, message.bytes, message.bytes)), MavlinkFrame::Check::kRight);
  }
}

// Kills a wrong length: the checksum of a payload whose zeros were cut off after it was made is over all of them.
TEST(MavlinkDefinitions, LengthsAreThoseOfTheDefinitions) {
  for (const MessageText& text : kMessageTexts) {
    const DefinedMessage message = defined(text);
    SCOPED_TRACE(message.name);
    std::string payload(message.bytes, '\0');
    payload[0] = '\1';
    EXPECT_EQ(check_of_frame(frame_of(message, payload, 1, message.bytes)), MavlinkFrame::Check::kRightPadded);
    EXPECT_EQ(check_of_frame(frame_of(message, payload, 1, message.bytes - 1)), MavlinkFrame::Check::kWrong);
  }
}

/// Of the field at a place of a message: differs from those of the others, and fits each type.
int number_of(std::size_t place) {
  return static_cast<int>(place) + 3;
}

std::string json_of(const DefinedMessage& message, const std::string& without = "") {
  std::string text = fmt::format(
      R"({{"header":{{"system_id":1,"component_id":1,"sequence":0}},"message":{{"type":"{}")", message.name);
  const std::vector<DefinedField> fields = message.all();
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (fields[i].name == without || fields[i].type == "char") continue;
    std::string value = std::to_string(number_of(i));
    for (std::size_t n = 1; n < fields[i].count; ++n) value += fmt::format(",{}", number_of(i));
    text += fmt::format(R"(,"{}":{})", fields[i].name, fields[i].count > 0 ? "[" + value + "]" : value);
  }
  return text + "}}";
}

/// The bytes of a field with its number.
std::string wire_of(const DefinedField& field, int number) {
  std::string one;
  if (field.type == "float") {
    const auto value = static_cast<float>(number);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    for (unsigned shift = 0; shift < 32; shift += 8) one += static_cast<char>(bits >> shift & 0xffU);
  } else {
    one = std::string(1, static_cast<char>(number)) + std::string(field.size - 1, '\0');
  }
  std::string all;
  for (std::size_t n = 0; n < std::max<std::size_t>(field.count, 1); ++n) all += one;
  return all;
}

// Kills numbers of messages and places of fields, of which a log of JSON and one of frames would differ.
TEST(MavlinkDefinitions, JsonBecomesThePayloadOfTheDefinition) {
  std::size_t converted = 0, needed = 0;
  for (const MessageText& text : kMessageTexts) {
    const DefinedMessage message = defined(text);
    SCOPED_TRACE(message.name);
    const auto frame = mavlink_frame_of_json(json_of(message));
    ASSERT_TRUE(frame);
    if (!is_converted_mavlink(message.name)) continue;
    ++converted;
    EXPECT_EQ(frame->message, message.number);
    std::string expected(frame->payload.size(), '\0');
    const std::vector<DefinedField> fields = message.all();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const bool is_needed = !mavlink_frame_of_json(json_of(message, fields[i].name));
      if (!is_needed) continue;
      ++needed;
      expected.replace(fields[i].offset, fields[i].bytes(), wire_of(fields[i], number_of(i)));
    }
    EXPECT_EQ(std::string(frame->payload.begin(), frame->payload.end()), expected);
  }
  EXPECT_EQ(converted, 14U);
  EXPECT_GE(needed, 55U);
}

}  // namespace
}  // namespace pingvox
