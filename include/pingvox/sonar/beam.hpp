#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {

/// What the sonar heard of one ping in one direction.
struct Beam {
  double time_s = 0.0;        ///< on the log's own clock; finite
  double bearing_rad = 0.0;   ///< sensor frame: 0 ahead (x), counter-clockwise seen from above; in [0, 2 pi)
  double bin_length_m = 0.0;  ///< > 0
  std::vector<std::uint8_t> intensities;  ///< bin i covers [i, i + 1) * bin_length_m from the transducer
};

/// The longest beam that a reader lets through: far above what these sonars do, and small enough that no damaged number
/// turns into a ray that never ends.
inline constexpr double kMaxBeamRange_m = 10'000.0;

/// Checks what the comments of Beam promise, and the range. kCorrupt names the broken field. Readers call it on each
/// beam, so that nobody behind them has to.
Result<void> validate(const Beam& beam);

/// Any angle [rad] in [0, 2 pi). REQUIRES a finite angle.
double wrapped_bearing(double angle_rad);

/// One kind of damage that a source stepped over.
struct DamageKind {
  std::string_view what;         ///< in a few words, as in "wrong checksum"; lives as long as the program
  std::size_t count = 0;         ///< how often it was met
  std::uint64_t first_byte = 0;  ///< where in the log for the first time, from 0
};

/// Beams in the order in which they were heard: a log, a simulator, later a live device.
class BeamSource {
 public:
  virtual ~BeamSource() = default;
  /// The next beam; nullopt at the end; an error when nothing more can be read. Damage that can be stepped over is
  /// stepped over and counted.
  virtual Result<std::optional<Beam>> next() = 0;
  /// Beams (or records that should have been one) left out so far because they were damaged.
  virtual std::size_t skipped() const { return 0; }
  /// The same by kind, in the order in which they were met; empty where the source does not tell them apart.
  virtual std::vector<DamageKind> damage() const { return {}; }
  /// The head that was heard, as far as the log says or its format tells; nullptr: nobody knows.
  virtual const DeviceProfile* device() const { return nullptr; }
  /// How much of all there is was read so far, 0..1, for a progress bar; nullopt: nobody knows.
  virtual std::optional<double> share_read() const { return std::nullopt; }
};

/// All beams that a source still has, at once. For what needs them all: a log of hours fits into memory, a live device
/// has no end.
/// @return the source's error when it does not come to its end
Result<std::vector<Beam>> read_all(BeamSource& source);

}  // namespace pingvox
