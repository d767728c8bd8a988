#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pingvox/io/bag.hpp"
#include "pingvox/io/beams.hpp"
#include "support/bag_writer.hpp"
#include "support/logs.hpp"
#include "support/ros_messages.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::SizeIs;

constexpr std::string_view kCloud2 = "sensor_msgs/msg/PointCloud2", kLaser = "sensor_msgs/msg/LaserScan";

/// A cloud of two rows of two points, at 1000.5 s: an intensity, then x (float), y (double) and z (16 bits), and four
/// bytes behind each row. The points are (1, 2, 3), (NaN, 0, 0), (-4.5, 5.25, -6) and (0, 0, 0). Written by another
/// program (@foxglove/rosmsg2-serialization), as are the others.
constexpr std::string_view kCloud =
    "00010000e80300000065cd1d030000006d6200000200000002000000040000000a000000696e74656e736974790000000000000007000000"
    "0100000002000000780000000400000007000000010000000200000079000000080000000800000001000000020000007a00000010000000"
    "030000000100000000000000140000002c000000580000000000003f0000803f0000000000000040030000000000003f0000c07f00000000"
    "0000000000000000000000000000003f000090c00000000000001540faff00000000003f0000000000000000000000000000000000000000"
    "00";
/// The same in ROS 1.
constexpr std::string_view kRos1Cloud =
    "01000000e80300000065cd1d020000006d6202000000020000000400000009000000696e74656e7369747900000000070100000001000000"
    "780400000007010000000100000079080000000801000000010000007a10000000030100000000140000002c000000580000000000003f00"
    "00803f0000000000000040030000000000003f0000c07f000000000000000000000000000000000000003f000090c00000000000001540fa"
    "ff00000000003f000000000000000000000000000000000000000000";
/// At 1000 s: ranges 4, infinite, 0.25 and 8 m from -0.5 rad on, each 0.5 rad and 0.25 s after the one before; valid
/// from 0.5 to 20 m.
constexpr std::string_view kFourRanges =
    "00010000e8030000000000000200000073000000000000bf0000803f0000003f0000803e0000803f0000003f0000a0410400000000008040"
    "0000807f0000803e0000004100000000";
constexpr std::string_view kCloudDefinition =
    "Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\nuint32 point_step\n"
    "uint32 row_step\nuint8[] data\nbool is_dense\n================\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\n"
    "string frame_id\n================\nMSG: sensor_msgs/PointField\nstring name\nuint32 offset\nuint8 datatype\n"
    "uint32 count\n";

/// A message of a topic alone in a bag.
bags::Bytes bag_of(std::string_view type, const bags::Bytes& message, std::string_view topic = "/points") {
  bags::Mcap mcap;
  mcap.topic(1, topic, type, "");
  mcap.message(1, 1'000'600'000'000U, message);
  mcap.end_chunk();
  return mcap.closed();
}

ReadResult<PointScan> scans_of(bags::Bytes file, const std::string& topic = "/points", Damage damage = Damage::kSkip) {
  Result<BagLog> log = open_bag_log(FileBytes{"dive.mcap", std::move(file)}, damage, {.name = topic});
  if (!log) return {{}, 0, log.error().message};
  auto* scans = std::get_if<std::unique_ptr<ScanSource>>(&*log);
  if (scans == nullptr) return {{}, 0, "has beams"};
  return read_everything<PointScan, ScanSource>(std::move(*scans));
}

// Kills columns at fixed places, padding of rows that is read as points, and points where there was no echo.
TEST(BagScans, ReadsCloudsThatAnotherWriterMade) {
  bags::Ros1 ros1;
  ros1.topic(0, "/points", "sensor_msgs/PointCloud2", kCloudDefinition);
  ros1.message(0, 1000, 600'000'000, from_hex(kRos1Cloud));
  ros1.end_chunk();
  for (const auto& file : {bag_of(kCloud2, from_hex(kCloud)), ros1.file()}) {
    const auto read = scans_of(file);
    ASSERT_THAT(read.items, SizeIs(1)) << read.error;
    EXPECT_EQ(read.skipped, 0U);
    EXPECT_EQ(read.items[0].time_s, 1000.5);
    EXPECT_THAT(read.items[0].points_m, testing::ElementsAre(Vector3d(1.0, 2.0, 3.0), Vector3d(-4.5, 5.25, -6.0)));
  }
}

// Kills a turn of a slow head that is mapped from one place, and ranges that are no echoes.
TEST(BagScans, DirectionsThatWereLookedAtInTurnHaveTimesOfTheirOwn) {
  const auto read = scans_of(bag_of(kLaser, from_hex(kFourRanges)));
  ASSERT_THAT(read.items, SizeIs(4)) << read.error;
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(read.items[i].time_s, 1000.0 + 0.25 * static_cast<double>(i));
    EXPECT_EQ(read.items[i].number, i);
  }
  ASSERT_THAT(read.items[0].points_m, SizeIs(1));
  EXPECT_TRUE(read.items[0].points_m[0].isApprox(4.0 * Vector3d(std::cos(-0.5), std::sin(-0.5), 0.0)));
  EXPECT_THAT(read.items[1].points_m, SizeIs(0)) << "infinite: no echo";
  EXPECT_THAT(read.items[2].points_m, SizeIs(0)) << "nearer than the sensor can see";
  ASSERT_THAT(read.items[3].points_m, SizeIs(1));
  EXPECT_TRUE(read.items[3].points_m[0].isApprox(8.0 * Vector3d(std::cos(1.0), std::sin(1.0), 0.0)));
}

// Kills points that are mirrored: z of `_frd` and `_ned` points down.
TEST(BagScans, PointsInAFrameThatPointsDownAreTurned) {
  for (const std::string_view frame : {"sonar_frd", "rov/base_link_ned", "sonar"}) {
    SCOPED_TRACE(frame);
    const double sense = frame == "sonar" ? 1.0 : -1.0;
    bags::Cdr scan, cloud;
    scan.header(1000.0, frame);
    for (const float number : {0.5F, 1.5F, 1.0F, 0.0F, 0.0F, 0.5F, 20.0F}) scan.number(number);
    scan.number(std::uint32_t{2}).number(4.0F).number(8.0F).number(std::uint32_t{0});
    const auto rays = scans_of(bag_of(kLaser, scan.bytes()));
    ASSERT_THAT(rays.items, SizeIs(1)) << rays.error;
    ASSERT_THAT(rays.items[0].points_m, SizeIs(2));
    EXPECT_TRUE(rays.items[0].points_m[0].isApprox(4.0 * Vector3d(std::cos(0.5), sense * std::sin(0.5), 0.0), 1e-6));
    cloud.header(1000.0, frame).number(std::uint32_t{1}).number(1.0F).number(2.0F).number(3.0F);
    cloud.number(std::uint32_t{0});
    const auto points = scans_of(bag_of("sensor_msgs/msg/PointCloud", cloud.bytes()));
    ASSERT_THAT(points.items, SizeIs(1)) << points.error;
    EXPECT_THAT(points.items[0].points_m, testing::ElementsAre(Vector3d(1.0, sense * 2.0, sense * 3.0)));
    // In one direction it is a beam.
    bags::Cdr beam;
    beam.header(1000.0, frame);
    for (const float number : {0.5F, 0.5F, 0.0F, 0.0F, 0.0F, 0.5F, 20.0F}) beam.number(number);
    beam.number(std::uint32_t{0}).number(std::uint32_t{3});
    for (const float intensity : {1.0F, 2.0F, 200.0F}) beam.number(intensity);
    const auto beams = all_beams({"beam.mcap", bag_of(kLaser, beam.bytes())});
    ASSERT_THAT(beams.items, SizeIs(1)) << beams.error;
    EXPECT_NEAR(std::remainder(beams.items[0].bearing_rad - sense * 0.5, 2.0 * std::numbers::pi), 0.0, 1e-6);
  }
}

// A fast scan is one: its rays vote once for each cell.
TEST(BagScans, DirectionsOfOneMomentAreOneScan) {
  bags::Bytes message = from_hex(kFourRanges);
  const std::size_t time_increment = 4 + 8 + 4 + 4 + 3 * 4;
  const float step_s = 1e-4F;
  std::memcpy(message.data() + time_increment, &step_s, sizeof(step_s));
  const auto read = scans_of(bag_of(kLaser, message));
  ASSERT_THAT(read.items, SizeIs(1)) << read.error;
  EXPECT_THAT(read.items[0].points_m, SizeIs(2));
}

// Kills a read beyond the data, sizes whose product overflows, and loops without an end.
TEST(BagScans, SizesThatDoNotFitTheDataAreDamage) {
  const bags::Bytes good = from_hex(kCloud);
  constexpr std::size_t kHeight = 20, kWidth = 24, kOffsetOfX = 68, kPointStep = 124;
  const auto number_at = [&](std::size_t place) {
    std::uint32_t number = 0;
    std::memcpy(&number, good.data() + place, sizeof(number));
    return number;
  };
  ASSERT_EQ(number_at(kHeight), 2U);
  ASSERT_EQ(number_at(kWidth), 2U);
  ASSERT_EQ(number_at(kPointStep), 20U);
  ASSERT_EQ(number_at(kPointStep + 4), 44U) << "row step";
  const auto scans_with = [&](std::size_t place, std::uint32_t number) {
    bags::Bytes changed = good;
    std::memcpy(changed.data() + place, &number, sizeof(number));
    return scans_of(bag_of(kCloud2, changed)).items.size();
  };
  EXPECT_EQ(scans_with(kOffsetOfX, 16), 1U);
  EXPECT_EQ(scans_with(kHeight, 1), 0U) << "half of the data are of no row";
  for (const std::uint32_t wrong : {17U, 4'000'000'000U, 0xFFFF'FFFFU}) {
    for (const std::size_t place : {kHeight, kWidth, kPointStep, kPointStep + 4, kOffsetOfX}) {
      EXPECT_EQ(scans_with(place, wrong), 0U) << wrong << " at " << place;
    }
  }
  EXPECT_EQ(scans_with(kWidth, 3), 0U) << "beyond its row";
  EXPECT_EQ(scans_with(kHeight, 3), 0U);
  bags::Bytes wide = good;
  const std::uint32_t none = 0, many = 0xFFFF'FFFF;
  std::memcpy(wide.data() + kHeight, &many, sizeof(many));
  std::memcpy(wide.data() + kWidth, &none, sizeof(none));
  std::memcpy(wide.data() + kPointStep + 4, &none, sizeof(none));
  EXPECT_THAT(scans_of(bag_of(kCloud2, wide)).items.at(0).points_m, SizeIs(0));
}

/// Two rows of two points without anything behind them.
bags::Bytes dense_cloud(std::uint32_t row_step) {
  bags::Bytes message = from_hex("00010000e80300000065cd1d030000006d620000");
  for (const std::uint32_t number : {2U, 2U, 3U}) bags::put(message, number);
  std::uint32_t offset = 0;
  for (const char axis : {'x', 'y', 'z'}) {
    bags::put(message, std::uint32_t{2});
    message.insert(message.end(), {static_cast<std::uint8_t>(axis), 0, 0, 0});
    for (const std::uint32_t number : {offset, 7U, 1U}) bags::put(message, number);  // float (and padding), one
    offset += 4;
  }
  for (const std::uint32_t number : {0U, 12U, row_step, 48U}) bags::put(message, number);
  for (int i = 1; i <= 12; ++i) bags::put(message, static_cast<float>(i));
  message.push_back(0);
  return message;
}

// Drivers leave the row step at 0, or at the size of a point. Kills a refusal of data of exactly the right size.
TEST(BagScans, ARowStepDoesNotMatterWhereTheDataHaveTheSizeOfThePoints) {
  for (const std::uint32_t row_step : {24U, 0U, 12U, 48U, 1'000'000U}) {
    const auto read = scans_of(bag_of(kCloud2, dense_cloud(row_step)));
    ASSERT_THAT(read.items, SizeIs(1)) << row_step << read.error;
    ASSERT_THAT(read.items[0].points_m, SizeIs(4));
    EXPECT_EQ(read.items[0].points_m[2], Vector3d(7.0, 8.0, 9.0));
  }
  bags::Bytes short_of_one = dense_cloud(24);
  const std::size_t width = 24;
  const std::uint32_t three = 3;
  std::memcpy(short_of_one.data() + width, &three, sizeof(three));
  EXPECT_THAT(scans_of(bag_of(kCloud2, short_of_one)).error,
              HasSubstr("48 bytes of data do not fit height 2, width 3, point_step 12 and row_step 24"));
}

/// The scan with other numbers: angle_min, angle_max, angle_increment.
bags::Bytes laser_with_angles(const std::array<float, 3>& angles_rad) {
  bags::Bytes message = from_hex(kFourRanges);
  const std::size_t angle_min = 4 + 8 + 4 + 4;
  std::memcpy(message.data() + angle_min, angles_rad.data(), sizeof(angles_rad));
  return message;
}

// A driver sends the one range of where the head is with the angles of a whole turn: all echoes came out ahead.
TEST(BagScans, RangesThatDoNotFitTheAnglesAreDamage) {
  const auto error_of = [](const std::array<float, 3>& angles_rad) {
    return scans_of(bag_of(kLaser, laser_with_angles(angles_rad))).error;
  };
  EXPECT_THAT(error_of({0.0F, 6.25F, 0.015625F}),
              HasSubstr("4 ranges do not fit angle_min 0, angle_max 6.25 and angle_increment 0.015625"));
  EXPECT_THAT(error_of({0.0F, 1.0F, 0.0F}), HasSubstr("angle_increment 0"));
  EXPECT_THAT(error_of({1.0F, 0.0F, 0.25F}), HasSubstr("do not fit"));
  EXPECT_THAT(error_of({-135.0F, 135.0F, 90.0F}), HasSubstr("are not both within 2 pi"));
  for (const float last_rad : {0.75F, 1.0F, 0.5F}) {
    EXPECT_EQ(error_of({0.0F, last_rad, 0.25F}), "") << "with or without the last direction";
  }
  EXPECT_EQ(error_of({1.0F, 0.25F, -0.25F}), "");
}

// A driver sends one when nothing was seen. Kills a strict read that refuses it.
TEST(BagScans, AnEmptyCloudIsNoDamage) {
  bags::Bytes message = from_hex("00010000e80300000065cd1d030000006d620000");
  for (int i = 0; i < 3; ++i) bags::put(message, std::uint32_t{0});  // height, width, no fields
  for (int i = 0; i < 4; ++i) bags::put(message, std::uint32_t{0});  // byte order, sizes, no data
  message.push_back(0);
  const auto read = scans_of(bag_of(kCloud2, message), "/points", Damage::kFail);
  ASSERT_THAT(read.items, SizeIs(1)) << read.error;
  EXPECT_THAT(read.items[0].points_m, SizeIs(0));
}

// Columns that overlap make points of a byte each: 24 times the memory of the message.
TEST(BagScans, AMessageHasTenMillionPointsAtMost) {
  bags::Bytes message = from_hex("00010000e80300000065cd1d030000006d620000");
  constexpr std::uint32_t kPoints = 10'000'001;
  for (const std::uint32_t number : {1U, kPoints, 3U}) bags::put(message, number);
  for (const char axis : {'x', 'y', 'z'}) {
    bags::put(message, std::uint32_t{2});
    message.insert(message.end(), {static_cast<std::uint8_t>(axis), 0, 0, 0});
    for (const std::uint32_t number : {0U, 1U, 1U}) bags::put(message, number);  // at 0, int8 (and padding), one
  }
  bags::put(message, std::uint32_t{0});  // little-endian, padding
  for (const std::uint32_t number : {1U, kPoints, kPoints}) bags::put(message, number);
  message.insert(message.end(), kPoints, 1);
  message.push_back(0);
  EXPECT_THAT(scans_of(bag_of(kCloud2, message)).error, HasSubstr("that can be read: byte"));
}

// Kills a walk through all of them for each column.
TEST(BagScans, ADescriptionOfMillionsOfFieldsIsRefused) {
  bags::Bytes message = from_hex("00010000e80300000065cd1d030000006d620000");
  constexpr std::uint32_t kFields = 5000;
  for (const std::uint32_t number : {1U, 1U, kFields}) bags::put(message, number);
  for (std::uint32_t i = 0; i < kFields; ++i) {
    for (const std::uint32_t number : {1U, 0U, 0U, 7U, 1U}) bags::put(message, number);
  }
  for (const std::uint32_t number : {0U, 4U, 4U, 4U, 0U}) bags::put(message, number);
  message.push_back(0);
  EXPECT_THAT(scans_of(bag_of(kCloud2, message)).error, HasSubstr("impossible values"));
}

// Kills clouds without the places of points that are mapped from whatever stands there.
TEST(BagScans, ACloudNeedsXYAndZ) {
  bags::Bytes message = from_hex(kCloud);
  const auto z = std::ranges::find(message, 'z');
  ASSERT_NE(z, message.end());
  *z = 'q';
  EXPECT_THAT(scans_of(bag_of(kCloud2, message)).error,
              testing::AllOf(HasSubstr("has no scans of points in the topic /points that can be read"),
                             HasSubstr("cloud without numbers x, y and z")));
  const auto strict = scans_of(bag_of(kCloud2, message), "/points", Damage::kFail);
  EXPECT_THAT(strict.error, HasSubstr("cloud without numbers x, y and z"));
}

class BagWithBoth : public testing::Test {
 protected:
  BagWithBoth() {
    bags::Mcap mcap;
    mcap.topic(1, "/points", kCloud2, "");
    mcap.topic(2, "/others", kCloud2, "");
    mcap.topic(3, "/echo", "ping360_sonar_msgs/msg/SonarEcho", "");
    mcap.message(1, 1'000'600'000'000U, from_hex(kCloud));
    mcap.message(1, 1'001'600'000'000U, from_hex(kCloud));
    mcap.message(3, 1'000'700'000'000U, from_hex(bags::kSonarEcho));
    mcap.end_chunk();
    file_ = mcap.closed();
  }

  bags::Bytes file_;
};

TEST_F(BagWithBoth, BeamsComeFirstAndScansAreChosen) {
  const auto log = open_bag_log(FileBytes{"dive.mcap", file_});
  ASSERT_TRUE(log) << log.error().message;
  EXPECT_TRUE(std::holds_alternative<std::unique_ptr<BeamSource>>(*log));
  EXPECT_THAT(scans_of(file_).items, SizeIs(2));
  const auto beams = open_beams(FileBytes{"dive.mcap", file_}, Damage::kSkip, {.name = "/points"});
  ASSERT_FALSE(beams);
  EXPECT_EQ(beams.error().message, "dive.mcap: holds scans of points, not beams of a sonar");
  const auto contents = read_bag(FileBytes{"dive.mcap", file_});
  ASSERT_TRUE(contents);
  using Use = BagTopicSummary::Use;
  EXPECT_EQ(contents->topics[0].use, Use::kScans);
  EXPECT_EQ(contents->topics[2].use, Use::kBeams);
}

TEST(BagScans, TheOnlyTopicNeedsNoName) {
  EXPECT_THAT(scans_of(bag_of(kLaser, from_hex(kFourRanges)), "").items, SizeIs(4));
}

TEST(BagScans, OneOfSeveralTopicsIsChosen) {
  bags::Mcap mcap;
  mcap.topic(1, "/points", kCloud2, "");
  mcap.topic(2, "/scan", kLaser, "");
  mcap.message(1, 1'000'600'000'000U, from_hex(kCloud));
  mcap.message(2, 1'000'600'000'000U, from_hex(kFourRanges));
  mcap.end_chunk();
  EXPECT_THAT(scans_of(mcap.closed(), "/points").items, SizeIs(1));
  EXPECT_THAT(scans_of(mcap.closed(), "/scan").items, SizeIs(4));
  EXPECT_EQ(scans_of(mcap.closed(), "").error,
            "dive.mcap: holds several topics with scans: /points (sensor_msgs/msg/PointCloud2), /scan "
            "(sensor_msgs/msg/LaserScan): choose one with --topic");
}

/// A cloud of one point at (1, 2, 3) in a frame.
bags::Bytes point_in(std::string_view frame) {
  bags::Cdr cloud;
  cloud.header(1000.0, frame).number(std::uint32_t{1}).number(1.0F).number(2.0F).number(3.0F);
  return bag_of("sensor_msgs/msg/PointCloud", cloud.number(std::uint32_t{0}).bytes());
}

std::string note_of(bags::Bytes file) {
  Result<BagLog> log = open_bag_log(FileBytes{"dive.mcap", std::move(file)}, Damage::kSkip, {.name = "/points"});
  return log ? std::get<std::unique_ptr<ScanSource>>(*log)->note() : log.error().message;
}

// REP-103: kills what is ahead of a camera and is mapped above it.
TEST(BagScans, PointsInAnOpticalFrameAreTurned) {
  const auto read = scans_of(point_in("camera_optical_frame"));
  ASSERT_THAT(read.items, SizeIs(1)) << read.error;
  EXPECT_THAT(read.items[0].points_m, testing::ElementsAre(Vector3d(3.0, -1.0, -2.0)));
  EXPECT_THAT(note_of(point_in("camera_optical_frame")), HasSubstr("turned from camera_optical_frame"));
  EXPECT_EQ(note_of(point_in("camera")), "");
}

// Kills points that move with the vehicle twice.
TEST(BagScans, PointsInAFixedFrameAreNotMoved) {
  for (const std::string_view frame : {"map", "odom", "rov/world"}) {
    const auto read = scans_of(point_in(frame));
    ASSERT_THAT(read.items, SizeIs(1)) << read.error;
    EXPECT_TRUE(read.items[0].has_points_in_map);
    EXPECT_THAT(note_of(point_in(frame)), HasSubstr("does not move with the sensor"));
  }
  const auto ned = scans_of(point_in("map_ned"));
  ASSERT_THAT(ned.items, SizeIs(1));
  EXPECT_THAT(ned.items[0].points_m, testing::ElementsAre(Vector3d(2.0, 1.0, -3.0)));
  EXPECT_FALSE(scans_of(point_in("sonar")).items.at(0).has_points_in_map);
}

TEST(BagScans, TimesThatContradictEachOtherAreRefused) {
  const auto scan_of = [](float step_s, float scan_s) {
    bags::Cdr scan;
    scan.header(1000.0, "sonar");
    for (const float number : {0.0F, 0.9F, 0.1F, step_s, scan_s, 0.5F, 20.0F}) scan.number(number);
    scan.number(std::uint32_t{10});
    for (int i = 0; i < 10; ++i) scan.number(4.0F);
    return bag_of(kLaser, scan.number(std::uint32_t{0}).bytes());
  };
  EXPECT_THAT(scans_of(scan_of(2.0F, 2.0F)).error,
              HasSubstr("10 ranges every 2 s (time_increment) do not fit scan_time 2"));
  EXPECT_THAT(scans_of(scan_of(0.2F, 2.0F)).items, SizeIs(10));
  EXPECT_THAT(scans_of(scan_of(0.2F, 0.0F)).items, SizeIs(10)) << "not known";
}

}  // namespace
}  // namespace pingvox
