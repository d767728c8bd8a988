#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "io/readers.hpp"
#include "pingvox/io/frame_finder.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// A log that holds the bytes of a serial line: they come in pieces, whose ends have nothing to do with frames.
class FrameContainer {
 public:
  struct Piece {
    std::span<const std::uint8_t> bytes;  ///< until the next call
    std::uint64_t file_byte = 0;          ///< where the first of them stands in the file
    unsigned file_step = 1;               ///< how far apart they stand there: 3 in hexadecimal text
    double time_s = 0.0;                  ///< when the first of them came
    double time_step_s = 0.0;             ///< how much later each next one did
  };

  virtual ~FrameContainer() = default;
  virtual const std::string& name() const = 0;
  virtual Result<std::optional<Piece>> next() = 0;  ///< nullopt: the end
  virtual std::optional<double> share_read() const = 0;
  /// Of the container itself, with places in the file.
  const std::vector<DamageKind>& damage() const { return damage_; }

 protected:
  std::vector<DamageKind> damage_;
};

/// How a protocol's frames are found and what they say.
struct FrameProtocol {
  CheckFrame check;
  /// The frame's beam; nullopt: it is another message; an error: what is wrong with it.
  tl::expected<std::optional<Beam>, std::string> (*beam_in)(std::span<const std::uint8_t> frame, double time_s);
  /// The head that sent a frame with a beam.
  const DeviceProfile* (*device_of)(std::span<const std::uint8_t> frame);
};

const FrameProtocol& ping_protocol();
const FrameProtocol& seanet_protocol();

/// The beams of a container's frames; the time of each is that of the piece that has its frame's last byte.
std::unique_ptr<BeamSource> beams_of(std::unique_ptr<FrameContainer> container, const FrameProtocol& protocol,
                                     Damage damage);

}  // namespace pingvox
