#include "pingvox/sonar/device_profile.hpp"

#include <algorithm>
#include <array>

#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

constexpr std::string_view kTritechIntensity =
    "0..255 are 0..80 dB, before the display's window; the gain, 0..210 for 0..100 %, is applied by the head";

constexpr std::array kProfiles = {
    DeviceProfile{"ping360", "Blue Robotics Ping360", 2.0 * kDegree_rad, 25.0 * kDegree_rad, 0.75, 255,
                  "linear, no range compensation; gain 0 low, 1 normal, 2 high, applied by the head",
                  "Blue Robotics, Ping360 product page, specification table"},
    DeviceProfile{"micron", "Tritech Micron", 3.0 * kDegree_rad, 35.0 * kDegree_rad, 0.3, 255, kTritechIntensity,
                  "Tritech, data sheet Micron sonar"},
    DeviceProfile{"miniking", "Tritech MiniKing", 3.0 * kDegree_rad, 40.0 * kDegree_rad, 0.4, 255, kTritechIntensity,
                  "Tritech, data sheet MiniKing imaging sonar"},
    DeviceProfile{"seaking-325", "Tritech SeaKing at 325 kHz", 3.0 * kDegree_rad, 20.0 * kDegree_rad, 0.4, 255,
                  kTritechIntensity, "Tritech, data sheet Super SeaKing DST, low frequency"},
    DeviceProfile{"seaking-675", "Tritech SeaKing at 675 kHz", 1.5 * kDegree_rad, 40.0 * kDegree_rad, 0.4, 255,
                  kTritechIntensity, "Tritech, data sheet Super SeaKing DST, high frequency"},
};

}  // namespace

std::span<const DeviceProfile> device_profiles() {
  return kProfiles;
}

const DeviceProfile* find_device(std::string_view name) {
  const auto found = std::ranges::find(kProfiles, name, &DeviceProfile::name);
  return found == kProfiles.end() ? nullptr : &*found;
}

}  // namespace pingvox
