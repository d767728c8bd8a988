#include "io/internal/mavlink.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace pingvox {
namespace {

constexpr std::uint8_t kMagic1 = 0xfe, kMagic2 = 0xfd;
constexpr std::size_t kHeader1 = 6, kHeader2 = 10, kChecksumBytes = 2, kSignature = 13;
constexpr std::uint8_t kSigned = 0x01;

/// What the checksum needs of a message's definition (mavlink/c_library_v2).
struct Definition {
  std::uint32_t message;
  std::uint8_t extra;  ///< CRC_EXTRA: stands for the layout of the fields
  std::uint8_t bytes;  ///< of the whole payload, extension fields included
};

constexpr std::array kDefinitions = {
    Definition{0, 50, 9},       // HEARTBEAT
    Definition{2, 137, 12},     // SYSTEM_TIME
    Definition{22, 220, 25},    // PARAM_VALUE
    Definition{24, 24, 52},     // GPS_RAW_INT
    Definition{29, 115, 16},    // SCALED_PRESSURE
    Definition{30, 39, 28},     // ATTITUDE
    Definition{31, 246, 48},    // ATTITUDE_QUATERNION
    Definition{32, 185, 28},    // LOCAL_POSITION_NED
    Definition{33, 104, 28},    // GLOBAL_POSITION_INT
    Definition{49, 39, 20},     // GPS_GLOBAL_ORIGIN
    Definition{74, 20, 20},     // VFR_HUD
    Definition{102, 158, 117},  // VISION_POSITION_ESTIMATE
    Definition{103, 208, 57},   // VISION_SPEED_ESTIMATE
    Definition{132, 85, 39},    // DISTANCE_SENSOR
    Definition{137, 195, 16},   // SCALED_PRESSURE2
    Definition{143, 131, 16},   // SCALED_PRESSURE3
    Definition{173, 83, 8},     // RANGEFINDER
    Definition{178, 47, 24},    // AHRS2
    Definition{232, 151, 65},   // GPS_INPUT
    Definition{251, 170, 18},   // NAMED_VALUE_FLOAT
    Definition{253, 83, 54},    // STATUSTEXT
    Definition{330, 23, 167},   // OBSTACLE_DISTANCE
    Definition{331, 91, 233},   // ODOMETRY
    Definition{11011, 106, 44}  // VISION_POSITION_DELTA
};

const Definition* definition_of(std::uint32_t message) {
  const auto* const found =
      std::lower_bound(kDefinitions.begin(), kDefinitions.end(), message,
                       [](const Definition& definition, std::uint32_t wanted) { return definition.message < wanted; });
  return found != kDefinitions.end() && found->message == message ? found : nullptr;
}

/// CRC-16/MCRF4XX.
class Checksum {
 public:
  Checksum& add(std::uint8_t byte) {
    unsigned mixed = byte ^ (value_ & 0xffU);
    mixed = (mixed ^ (mixed << 4U)) & 0xffU;
    value_ = ((value_ >> 8U) ^ (mixed << 8U) ^ (mixed << 3U) ^ (mixed >> 4U)) & 0xffffU;
    return *this;
  }
  Checksum& add(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) add(byte);
    return *this;
  }
  unsigned value() const { return value_; }

 private:
  unsigned value_ = 0xffff;
};

/// @param header  without the magic byte
MavlinkFrame::Check check_of(const MavlinkFrame& frame, std::span<const std::uint8_t> header, unsigned sent) {
  const Definition* const definition = definition_of(frame.message);
  if (definition == nullptr) return MavlinkFrame::Check::kUnknownMessage;
  const std::span<const std::uint8_t> payload(frame.payload);
  const auto as_sent = Checksum().add(header).add(payload.first(frame.payload_bytes)).add(definition->extra);
  if (as_sent.value() == sent) return MavlinkFrame::Check::kRight;
  const bool is_version_2 = header.size() + 1 == kHeader2;
  if (!is_version_2 || frame.payload_bytes >= definition->bytes) return MavlinkFrame::Check::kWrong;
  const auto padded = Checksum()
                          .add(definition->bytes)
                          .add(header.subspan(1))
                          .add(payload.first(definition->bytes))
                          .add(definition->extra);
  return padded.value() == sent ? MavlinkFrame::Check::kRightPadded : MavlinkFrame::Check::kWrong;
}

}  // namespace

MavlinkRead read_mavlink(std::span<const std::uint8_t> bytes) {
  MavlinkRead read;
  const auto cut = [&read] {
    read.is_cut = true;
    return read;
  };
  if (bytes.empty()) return cut();
  if (bytes[0] != kMagic1 && bytes[0] != kMagic2) return read;
  const bool is_version_2 = bytes[0] == kMagic2;
  const std::size_t header = is_version_2 ? kHeader2 : kHeader1;
  if (bytes.size() < 3) return cut();
  const std::size_t payload = bytes[1];
  // An unknown flag may change the layout: such frames have to be dropped.
  if (is_version_2 && (bytes[2] & ~kSigned) != 0) return read;
  const std::size_t length =
      header + payload + kChecksumBytes + (is_version_2 && (bytes[2] & kSigned) != 0 ? kSignature : 0);
  if (bytes.size() < length) return cut();

  MavlinkFrame& frame = read.frame.emplace();
  read.length = length;
  if (is_version_2) {
    frame.sequence = bytes[4];
    frame.system = bytes[5];
    frame.component = bytes[6];
    frame.message = static_cast<std::uint32_t>(bytes[7] | (bytes[8] << 8) | (bytes[9] << 16));
  } else {
    frame.sequence = bytes[2];
    frame.system = bytes[3];
    frame.component = bytes[4];
    frame.message = bytes[5];
  }
  frame.payload_bytes = payload;
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(header), payload, frame.payload.begin());
  const auto sent = static_cast<unsigned>(bytes[header + payload] | (bytes[header + payload + 1] << 8));
  frame.check = check_of(frame, bytes.subspan(1, header - 1), sent);
  return read;
}

std::vector<std::uint8_t> make_mavlink_frame(std::uint32_t message, std::span<const std::uint8_t> payload,
                                             const MavlinkSender& sender) {
  const Definition* const definition = definition_of(message);
  assert(definition != nullptr && payload.size() <= definition->bytes);
  // Zeros at the end are not sent, but for the first byte.
  while (payload.size() > 1 && payload.back() == 0) payload = payload.first(payload.size() - 1);
  const auto byte_of = [message](unsigned shift) { return static_cast<std::uint8_t>((message >> shift) & 0xffU); };
  std::vector<std::uint8_t> frame = {kMagic2,
                                     static_cast<std::uint8_t>(payload.size()),
                                     0,
                                     0,
                                     sender.sequence,
                                     sender.system,
                                     sender.component,
                                     byte_of(0),
                                     byte_of(8),
                                     byte_of(16)};
  std::ranges::copy(payload, std::back_inserter(frame));
  const unsigned sum = Checksum().add(std::span(frame).subspan(1)).add(definition->extra).value();
  frame.push_back(static_cast<std::uint8_t>(sum & 0xffU));
  frame.push_back(static_cast<std::uint8_t>(sum >> 8U));
  return frame;
}

}  // namespace pingvox
