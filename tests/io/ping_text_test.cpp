#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/format.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// 4 samples at angle 150; its checksum is 1414.
const std::string kPrintedPing =
    "\"<bound method PingMessage.unpack_msg_data of \r\n\r\n"
    "--------------------------------------------------\r\n"
    "ID: 2300 - device_data\r\n"
    "Header: start_1: 66 start_2: 82 payload_length: 18 message_id: 2300 src_device_id: 2 dst_device_id: 0\r\n"
    "Payload:\r\n"
    "  - mode: 0\r\n"
    "  - gain_setting: 0\r\n"
    "  - angle: 150\r\n"
    "  - transmit_duration: 16\r\n"
    "  - sample_period: 90\r\n"
    "  - transmit_frequency: 1000\r\n"
    "  - number_of_samples: 4\r\n"
    "  - data_length: 4\r\n"
    "  - data: ['0x4c', '0x98', '0x4', '0xff']\r\n"
    "Checksum: 1414 check: 1414 pass: True>\",";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

ReadResult<Beam> beams_of_text(const std::string& text, Damage damage = Damage::kSkip) {
  return all_beams({"print.txt", bytes_of(text)}, damage);
}

TEST(PingText, IsReadAsTheFrameThatWasPrinted) {
  EXPECT_EQ(format_of(bytes_of(kPrintedPing)), Format::kPingText);
  const auto all = beams_of_text(kPrintedPing + kPrintedPing);
  EXPECT_EQ(all.error, "");
  EXPECT_EQ(all.skipped, 0U);
  ASSERT_EQ(all.items.size(), 2U);
  EXPECT_THAT(all.items[0].intensities, ElementsAre(0x4c, 0x98, 4, 255));
  EXPECT_NEAR(all.items[0].bearing_rad, std::numbers::pi / 4.0, 1e-12) << "50 of 400 to the left of 200";
  EXPECT_NEAR(all.items[0].bin_length_m, 90 * 25e-9 * 750.0, 1e-15);
  EXPECT_LT(all.items[0].time_s, all.items[1].time_s);
}

// Times of a printed log are not times of the dive: kills navigation that is joined to them.
TEST(PingText, HasNoClock) {
  const auto source = open_beams({"print.txt", bytes_of(kPrintedPing)});
  ASSERT_TRUE(source);
  EXPECT_EQ((*source)->clock(), BeamClock::kNone);
}

TEST(PingText, WhatDoesNotFitItsChecksumIsSkipped) {
  for (const auto& [what, with] : {std::pair{"0x98", "0x99"}, {"angle: 150", "angle: 151"}, {"1414", "1415"}}) {
    const auto all = beams_of_text(kPrintedPing + replaced(kPrintedPing, what, with) + kPrintedPing);
    EXPECT_EQ(all.items.size(), 2U) << with;
    EXPECT_EQ(all.skipped, 1U) << with;
  }
  const std::string damaged = kPrintedPing + replaced(kPrintedPing, "0x98", "0x99");
  EXPECT_EQ(beams_of_text(damaged, Damage::kFail).error,
            "print.txt: byte " + std::to_string(damaged.rfind("ID: 2300")) + ": wrong checksum");
}

TEST(PingText, ALineThatCannotBeReadCostsItsPingAndIsTold) {
  for (const auto& [what, with] : {std::pair{"- angle: 150", "- angle: x"},
                                   {"- angle: 150", "- angle: 65536"},
                                   {"- angle:", "- angel:"},
                                   {"'0x98'", "'0x198'"},
                                   {"'0x98'", "0x98"},
                                   {"'0xff']", "'0xff'"},
                                   {"payload_length: 18", "payload_length: "},
                                   {"  - mode: 0\r\n", ""},
                                   {"  - data_length: 4\r\n", ""},
                                   {"Checksum: 1414", "Checksum: ?"}}) {
    const std::string damaged = replaced(kPrintedPing, what, with);
    const auto source = open_beams({"print.txt", bytes_of(kPrintedPing + damaged + kPrintedPing)});
    ASSERT_TRUE(source);
    EXPECT_EQ(read_all(**source)->size(), 2U) << with;
    ASSERT_EQ((*source)->damage().size(), 1U) << with;
    EXPECT_EQ((*source)->damage()[0].what, "line that cannot be read");
    EXPECT_GT((*source)->damage()[0].first_byte, kPrintedPing.size());
  }
}

TEST(PingText, APingThatBreaksOffCostsNoOther) {
  for (std::size_t size = kPrintedPing.find("ID:") + 9; size < kPrintedPing.find("Checksum:"); size += 3) {
    const auto all = beams_of_text(kPrintedPing + kPrintedPing.substr(0, size) + "\n" + kPrintedPing);
    ASSERT_EQ(all.items.size(), 2U) << "broken off after " << size;
    ASSERT_GT(all.skipped, 0U) << size;
    ASSERT_EQ(beams_of_text(kPrintedPing + kPrintedPing.substr(0, size)).items.size(), 1U);
  }
}

TEST(PingText, OtherMessagesAreNoBeams) {
  const std::string other =
      "ID: 4 - device_information\nHeader: start_1: 66 start_2: 82 payload_length: 6\nPayload:\n  - device_type: 2\n"
      "Checksum: 234 check: 234 pass: True\n";
  const auto all = beams_of_text(kPrintedPing + "\n" + other + kPrintedPing);
  EXPECT_EQ(all.items.size(), 2U);
  EXPECT_EQ(all.skipped, 0U);
}

TEST(PingText, ARealPrintOfAHalfTurnIsReadWhole) {
  auto stream = ByteStream::open(PINGVOX_SHARED_DATA "/ping360-mit-sample/2024-03-13_15-50-16_Gain_0.txt");
  if (!stream) GTEST_SKIP() << "ping360-mit-sample is missing: skipped";
  const auto source = open_beams(std::move(*stream));
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->device(), find_device("ping360"));
  const auto beams = read_all(**source);
  ASSERT_TRUE(beams);
  ASSERT_EQ(beams->size(), 101U);
  EXPECT_EQ((*source)->skipped(), 0U);
  for (std::size_t i = 0; i < beams->size(); ++i) {
    const Beam& beam = (*beams)[i];
    const double angle_grad = 150.0 + static_cast<double>(i);
    EXPECT_NEAR(
        std::remainder(beam.bearing_rad - (200.0 - angle_grad) * std::numbers::pi / 200.0, 2 * std::numbers::pi), 0.0,
        1e-12);
    EXPECT_EQ(beam.intensities.size(), 1200U);
    EXPECT_NEAR(beam.bin_length_m * 1200.0, 2.025, 1e-9);
  }
  EXPECT_EQ((*beams)[0].intensities.front(), 0x4c);
  EXPECT_EQ((*beams)[0].intensities.back(), 0x2a);
}

}  // namespace
}  // namespace pingvox
