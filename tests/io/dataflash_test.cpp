#include "io/nav/dataflash.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "support/frames.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

// What an autopilot wrote (BlueROV2, 2023-05-04): the layout of ATT, and one.
std::vector<std::uint8_t> layout() {
  auto bytes = from_hex(
      "a39580 64 1c 41545400 51636363634343434342000000000000 54696d6555532c446573526f6c6c2c526f6c6c2c446573506974"
      "63682c50697463682c4465735961772c5961772c45727252502c4572725961772c41454b46");
  bytes.resize(89);
  return bytes;
}
constexpr std::string_view kAttitude = "a39564 e1d8d60f00000000 f8ff f8ff c1ff c1ff 9153 9153 0000 0200 03";

Result<NavFile> read_as_dataflash(std::vector<std::uint8_t> bytes) {
  return read_nav({"00000001.BIN", std::move(bytes)});
}

TEST(Dataflash, ReadsRecordsAsTheirLayoutSays) {
  const auto bytes = joined({layout(), from_hex(kAttitude)});
  EXPECT_EQ(format_of(bytes), Format::kDataflash);
  const auto nav = read_as_dataflash(bytes);
  ASSERT_TRUE(nav) << nav.error().message;
  EXPECT_EQ(nav->records, 2U);
  EXPECT_TRUE(nav->damage.empty());
  ASSERT_EQ(nav->log.sources().size(), 1U);
  const NavSample& sample = nav->log.sources()[0].samples.at(0);
  EXPECT_NEAR(sample.time_s, 265.738465, 1e-9);
  EXPECT_NEAR(sample.value.x(), -0.08 * kDegree_rad, 1e-9);
  EXPECT_NEAR(sample.value.y(), 0.63 * kDegree_rad, 1e-9);
  EXPECT_NEAR(sample.value.z(), (90 - 213.93) * kDegree_rad, 1e-9);
}

TEST(Dataflash, KeepsWhatIsWholeOfALogCutInARecord) {
  auto bytes = joined({layout(), from_hex(kAttitude), from_hex(kAttitude)});
  bytes.pop_back();
  const auto nav = read_as_dataflash(bytes);
  ASSERT_TRUE(nav);
  EXPECT_EQ(nav->records, 2U);
  ASSERT_EQ(nav->damage.size(), 1U);
  EXPECT_EQ(nav->damage[0].what, "cut off at the end");
  EXPECT_EQ(nav->damage[0].first_byte, 89U + 28U);
}

TEST(Dataflash, StepsOverATypeWhoseLayoutDoesNotFit) {
  auto bytes = joined({layout(), from_hex(kAttitude), {0}, from_hex(kAttitude), {0}});
  bytes[4] = 0x1d;
  const auto nav = read_as_dataflash(bytes);
  ASSERT_TRUE(nav);
  EXPECT_EQ(nav->records, 3U);
  EXPECT_TRUE(nav->log.sources().empty());
  ASSERT_EQ(nav->damage.size(), 1U);
  EXPECT_EQ(nav->damage[0].what, "type whose fields do not fill its record");
}

TEST(Dataflash, FindsTheNextRecordBehindStrayBytes) {
  // Among them what looks like the beginning of a record.
  const auto nav =
      read_as_dataflash(joined({layout(), from_hex("0102a3956403"), from_hex(kAttitude), from_hex(kAttitude)}));
  ASSERT_TRUE(nav);
  EXPECT_EQ(nav->records, 3U);
  ASSERT_EQ(nav->damage.size(), 1U);
  EXPECT_EQ(nav->damage[0].what, "bytes between records");
  EXPECT_EQ(nav->damage[0].first_byte, 89U);
}

struct Recording {
  const char* file;
  std::size_t records, types, tail_bytes;
  std::map<std::string, std::size_t> counts;
};

class RealDataflash : public testing::TestWithParam<Recording> {};

TEST_P(RealDataflash, HasAsManyRecordsAsItsReadmeSays) {
  const std::filesystem::path path = std::filesystem::path(PINGVOX_SHARED_DATA) / GetParam().file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto file = read_file(path.string());
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(format_of(file->view()), Format::kDataflash);
  std::vector<DamageKind> damage;
  std::map<std::string, std::size_t> counts;
  const std::size_t records = for_each_dataflash_record(
      file->view(), damage, [&](const DataflashRecord& record) { ++counts[record.type.name]; });
  EXPECT_EQ(records, GetParam().records);
  EXPECT_EQ(counts["FMT"], GetParam().types);
  for (const auto& [name, count] : GetParam().counts) EXPECT_EQ(counts[name], count) << name;
  if (GetParam().tail_bytes == 0) {
    EXPECT_TRUE(damage.empty());
  } else {
    ASSERT_EQ(damage.size(), 1U);
    EXPECT_EQ(damage[0].what, "cut off at the end");
    EXPECT_EQ(damage[0].first_byte, file->bytes.size() - GetParam().tail_bytes);
  }
}

// Velocities of the body, turned by attitudes and added up, are the way between two positions only when all frames are
// right. An independent decoder got 7.04 m north and 5.36 m east so, and 7.03 m and 3.59 m from the filter, which also
// uses a compass.
TEST(RealDataflashPath, TheVehicleWentWhereItsDopplerLogSays) {
  const std::filesystem::path path =
      std::filesystem::path(PINGVOX_SHARED_DATA) / "bluerov2-dvl-dataflash/00000029_filtered.BIN";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto nav = read_file(path.string()).and_then([](const FileBytes& file) { return read_nav(file); });
  ASSERT_TRUE(nav) << nav.error().message;
  const auto made = nav_trajectory(nav->log);
  ASSERT_TRUE(made) << made.error().message;
  const NavSource* velocities = nav->log.best(NavQuantity::kVelocity);
  ASSERT_NE(velocities, nullptr);
  double before_s = made->trajectory.poses().front().time_s;
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();
  for (const NavSample& sample : velocities->samples) {
    const auto pose = made->trajectory.at(sample.time_s);
    if (!pose) continue;
    moved += pose->linear() * sample.value * (sample.time_s - before_s);
    before_s = sample.time_s;
  }
  EXPECT_NEAR(moved.x(), 5.36, 0.3) << "of 23 m: it summed the steps that the device names";
  EXPECT_NEAR(moved.y(), 7.04, 0.3);
  const Eigen::Vector3d by_filter = made->trajectory.poses().back().map_from_body.translation() -
                                    made->trajectory.poses().front().map_from_body.translation();
  EXPECT_NEAR(by_filter.x(), 3.59, 0.01);
  EXPECT_NEAR(by_filter.y(), 7.03, 0.01);
  EXPECT_NEAR(moved.z(), by_filter.z(), 0.2);
}

INSTANTIATE_TEST_SUITE_P(
    Recordings, RealDataflash,
    testing::Values(Recording{"bluerov2-tlog-bin/00000002.BIN",
                              7510,
                              152,
                              0,
                              {{"ATT", 237},
                               {"XKF1", 237},
                               {"CTUN", 237},
                               {"AHR2", 237},
                               {"IMU", 594},
                               {"BARO", 474},
                               {"PARM", 876},
                               {"FMTU", 152},
                               {"MSG", 9}}},
                    Recording{"bluerov2-dvl-dataflash/00000029_filtered.BIN",
                              82'929,
                              170,
                              0,
                              {{"VISO", 1588},
                               {"ATT", 1999},
                               {"CTUN", 1999},
                               {"AHR2", 1999},
                               {"RFND", 3999},
                               {"IMU", 4999},
                               {"BARO", 3998}}},
                    Recording{"bluerov2-echosounder-nav/00000124.BIN", 102'651, 164, 24, {{"RFND", 5746}}},
                    Recording{"generic-mavlink-dataflash/plane_test_64k.BIN", 1731, 132, 24, {}},
                    Recording{"generic-mavlink-dataflash/copter_3.1.3_2014-10-18 21-12-23.bin", 3051, 30, 28, {}}));

/// The DVL's velocities, turned by the attitude nearest in time and added up.
TEST(RealDataflash, VelocitiesAndAttitudesGiveTheWayThatTheVehicleWent) {
  const std::string path = PINGVOX_SHARED_DATA "/bluerov2-dvl-dataflash/00000029_filtered.BIN";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto file = read_file(path);
  ASSERT_TRUE(file);
  const auto nav = read_nav(*file);
  ASSERT_TRUE(nav) << nav.error().message;
  const NavSource* velocity = nav->log.best(NavQuantity::kVelocity);
  const NavSource* attitude = nav->log.best(NavQuantity::kAttitude);
  const NavSource* depth = nav->log.best(NavQuantity::kDepth);
  ASSERT_TRUE(velocity != nullptr && attitude != nullptr && depth != nullptr);
  EXPECT_EQ(velocity->samples.size(), 1588U);
  EXPECT_NEAR(summary_of(*velocity).rate_hz, 1 / 0.109, 0.5);
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i < velocity->samples.size(); ++i) {
    const NavSample &a = velocity->samples[i - 1], &b = velocity->samples[i];
    const auto near = std::lower_bound(attitude->samples.begin(), attitude->samples.end(), b.time_s,
                                       [](const NavSample& s, double time_s) { return s.time_s < time_s; });
    const Eigen::Vector3d rpy = near != attitude->samples.end() ? near->value : attitude->samples.back().value;
    moved += pose_from_rpy({0, 0, 0}, rpy.x(), rpy.y(), rpy.z()).linear() * b.value * (b.time_s - a.time_s);
  }
  // By the recording's own account: 7.04 m to the north, 5.36 m to the east.
  EXPECT_NEAR(moved.x(), 5.36, 0.3);
  EXPECT_NEAR(moved.y(), 7.04, 0.3);
  const auto [least, most] =
      std::minmax_element(depth->samples.begin(), depth->samples.end(),
                          [](const NavSample& a, const NavSample& b) { return a.value.x() < b.value.x(); });
  EXPECT_NEAR(least->value.x(), 12.45, 0.02);
  EXPECT_NEAR(most->value.x(), 13.78, 0.02);
}

}  // namespace
}  // namespace pingvox
