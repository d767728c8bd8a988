#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace pingvox {

/// One frame of MAVLink 1 or 2 (docs/formats.md).
struct MavlinkFrame {
  enum class Check {
    kRight,           ///< the checksum is right
    kRightPadded,     ///< right for the payload before its zeros at the end were cut off: what BlueOS sent until 2023
    kUnknownMessage,  ///< a message without a known definition, so its checksum cannot be verified
    kWrong,
  };

  std::uint32_t message = 0;
  std::uint8_t system = 0, component = 0, sequence = 0;
  Check check = Check::kWrong;
  std::size_t payload_bytes = 0;            ///< as sent
  std::array<std::uint8_t, 255> payload{};  ///< followed by zeros for fields that were not sent
};

/// The frame that `bytes` begin with, and its length. `frame` is empty when they begin with none, or with less than a
/// whole one: then `is_cut` says that more bytes are needed.
struct MavlinkRead {
  std::optional<MavlinkFrame> frame;
  std::size_t length = 0;
  bool is_cut = false;
};
MavlinkRead read_mavlink(std::span<const std::uint8_t> bytes);

struct MavlinkSender {
  std::uint8_t sequence = 0, system = 1, component = 1;
};
/// A frame of MAVLink 2. REQUIRES a message that `read_mavlink` can check, and at most its whole payload.
std::vector<std::uint8_t> make_mavlink_frame(std::uint32_t message, std::span<const std::uint8_t> payload,
                                             const MavlinkSender& sender);

}  // namespace pingvox
