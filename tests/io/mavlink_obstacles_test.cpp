#include "io/internal/mavlink_obstacles.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "io/internal/mavlink.hpp"

namespace pingvox {
namespace {

// node-mavlink 2.3 writes the same message in the same 179 bytes: header, the fields around the distances, and sum are
// copied from there, and it reads them as below: sensor 4, 5 degrees, 20 to 1000 cm, frame 12, component 196.
TEST(MavlinkObstacles, AreTheBytesThatNodeMavlinkWrites) {
  ObstacleDistance obstacles;
  obstacles.time_us = 1'764'000'000'123'456;
  obstacles.min_cm = 20;
  obstacles.max_cm = 1000;
  for (std::size_t i = 0; i < obstacles.cm.size(); ++i) {
    const auto near_cm = static_cast<std::uint16_t>(100 + i);
    obstacles.cm[i] = i % 3 == 0 ? ObstacleDistance::kUnknown : i % 3 == 1 ? std::uint16_t{1001} : near_cm;
  }
  const std::vector<std::uint8_t> frame =
      make_mavlink_frame(kObstacleDistance, payload_of(obstacles), {.sequence = 7, .component = 196});
  ASSERT_EQ(frame.size(), 179U);
  const auto part = [&](std::size_t from, std::size_t size) {
    return std::vector<std::uint8_t>(frame.begin() + static_cast<std::ptrdiff_t>(from),
                                     frame.begin() + static_cast<std::ptrdiff_t>(from + size));
  };
  EXPECT_EQ(part(0, 24),
            (std::vector<std::uint8_t>{0xfd, 0xa7, 0x00, 0x00, 0x07, 0x01, 0xc4, 0x4a, 0x01, 0x00, 0x40, 0x22,
                                       0x64, 0x41, 0x59, 0x44, 0x06, 0x00, 0xff, 0xff, 0xe9, 0x03, 0x66, 0x00}));
  // The sum is over all bytes.
  EXPECT_EQ(part(160, 19), (std::vector<std::uint8_t>{0xab, 0x00, 0x14, 0x00, 0xe8, 0x03, 0x04, 0x05, 0x00, 0x00, 0xa0,
                                                      0x40, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x94, 0xee}));
}

TEST(MavlinkFrame, OfZerosKeepsOneByte) {
  const std::vector<std::uint8_t> frame = make_mavlink_frame(0, std::vector<std::uint8_t>(9, 0), {});
  EXPECT_EQ(frame.size(), 10U + 1U + 2U);
  const MavlinkRead read = read_mavlink(frame);
  ASSERT_TRUE(read.frame);
  EXPECT_EQ(read.frame->check, MavlinkFrame::Check::kRight);
}

}  // namespace
}  // namespace pingvox
