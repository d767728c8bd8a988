#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/bag.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::SizeIs;

/// A recording beside the project; tests without it are skipped.
std::string recording(const std::string& name) {
  const std::string path = PINGVOX_SHARED_DATA "/" + name;
  return std::filesystem::exists(path) ? path : "";
}

ReadResult<Beam> beams_of(const std::string& path, const std::string& topic = "") {
  auto stream = ByteStream::open(path);
  if (!stream) return {{}, 0, stream.error().message};
  return read_everything<Beam>(open_beams(*std::move(stream), Damage::kSkip, {.name = topic}));
}

TEST(BagRecordings, LinesOfAMicron) {
  for (const auto& [name, beams, step_m, first_s] :
       {std::tuple("2014-07-18-21-02-59.bag", 2028U, 0.05, 1405710180.828797),
        std::tuple("2014-07-18-21-11-13.bag", 1690U, 0.10, 1405710674.652755)}) {
    const std::string path = recording(std::string("micron-lines-bags/") + name);
    if (path.empty()) GTEST_SKIP() << "no recording";
    const auto read = beams_of(path);
    EXPECT_EQ(read.error, "");
    EXPECT_EQ(read.skipped, 0U);
    ASSERT_THAT(read.items, SizeIs(beams));
    EXPECT_NEAR(read.items.front().time_s, first_s, 1e-5);
    for (const Beam& beam : read.items) {
      ASSERT_THAT(beam.intensities, SizeIs(200));
      ASSERT_NEAR(beam.bin_length_m, step_m, 1e-8);
    }
  }
}

TEST(BagRecordings, AWrongBitInTheFirstChunkCostsItsOwnSlices) {
  const std::string path = recording("micron-ratzeburg-bag/RatzeburgerSee-2019-01-22-15-05-01.bag");
  if (path.empty()) GTEST_SKIP() << "no recording";
  auto file = read_file(path);
  ASSERT_TRUE(file);
  file->bytes[142'224] ^= 4;
  const auto read = all_beams(*file);
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.skipped, 1U);
  EXPECT_THAT(read.items, SizeIs(581)) << "of 666";
}

TEST(BagRecordings, CompressedSlicesAreThoseOfTheList) {
  const std::string path = recording("micron-ratzeburg-bag/RatzeburgerSee-2019-01-22-15-05-01.bag");
  const std::string list = recording("micron-ratzeburg-bag/micron_beams.txt");
  if (path.empty() || list.empty()) GTEST_SKIP() << "no recording";
  const auto read = beams_of(path);
  EXPECT_EQ(read.error, "");
  ASSERT_THAT(read.items, SizeIs(666));
  std::ifstream lines(list);
  std::string line;
  std::getline(lines, line);
  for (const Beam& beam : read.items) {
    std::getline(lines, line);
    std::istringstream words(line);
    double stamp_s = 0, recorded_s = 0, angle_rad = 0, range_m = 0;
    std::size_t bins = 0;
    words >> stamp_s >> recorded_s >> angle_rad >> range_m >> bins;
    ASSERT_NEAR(beam.time_s, stamp_s, 1e-5);
    ASSERT_NEAR(std::sin(beam.bearing_rad), std::sin(std::numbers::pi - angle_rad), 1e-8);
    ASSERT_NEAR(std::cos(beam.bearing_rad), std::cos(std::numbers::pi - angle_rad), 1e-8);
    ASSERT_EQ(beam.intensities.size(), bins);
    ASSERT_NEAR(beam.bin_length_m * static_cast<double>(bins), range_m, 1e-9);
    for (const std::uint8_t intensity : beam.intensities) {
      int listed = -1;
      words >> listed;
      ASSERT_EQ(listed, intensity);
    }
  }
}

// Its driver sends each beam as points, too.
TEST(BagRecordings, PointsOfAMicronAreTheBeamsOfItsSlices) {
  const std::string path = recording("micron-ratzeburg-bag/RatzeburgerSee-2019-01-22-15-05-01.bag");
  if (path.empty()) GTEST_SKIP() << "no recording";
  const auto points = beams_of(path, "/tritech_micron/scan"), slices = beams_of(path);
  EXPECT_EQ(points.error, "");
  ASSERT_THAT(points.items, SizeIs(665));
  std::size_t same = 0;
  for (const Beam& beam : points.items) {
    for (const Beam& slice : slices.items) {
      if (std::abs(slice.time_s - beam.time_s) > 0.05) continue;
      ASSERT_EQ(beam.intensities, slice.intensities);
      ASSERT_NEAR(std::remainder(beam.bearing_rad - slice.bearing_rad, 2.0 * std::numbers::pi), 0.0, 1e-5);
      ASSERT_NEAR(beam.bin_length_m, slice.bin_length_m, 1e-7);
      ++same;
    }
  }
  EXPECT_EQ(same, 665U);
}

// Kills a path that is mirrored: the driver writes the latitude into the field `lon`.
TEST(BagRecordings, FixesOnTheLakeOfRatzeburg) {
  const std::string path = recording("micron-ratzeburg-bag/RatzeburgerSee-2019-01-22-15-05-01.bag");
  if (path.empty()) GTEST_SKIP() << "no recording";
  const auto nav = read_nav(*ByteStream::open(path));
  ASSERT_TRUE(nav);
  std::size_t fixes = 0;
  for (const NavSource& source : nav->log.sources()) {
    if (source.quantity != NavQuantity::kFix) continue;
    for (const NavSample& sample : source.samples) {
      ASSERT_NEAR(sample.value.x() / kDegree_rad, 53.7784, 1e-3);
      ASSERT_NEAR(sample.value.y() / kDegree_rad, 10.7550, 1e-3);
      ++fixes;
    }
  }
  EXPECT_EQ(fixes, 1353U);
}

TEST(BagRecordings, Ping360AndNavigationInOneDatabase) {
  const std::string path = recording("solaqua-ping360-dvl/sintef_dataset_ros2_bag_fixed.db3");
  if (path.empty()) GTEST_SKIP() << "no recording";
  const auto read = beams_of(path);
  EXPECT_EQ(read.error, "");
  EXPECT_THAT(read.items, SizeIs(333));
  EXPECT_EQ(read.skipped, 8U) << "pings without an answer";
  for (const Beam& beam : read.items) {
    ASSERT_THAT(beam.intensities, SizeIs(1200));
    ASSERT_NEAR(beam.bin_length_m, 0.0041625, 1e-12) << "of the settings, not of the ping";
  }
  auto stream = ByteStream::open(path);
  ASSERT_TRUE(stream);
  const auto bag = read_bag(*std::move(stream));
  ASSERT_TRUE(bag) << bag.error().message;
  EXPECT_THAT(bag->topics, SizeIs(26));
  std::size_t messages = 0;
  for (const BagTopicSummary& topic : bag->topics) messages += topic.messages;
  EXPECT_EQ(messages, 15'761U);
  const auto summary = [&](std::string_view name, NavQuantity quantity) {
    for (const NavSource& source : bag->nav.log.sources()) {
      if (source.name == name && source.quantity == quantity) return summary_of(source);
    }
    return NavSummary{};
  };
  EXPECT_EQ(summary("/sensor/dvl_velocity", NavQuantity::kVelocity).samples, 834U);
  EXPECT_EQ(summary("/sensor/dvl_velocity", NavQuantity::kVelocity).invalid, 13U);
  EXPECT_EQ(summary("/sensor/dvl_position", NavQuantity::kPosition).samples, 427U);
  EXPECT_EQ(summary("/sensor/attitude", NavQuantity::kAttitude).samples, 1498U);
  EXPECT_EQ(summary("/sensor/depth_temperature", NavQuantity::kDepth).samples, 1412U);
  EXPECT_EQ(summary("/sensor/usbl", NavQuantity::kPosition).samples, 48U);
  const auto path_of_vehicle = nav_trajectory(bag->nav.log);
  ASSERT_TRUE(path_of_vehicle);
  // It moves to its left along the net, 15 m in all, at one depth.
  const auto& poses = path_of_vehicle->trajectory.poses();
  const Eigen::Vector3d early = poses[40].map_from_body.translation(), late = poses[400].map_from_body.translation();
  const Eigen::Vector3d left = poses[40].map_from_body.rotation().col(1);
  EXPECT_GT((late - early).dot(left), 11.0);
  EXPECT_NEAR((late - early).z(), 0.0, 0.4);
}

TEST(BagRecordings, ADvlA50) {
  for (const auto& [name, reports, valid] :
       {std::tuple("dvl_slow_rectangle.bag", 457U, 407U), std::tuple("dvl_circle.bag", 378U, 303U)}) {
    const std::string path = recording(std::string("dvl-a50/") + name);
    if (path.empty()) GTEST_SKIP() << "no recording";
    const auto nav = read_nav(*ByteStream::open(path));
    ASSERT_TRUE(nav);
    // Velocity and range as its driver sends them, and as the device says them itself.
    ASSERT_THAT(nav->log.sources(), SizeIs(4));
    const NavSource* own = nullptr;
    const NavSource* sent = nullptr;
    for (const NavSource& source : nav->log.sources()) {
      if (source.quantity != NavQuantity::kVelocity) continue;
      const NavSummary summary = summary_of(source);
      EXPECT_EQ(summary.samples, reports);
      EXPECT_EQ(summary.samples - summary.invalid, valid);
      (source.name == "/dvl/json_data" ? own : sent) = &source;
    }
    ASSERT_TRUE(own != nullptr && sent != nullptr);
    EXPECT_TRUE(check_source(*own)) << "reports that were held back keep their order";
    for (const NavSample& sample : own->samples) {
      if (!sample.valid) continue;
      const auto same =
          std::ranges::find_if(sent->samples, [&](const NavSample& s) { return s.value == sample.value; });
      ASSERT_NE(same, sent->samples.end());
      // What the device held back before it sent it (4.6 s at most, by itself), and what waited for the driver.
      const double late_s = same->time_s - sample.time_s;
      ASSERT_GT(late_s, 0.09);
      ASSERT_LT(late_s, name == std::string("dvl_circle.bag") ? 8.6 : 0.5);
    }
  }
}

TEST(BagRecordings, McapOfOtherWriters) {
  if (recording("mcap-samples/rosbag2_part_0.mcap").empty()) GTEST_SKIP() << "no recording";
  const auto bag = read_bag(*ByteStream::open(recording("mcap-samples/rosbag2_part_0.mcap")));
  ASSERT_TRUE(bag);
  std::size_t messages = 0;
  for (const BagTopicSummary& topic : bag->topics) messages += topic.messages;
  EXPECT_EQ(messages, 15U);
  for (const char* name : {"none", "lz4", "zstd"}) {
    const auto file = read_file(recording(std::string("mcap-samples/ours_chunk_") + name + ".mcap"));
    ASSERT_TRUE(file);
    for (const std::size_t cut : {0U, 8U, 40U, 300U}) {
      const auto end = file->bytes.end() - static_cast<std::ptrdiff_t>(cut);
      EXPECT_THAT(all_beams({"cut.mcap", {file->bytes.begin(), end}}).items, SizeIs(3)) << name << " without " << cut;
    }
  }
}

}  // namespace
}  // namespace pingvox
