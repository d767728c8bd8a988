#pragma once

#include <span>
#include <string_view>

namespace pingvox {

/// Speed of sound that sonar heads and their software assume, and we too for devices that report times only.
inline constexpr double kAssumedSoundSpeed_m_s = 1500.0;

/// Data of a sonar head by its maker.
struct DeviceProfile {
  std::string_view name;       ///< lower case, the value of --device
  std::string_view title;      ///< for display
  double beam_width_rad;       ///< horizontally, full angle at half power
  double beam_height_rad;      ///< vertically, full angle at half power
  double blanking_m;           ///< minimum range of the head
  int full_scale;              ///< largest intensity that the head sends, of 0..255
  std::string_view intensity;  ///< meaning of the intensities, and the effect of gain
  std::string_view source;     ///< of this data
};

/// All known heads.
std::span<const DeviceProfile> device_profiles();

/// The head of this name, with static lifetime; nullptr if there is none.
const DeviceProfile* find_device(std::string_view name);

}  // namespace pingvox
