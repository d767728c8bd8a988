#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "io/internal/frame_finder.hpp"
#include "io/readers.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// A log file that holds the bytes of a serial line, in pieces whose ends are unrelated to frames.
class FrameContainer {
 public:
  struct Piece {
    std::span<const std::uint8_t> bytes;  ///< valid until the next call
    std::uint64_t file_byte = 0;          ///< position of the first byte in the file
    unsigned file_step = 1;               ///< distance of bytes in the file: 3 in hexadecimal text
    double time_s = 0.0;                  ///< time of the first byte
    double time_step_s = 0.0;             ///< time from byte to byte
  };

  virtual ~FrameContainer() = default;
  virtual const std::string& name() const = 0;
  virtual Result<std::optional<Piece>> next() = 0;  ///< nullopt: the end
  virtual std::optional<double> share_read() const = 0;
  virtual BeamClock clock() const { return BeamClock::kOwn; }
  /// Damage of the container itself, with positions in the file.
  const std::vector<DamageKind>& damage() const { return damage_; }

 protected:
  std::vector<DamageKind> damage_;
};

/// A serial protocol of a sonar.
struct FrameProtocol {
  CheckFrame check;
  /// The frame's beam; nullopt: another message; error: reason why it is invalid.
  tl::expected<std::optional<Beam>, std::string> (*beam_in)(std::span<const std::uint8_t> frame, double time_s);
  /// The head that sent a beam.
  const DeviceProfile* (*device_of)(std::span<const std::uint8_t> frame);
  /// The head's number on the line.
  unsigned (*head_of)(std::span<const std::uint8_t> frame);
  /// Fewer bytes between two frames are noise of the line, and no damage; 1: there is no noise.
  std::size_t least_between = 1;
};

const FrameProtocol& ping_protocol();
const FrameProtocol& sonarview_protocol();
const FrameProtocol& seanet_protocol();

/// Time that a byte takes at the usual rate of 115,200 bits/s, ten bits a byte: for logs without times.
inline constexpr double kSerialByte_s = 10.0 / 115200.0;

/// The bytes of a serial line and nothing else. Their times are those at the usual rate.
std::unique_ptr<FrameContainer> raw_capture(ByteStream stream);

/// The beams in a container; the time of each is that of its frame's last byte.
std::unique_ptr<BeamSource> beams_of(std::unique_ptr<FrameContainer> container, const FrameProtocol& protocol,
                                     Damage damage);

}  // namespace pingvox
