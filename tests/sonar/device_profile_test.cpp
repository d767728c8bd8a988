#include "pingvox/sonar/device_profile.hpp"

#include <gtest/gtest.h>

#include <set>

#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

TEST(DeviceProfile, EachIsFoundByItsOwnNameAndNoneByAnother) {
  std::set<std::string_view> names;
  for (const DeviceProfile& profile : device_profiles()) {
    EXPECT_EQ(find_device(profile.name), &profile);
    EXPECT_GT(profile.beam_width_rad, 0.0);
    EXPECT_GT(profile.beam_height_rad, profile.beam_width_rad);
    EXPECT_FALSE(profile.source.empty());
    names.insert(profile.name);
  }
  EXPECT_EQ(names.size(), device_profiles().size());
  EXPECT_EQ(find_device("Ping360"), nullptr);
}

TEST(DeviceProfile, AnglesAreInRadians) {
  EXPECT_NEAR(find_device("ping360")->beam_width_rad, 2.0 * kDegree_rad, 1e-15);
  EXPECT_NEAR(find_device("micron")->beam_height_rad, 35.0 * kDegree_rad, 1e-15);
}

}  // namespace
}  // namespace pingvox
