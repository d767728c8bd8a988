#pragma once

#include <span>
#include <string_view>

namespace pingvox {

/// What heads and their software take for the speed of sound when they turn times into ranges, and we too when a device
/// gives times only.
inline constexpr double kAssumedSoundSpeed_m_s = 1500.0;

/// What a maker says of a sonar head: what a beam of a log means beyond its numbers.
struct DeviceProfile {
  std::string_view name;       ///< lower case, as --device takes it
  std::string_view title;      ///< for people
  double beam_width_rad;       ///< horizontally, full angle at half power
  double beam_height_rad;      ///< vertically, the same
  double blanking_m;           ///< nothing nearer can be heard
  int full_scale;              ///< the largest intensity that the head gives, of 0..255
  std::string_view intensity;  ///< what the intensities are, and what gain does to them
  std::string_view source;     ///< of these numbers
};

/// All heads that we know.
std::span<const DeviceProfile> device_profiles();

/// nullptr: there is none of this name. The profile lives as long as the program.
const DeviceProfile* device_named(std::string_view name);

}  // namespace pingvox
