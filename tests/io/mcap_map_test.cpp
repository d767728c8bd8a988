#include "pingvox/io/mcap_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <sstream>

#include "io/map_samples.hpp"
#include "io/maps/message_parts.hpp"

namespace pingvox {
namespace {

using samples::bytes_of_hex;
using testing::HasSubstr;

const MessageStamp kMapStamp{1'000'500'000'000, "map"};
constexpr std::string_view kMapStampHex = "0a0908e8071080cab5ee0112036d6170";

std::string text_of_hex(std::string_view hex) {
  const samples::Bytes bytes = bytes_of_hex(hex);
  return {bytes.begin(), bytes.end()};
}

Pose turned_pose() {
  return Eigen::Translation3d(1.5, -2.25, -3.0) * Eigen::Quaterniond(0.8, 0.0, 0.0, 0.6);
}

Raster<Occupancy> grid_slice() {
  using enum Occupancy;
  return {4,
          3,
          0.25,
          {-1.0, 2.0},
          {kFree, kOccupied, kUnknown, kUnknown, kFree, kFree, kOccupied, kUnknown, kFree, kFree, kFree, kOccupied}};
}

// The bytes that protobufjs makes of the same messages.
TEST(FoxgloveMessages, AreTheBytesOfOtherWriters) {
  EXPECT_EQ(foxglove::transform(kMapStamp, "base_link", Pose(Eigen::Translation3d(1.5, -2.25, -3.0))).substr(0, 27),
            text_of_hex(std::string(kMapStampHex) + "1a09626173655f6c696e6b"));
  const std::string grid = foxglove::grid(kMapStamp, grid_slice());
  EXPECT_EQ(grid, text_of_hex(std::string(kMapStampHex) +
                              "1a1f0a1209000000000000f0bf110000000000000040120921000000000000f03f25040000002a1209000000"
                              "000000d03f11000000000000d03f35040000003d01000000420d0a096f63637570616e637918014a0c0064ff"
                              "ff000064ff00000064"));
}

// The bytes that rosmsg2-serialization makes of the same messages.
TEST(Ros2Messages, AreTheBytesOfOtherWriters) {
  EXPECT_EQ(ros2::octomap(kMapStamp, false, 0.1, text_of_hex("0000803f800000803f010000803f020000803f00")),
            text_of_hex("00010000e80300000065cd1d040000006d61700000000000070000004f635472656500009a9999999999b93f140000"
                        "000000803f800000803f010000803f020000803f00"));
  EXPECT_EQ(
      ros2::grid(kMapStamp, grid_slice()),
      text_of_hex("00010000e80300000065cd1d040000006d617000e80300000065cd1d0000803e040000000300000000000000000000"
                  "000000f0bf00000000000000400000000000000000000000000000000000000000000000000000000000000000000000"
                  "000000f03f0c0000000064ffff000064ff00000064"));
  const std::string transform = ros2::transform(kMapStamp, "base_link", turned_pose());
  EXPECT_EQ(transform.substr(0, 68),
            text_of_hex("0001000001000000e80300000065cd1d040000006d6170000a000000626173655f6c696e6b00000000000000000000"
                        "000000f83f00000000000002c000000000000008c0"));
  EXPECT_EQ(transform.size(), 100U);
}

OccupancyMap small_map(int depth = 16) {
  OccupancyMap map({.resolution_m = 0.5, .depth = depth});
  Editor editor = map.edit();
  editor.set(WideKey{5, 7, 9}, depth, LogOdds(1.0F));
  editor.set(WideKey{200, 7, 9}, depth, LogOdds(1.0F));
  return map;
}

TEST(McapMap, IsRefusedWhereItCannotBeWritten) {
  std::ostringstream out;
  EXPECT_EQ(write_mcap(OccupancyMap(), {}, McapMessages::kFoxglove, out).error().code, Error::Code::kUnsupported);
  EXPECT_EQ(write_mcap(small_map(12), {}, McapMessages::kRos2, out).error().code, Error::Code::kUnsupported);
  const McapContents before{.path = Trajectory::still(Pose::Identity(), -1.0)};
  EXPECT_THAT(write_mcap(small_map(), before, McapMessages::kRos2, out).error().message, HasSubstr("-1 s"));
  out.setstate(std::ios::badbit);
  EXPECT_EQ(write_mcap(small_map(), {}, McapMessages::kFoxglove, out).error().code, Error::Code::kIo);
}

TEST(McapMap, HasABoxForEachPartThatIsOccupied) {
  std::ostringstream out;
  const Result<McapCounts> counts = write_mcap(small_map(), {}, McapMessages::kFoxglove, out);
  ASSERT_TRUE(counts);
  EXPECT_EQ(counts->messages, 4U) << "cloud, grid, two boxes";
}

}  // namespace
}  // namespace pingvox
