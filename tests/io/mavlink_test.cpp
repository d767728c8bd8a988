#include "io/internal/mavlink.hpp"

#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "support/frames.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using Check = MavlinkFrame::Check;

// Frames that a vehicle sent (BlueROV2, 2023) or, the third, an aeroplane by MAVLink 1.
constexpr std::string_view kAttitudeFrame =
    "fd1c0000ec01011e0000 53840a00 9c11c7bc 2b3eca3c a04516c0 1673bfbc 590e303c 070737ba 07ba";
constexpr std::string_view kPressureFrame = "fd0e0000d70101890000 17840a00 33f37d44 00000000 dd04 f85f";
constexpr std::string_view kAttitude1 =
    "fe1c3e01011e 76af0000 f029583c 00c0d3b8 c1a4bdbf 4c9fb4ba c83d093b 5bb21bbb 046a";
constexpr std::string_view kCutDistance = "fd160000f501c2840000 2344030014008813c70f010119ffb81e053fb81e053f b32f";

/// Frames whose checksum is right, looked for from each byte that none of them holds.
std::vector<std::uint32_t> messages_in(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint32_t> messages;
  while (!bytes.empty()) {
    const MavlinkRead read = read_mavlink(bytes);
    const bool is_right =
        read.frame && (read.frame->check == Check::kRight || read.frame->check == Check::kRightPadded);
    if (is_right) messages.push_back(read.frame->message);
    bytes = bytes.subspan(is_right ? read.length : 1);
  }
  return messages;
}

TEST(Mavlink, ReadsBothVersions) {
  const MavlinkRead two = read_mavlink(from_hex(kAttitudeFrame));
  ASSERT_TRUE(two.frame);
  EXPECT_EQ(two.frame->check, Check::kRight);
  EXPECT_EQ(two.length, 40U);
  EXPECT_EQ(two.frame->message, 30U);
  EXPECT_EQ(two.frame->sequence, 0xec);
  EXPECT_EQ(two.frame->payload_bytes, 28U);
  const MavlinkRead one = read_mavlink(from_hex(kAttitude1));
  ASSERT_TRUE(one.frame);
  EXPECT_EQ(one.frame->check, Check::kRight);
  EXPECT_EQ(one.length, 36U);
  EXPECT_EQ(one.frame->message, 30U);
  EXPECT_EQ(one.frame->sequence, 0x3e);
}

TEST(Mavlink, TakesAChecksumOfThePaddedPayload) {
  const MavlinkRead read = read_mavlink(from_hex(kCutDistance));
  ASSERT_TRUE(read.frame);
  EXPECT_EQ(read.frame->check, Check::kRightPadded);
  EXPECT_EQ(read.frame->system, 1);
  EXPECT_EQ(read.frame->component, 194);
}

TEST(Mavlink, DropsFramesWithFlagsThatItDoesNotKnow) {
  auto bytes = from_hex(kAttitudeFrame);
  bytes[2] = 0x02;
  const MavlinkRead read = read_mavlink(bytes);
  EXPECT_FALSE(read.frame);
  EXPECT_FALSE(read.is_cut);
}

TEST(Mavlink, CountsTheSignatureToTheFrame) {
  auto bytes = from_hex(kAttitudeFrame);
  bytes[2] = 0x01;
  EXPECT_TRUE(read_mavlink(bytes).is_cut);
  bytes.resize(bytes.size() + 13);
  EXPECT_EQ(read_mavlink(bytes).length, 53U);
}

TEST(Mavlink, EachFlippedBitMakesAFrameWrong) {
  for (const std::string_view hex : {kAttitudeFrame, kPressureFrame, kAttitude1}) {
    const auto right = from_hex(hex);
    for (std::size_t bit = 0; bit < right.size() * 8; ++bit) {
      auto bytes = right;
      bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << (bit % 8)));
      const MavlinkRead read = read_mavlink(bytes);
      // The message's number may become one that is not known.
      if (read.frame) {
        EXPECT_TRUE(read.frame->check == Check::kWrong || read.frame->check == Check::kUnknownMessage) << bit;
      }
    }
  }
}

TEST(Mavlink, TellsABeginningOfAFrameFromAWholeOne) {
  for (const std::string_view hex : {kAttitudeFrame, kPressureFrame, kAttitude1, kCutDistance}) {
    const auto whole = from_hex(hex);
    const std::span<const std::uint8_t> bytes(whole);
    for (std::size_t size = 1; size < bytes.size(); ++size) {
      const MavlinkRead read = read_mavlink(bytes.first(size));
      EXPECT_TRUE(read.is_cut) << size;
      EXPECT_FALSE(read.frame) << size;
    }
    EXPECT_FALSE(read_mavlink(bytes).is_cut);
  }
}

TEST(Mavlink, AFlippedBitCostsOneFrame) {
  const auto before = from_hex(kPressureFrame), damaged = from_hex(kAttitudeFrame), behind = from_hex(kAttitude1);
  for (std::size_t bit = 0; bit < damaged.size() * 8; ++bit) {
    auto bytes = joined({from_hex("fe00fd"), before, damaged, behind});
    std::uint8_t& byte = bytes[3 + before.size() + bit / 8];
    byte = static_cast<std::uint8_t>(byte ^ (1U << (bit % 8)));
    EXPECT_EQ(messages_in(bytes), (std::vector<std::uint32_t>{137, 30})) << bit;
  }
}

}  // namespace
}  // namespace pingvox
