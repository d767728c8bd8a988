#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {

/// What the times of the beams of a source count from.
enum class BeamClock {
  kOwn,        ///< a clock of the log, the device or the computer, with or without a date
  kTimeOfDay,  ///< midnight, in the time zone of the computer that recorded
  kNone,       ///< nothing: the log has no times, those of its beams are by the usual rate of a serial line
};

/// Intensities that the sonar received from one ping in one direction.
struct Beam {
  double time_s = 0.0;        ///< on the log's own clock; finite
  double bearing_rad = 0.0;   ///< sensor frame: 0 ahead (x), counter-clockwise seen from above; in [0, 2 pi)
  double bin_length_m = 0.0;  ///< > 0
  std::vector<std::uint8_t> intensities;  ///< bin i covers [i, i + 1) * bin_length_m from the transducer
};

/// The longest beam that readers accept: the longest range of a mechanically scanned head, a SeaKing's, is 300 m.
/// Lengths in cm or mm are beyond, and a damaged number cannot make an endless ray.
inline constexpr double kMaxBeamRange_m = 500.0;

/// Checks the ranges documented in Beam, and kMaxBeamRange_m. Readers call it on each beam, so that other code need
/// not.
/// @return kCorrupt naming the invalid field
Result<void> validate(const Beam& beam);

/// Any angle [rad] in [0, 2 pi). REQUIRES a finite angle.
double wrap_bearing(double angle_rad);

/// One kind of damage that a source skipped.
struct DamageKind {
  std::string_view what;  ///< in a few words, as in "wrong checksum"; lives as long as the program
  std::size_t count = 0;  ///< number of occurrences
  /// Position of the first one in the log, from 0; nullopt where it is not known (in databases).
  std::optional<std::uint64_t> first_byte;
};

/// Occurrences of all kinds.
std::size_t damage_count(std::span<const DamageKind> kinds);
/// Place and reason of the first one, as in "byte 23: wrong checksum".
std::string first_damage_text(const DamageKind& kind);

/// Beams in the order of recording: a log, a simulator, or a live device.
class BeamSource {
 public:
  virtual ~BeamSource() = default;
  /// The next beam; nullopt at the end; an error when nothing more can be read. Damaged records are skipped and counted
  /// where that is possible.
  virtual Result<std::optional<Beam>> next() = 0;
  /// Beams (or records that should have been one) skipped so far because they were damaged: by default the sum of
  /// damage().
  virtual std::size_t skipped() const;
  /// Skipped records by kind of damage, in order of first occurrence; empty where the source does not distinguish them.
  virtual std::vector<DamageKind> damage() const { return {}; }
  /// Place and reason of the first skipped record, as in "line 23: time is not a finite number"; empty when none was
  /// skipped. By default of damage().
  virtual std::string first_damage() const;
  /// The sonar head, if the log or its format names it; else nullptr.
  virtual const DeviceProfile* device() const { return nullptr; }
  virtual BeamClock clock() const { return BeamClock::kOwn; }
  /// Deviations from the format in reading its beams, as in "angles are in gradians, not in radians"; empty: none.
  /// Known with the first beam.
  virtual std::string note() const { return {}; }
  /// Fraction read so far, 0..1, for a progress bar; nullopt if the size is unknown.
  virtual std::optional<double> share_read() const { return std::nullopt; }
};

/// Beams in memory as a source.
class BeamsInMemory final : public BeamSource {
 public:
  explicit BeamsInMemory(std::vector<Beam> beams) : beams_(std::move(beams)) {}
  Result<std::optional<Beam>> next() override;

 private:
  std::vector<Beam> beams_;
  std::size_t next_ = 0;
};

/// Reads all remaining beams. Not for a live device, which has no end.
/// @return the source's error if it fails before its end
Result<std::vector<Beam>> read_all(BeamSource& source);

}  // namespace pingvox
