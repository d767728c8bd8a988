#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "io/internal/seanet_frame.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "support/frames.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kAlive = "40303031301000 02ff0b048002 00 60ea0000 800c 8a 0a";
constexpr const char* kLine =
    "40303032442d0002ff00028002 2500 11 10 00 0723 3c00 00000000 54 0000 51 08 0000"
    "2308 6009 a00f 10 900c 0600 000a0d40ff09 0a";
constexpr const char* kNibbles =
    "40303032412a0002ff00028002 2200 11 00 00 0623 3c00 00000000 54 0000 51 08 0000"
    "2308 6009 a00f 10 900c 0300 3a0f40 0a";

/// The golden line with another bearing.
std::vector<std::uint8_t> line_at(std::uint16_t bearing) {
  auto line = from_hex(kLine);
  line[40] = static_cast<std::uint8_t>(bearing);
  line[41] = static_cast<std::uint8_t>(bearing >> 8);
  return line;
}

std::string hex_of(std::span<const std::uint8_t> bytes) {
  std::string hex;
  for (const std::uint8_t byte : bytes) hex += fmt::format("{}{:02X}", hex.empty() ? "" : " ", byte);
  return hex;
}

TEST(SeanetFrames, AreFoundHoweverTheStreamIsCutIntoPieces) {
  const Frames frames = {from_hex("40303030380800ff020317 80020a"), from_hex(kAlive), from_hex(kLine),
                         from_hex(kNibbles), from_hex("40303030390900 ff0204138002 0f 0a")};
  const auto stream = joined(frames);
  for (std::size_t piece = 1; piece <= stream.size(); ++piece) {
    EXPECT_EQ(frames_in(check_seanet_frame, stream, piece), frames) << "pieces of " << piece;
  }
}

TEST(SeanetFrames, ALostADoubledAndADamagedByteCostOneFrameAndNoOther) {
  const auto before = from_hex(kAlive), hit = from_hex(kLine), behind = line_at(3300);
  std::size_t cases = 0;
  for (std::size_t i = 0; i < hit.size(); ++i) {
    for (const bool doubled : {false, true}) {
      // A byte more or less among equal ones in front of or behind the frame leaves the frame as it is.
      auto damaged = hit;
      const auto place = damaged.begin() + static_cast<std::ptrdiff_t>(i);
      if (doubled) {
        damaged.insert(place, hit[i]);
      } else {
        damaged.erase(place);
      }
      const bool is_edge = i == 0 || i + 1 == hit.size();
      if (doubled && is_edge) continue;
      const Frames found = frames_in(check_seanet_frame, joined({before, damaged, behind}), 5);
      EXPECT_EQ(found, (Frames{before, behind})) << "byte " << i << (doubled ? " twice" : " lost");
      ++cases;
    }
  }
  EXPECT_EQ(cases, 2 * hit.size() - 2);
  // Without a checksum, what is not length, end, message or counts may change.
  for (const unsigned i : {0U, 1U, 2U, 3U, 4U, 5U, 6U, 13U, 14U, 42U, 43U, 50U}) {
    for (int bit = 0; bit < 8; ++bit) {
      auto damaged = hit;
      damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ (1U << bit));
      EXPECT_EQ(frames_in(check_seanet_frame, joined({before, damaged, behind}), 5), (Frames{before, behind}))
          << "byte " << i << " bit " << bit;
    }
  }
}

TEST(SeanetFrames, WhatFollowsAFrameThatBreaksOffIsNotLost) {
  const auto line = from_hex(kLine);
  const auto stream = joined({from_hex("134030"), from_hex(kAlive), {line.begin(), line.begin() + 20}, line, {0x0a}});
  ASSERT_EQ(stream.size(), 97U);
  FrameFinder finder(check_seanet_frame);
  finder.push(stream);
  finder.end();
  const auto alive = finder.next();
  ASSERT_TRUE(alive);
  EXPECT_EQ(alive->at, 3U);
  const auto whole = finder.next();
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->at, 45U);
  EXPECT_FALSE(finder.next());
  EXPECT_EQ(finder.position(), 97U);
}

TEST(SeanetFrames, BearingsAreClockwiseFrom3200Ahead) {
  const auto bearing_deg = [](std::uint16_t bearing) {
    const auto frame = line_at(bearing);
    const auto beam = beam_of(*seanet_line(frame), 0.0);
    return beam ? beam->bearing_rad * 180.0 / std::numbers::pi : -1.0;
  };
  EXPECT_NEAR(bearing_deg(3200), 0.0, 1e-12);
  EXPECT_NEAR(bearing_deg(3216), 359.1, 1e-12);
  EXPECT_NEAR(bearing_deg(4800), 270.0, 1e-12) << "to the right";
  EXPECT_NEAR(bearing_deg(1600), 90.0, 1e-12) << "to the left";
  EXPECT_NEAR(bearing_deg(0), 180.0, 1e-12);
  EXPECT_EQ(bearing_deg(6401), -1.0);
}

TEST(SeanetFrames, SamplesOfFourBitsFillTheSameScaleNearerOneFirst) {
  const auto frame = from_hex(kNibbles);
  const auto beam = beam_of(*seanet_line(frame), 0.0);
  ASSERT_TRUE(beam);
  EXPECT_THAT(beam->intensities, ElementsAre(3 * 17, 10 * 17, 0, 15 * 17, 4 * 17, 0));
  EXPECT_NEAR(beam->bin_length_m, 0.99984, 1e-9);
}

TEST(SeanetFrames, AHeadThatLostItsStepGivesNoBeam) {
  auto frame = from_hex(kLine);
  frame[16] |= 2;
  EXPECT_THAT(beam_of(*seanet_line(frame), 0.0).error(), HasSubstr("step"));
}

TEST(SeanetFrames, WithoutAnIntervalTheRangeScaleTellsTheBins) {
  auto frame = from_hex(kLine);
  frame[33] = frame[34] = 0;
  EXPECT_NEAR(beam_of(*seanet_line(frame), 0.0)->bin_length_m, 1.0, 1e-12) << "6 m in 6 bins";
  frame[21] = 0x40;
  EXPECT_NEAR(beam_of(*seanet_line(frame), 0.0)->bin_length_m, 0.3048, 1e-12) << "6 feet";
}

TEST(Seanet, ASerialCaptureThatBeginsWithinAFrameIsKnown) {
  const auto line = from_hex(kLine);
  const auto capture = joined({{line.begin() + 21, line.end()}, from_hex(kAlive), line, line_at(3300)});
  EXPECT_EQ(format_of(capture), Format::kSeanetCapture);
  const auto source = open_beams({"serial.bin", capture});
  ASSERT_TRUE(source);
  EXPECT_EQ((*source)->device(), find_device("micron"));
  const auto all = read_all(**source);
  ASSERT_TRUE(all);
  ASSERT_EQ(all->size(), 2U);
  EXPECT_THAT((*all)[0].intensities, ElementsAre(0, 10, 13, 64, 255, 9));
  // A line without a clock: ten bits a byte, at 115,200 bits a second.
  EXPECT_NEAR((*all)[1].time_s - (*all)[0].time_s, static_cast<double>(line.size()) * 10.0 / 115200.0, 1e-12);
  ASSERT_EQ((*source)->damage().size(), 1U);
  EXPECT_EQ((*source)->damage()[0].what, FrameFinder::kBetween);
  EXPECT_EQ(all_beams({"serial.bin", capture}, Damage::kFail).error, "serial.bin: byte 0: bytes between frames");
}

TEST(Seanet, PacketsOfOtherPortsAreNotTheSonars) {
  const auto line = from_hex(kLine), next = line_at(3300);
  const auto rest = std::span(line).subspan(9);
  const std::string log =
      "2017.11.02 08.58.46.723;10.3.0.40;13102;24 52 4F 56\n"
      "2017.11.02 08.58.46.800;10.3.0.40;4002;" +
      hex_of(std::span(line).first(9)) + "\n" + "2017.11.02 08.58.47.000;10.3.0.40;13102;" +
      hex_of(std::span(next).first(40)) + "\r\n" + "2017.11.02 08.58.47.250;10.3.0.40;4002;" + hex_of(rest) + "\r\n" +
      "2017.11.02 08.58.47.300;10.3.0.40;4002;0G 01\n" + "2017.11.03 00.00.00.500;10.3.0.40;4002;" + hex_of(next);
  EXPECT_EQ(format_of(bytes_of(log)), Format::kUdpCapture);
  const auto source = open_beams({"hub.csv", bytes_of(log)});
  ASSERT_TRUE(source);
  const auto all = read_all(**source);
  ASSERT_TRUE(all);
  ASSERT_EQ(all->size(), 2U);
  EXPECT_DOUBLE_EQ((*all)[0].time_s, 1509613127.25) << "2017-11-02 08:58:47.250";
  EXPECT_DOUBLE_EQ((*all)[1].time_s, 1509667200.5);
  ASSERT_EQ((*source)->damage().size(), 1U);
  EXPECT_EQ((*source)->damage()[0].what, "line that is not a packet");
  EXPECT_EQ((*source)->damage()[0].first_byte, log.find("2017.11.02 08.58.47.300"));
}

// Kills text logs that are not known when they begin within a line.
TEST(Seanet, TextThatBeginsWithinALineIsKnown) {
  const std::string packet = "2017.11.02 08.58.46.800;10.3.0.40;4002;" + hex_of(from_hex(kLine)) + "\r\n";
  const std::string dump = "SON,00:00:00.500,2,16,8967,60,84,0,8,81,2400,4000,16,3232,3,1,2,3\r\n";
  for (std::size_t from = 1; from < packet.size() - 2; ++from) {
    const auto capture = bytes_of(packet.substr(from) + packet + packet);
    ASSERT_EQ(format_of(capture), Format::kUdpCapture) << from;
    const auto all = all_beams({"hub.csv", capture});
    EXPECT_EQ(all.items.size(), 2U) << from;
    EXPECT_EQ(all.skipped, 1U) << from;
  }
  for (std::size_t from = 1; from < dump.size() - 2; ++from) {
    const auto capture = bytes_of(dump.substr(from) + dump + dump);
    ASSERT_EQ(format_of(capture), Format::kDumplog) << from;
    EXPECT_EQ(all_beams({"dump.csv", capture}).items.size(), 2U) << from;
  }
}

// Kills "the first damage" that is only the first of its kind, and a cut that counts once as a line and once as a
// frame.
TEST(Seanet, DamageIsInTheOrderOfTheFileAndACutCountsOnce) {
  const auto line = from_hex(kLine), next = line_at(3300);
  const std::string before = "2017.11.02 08.58.46.800;10.3.0.40;4002;";
  const std::string head = before + "00 00 " + hex_of(line) + "\n" + before;
  const std::string log = head + hex_of(std::span(next).first(20)) + "\n" + "2017.11.02 08.58.47.100;10.3.0.40;4002;0";
  const auto source = open_beams({"hub.csv", bytes_of(log)});
  ASSERT_TRUE(source);
  ASSERT_EQ(read_all(**source)->size(), 1U);
  const auto damage = (*source)->damage();
  ASSERT_EQ(damage.size(), 2U);
  EXPECT_EQ(damage[0].what, FrameFinder::kBetween);
  EXPECT_EQ(damage[0].first_byte, before.size());
  EXPECT_EQ(damage[1].what, FrameFinder::kCutOff);
  EXPECT_EQ(damage[1].count, 1U);
  EXPECT_EQ(damage[1].first_byte, head.size());
  EXPECT_EQ((*source)->first_damage(), "byte 39: bytes between frames");
}

TEST(Seanet, DumpLogLinesHaveNoDateAndGoOnBehindMidnight) {
  const std::string line = "SON,23:59:59.178,2,16,8967,60,84,0,8,81,2400,4000,16,3216,6,0,10,13,64,255,9\r\n";
  const std::string log =
      "SOf,DateTime,Node,Status,Hdctrl,Rangescale,Gain,Slope,AdLow,AdSpan,LeftLim,RightLim,Steps,Bearing,Dbytes\r\n" +
      line + "AUX,23:59:59.200,1\r\n" + "SON,00:00:00.500,2,16,8967,60,84,0,8,81,2400,4000,16,3232,3,1,2,3\n" +
      "SON,00:00:00.600,2,16,8967,60,84,0,8,81,2400,4000,16,3248,4,1,2,3\n" +
      "SON,00:00:00.700,2,16,8967,60,84,0,8,81,2400,4000,16,3264,0";
  EXPECT_EQ(format_of(bytes_of(log)), Format::kDumplog);
  EXPECT_EQ(format_of(bytes_of(line)), Format::kDumplog) << "without the line of names";
  const auto all = all_beams({"dump.csv", bytes_of(log)});
  ASSERT_EQ(all.items.size(), 3U);
  EXPECT_EQ(all.skipped, 1U);
  EXPECT_NEAR(all.items[0].time_s, 86399.178, 1e-9);
  EXPECT_NEAR(all.items[1].time_s, 86400.5, 1e-9);
  EXPECT_DOUBLE_EQ(all.items[0].bin_length_m, 1.0);
  EXPECT_DOUBLE_EQ(all.items[1].bin_length_m, 2.0);
  EXPECT_THAT(all.items[0].intensities, ElementsAre(0, 10, 13, 64, 255, 9));
  EXPECT_TRUE(all.items[2].intensities.empty());
  EXPECT_EQ(all_beams({"dump.csv", bytes_of(log)}, Damage::kFail).error,
            "dump.csv: byte " + std::to_string(log.find("SON,00:00:00.600")) + ": has 3 samples, not 4");
}

/// A V4LOG with the golden line at some bearings, one second apart.
std::vector<std::uint8_t> v4log(const std::vector<std::uint16_t>& bearings) {
  std::vector<std::uint8_t> log = bytes_of("SeaNetV4 Log File V1           \x1a");
  const auto put = [&log](auto value) {
    std::uint8_t bytes[sizeof(value)];
    std::memcpy(bytes, &value, sizeof(value));
    log.insert(log.end(), bytes, bytes + sizeof(value));
  };
  const auto line = from_hex(kLine);
  const std::size_t record = line.size() + 1;  // 17 bytes in front of the device block instead of 15, and no LF
  const auto end = static_cast<std::uint32_t>(100 + bearings.size() * record);
  for (const std::uint32_t number : {16U, 80U, 100U, static_cast<std::uint32_t>(bearings.size()), end, end, end, end}) {
    put(number);
  }
  log.resize(100);
  for (std::size_t i = 0; i < bearings.size(); ++i) {
    put(static_cast<std::uint16_t>(record));
    put(25569.0 + 100.0 + static_cast<double>(i) / 86400.0);
    for (const int byte : {2, 255, 2, 0x80, 2}) log.push_back(static_cast<std::uint8_t>(byte));
    const auto at = line_at(bearings[i]);
    log.insert(log.end(), at.begin() + 13, at.end() - 1);
  }
  return log;
}

// Kills navigation that is joined to the made-up times of a capture, and a time of day that is added to a start.
TEST(Seanet, LogsTellWhatTheirTimesCountFrom) {
  const auto clock_of = [](const std::vector<std::uint8_t>& log) {
    const auto source = open_beams({"log", log});
    return source ? std::optional((*source)->clock()) : std::nullopt;
  };
  EXPECT_EQ(clock_of(from_hex(kLine)), BeamClock::kNone);
  EXPECT_EQ(clock_of(v4log({3200, 3216})), BeamClock::kOwn);
  EXPECT_EQ(clock_of(bytes_of("SON,23:59:59.178,2,16,8967,60,84,0,8,81,2400,4000,16,3216,1,7\r\n")),
            BeamClock::kTimeOfDay);
}

// Kills sweeps of two heads as one picture, in each kind of log.
TEST(Seanet, BeamsOfASecondHeadOnTheLineAreCounted) {
  auto other = line_at(3300);
  other[7] = 4;
  auto v4 = v4log({3200, 3216, 3232});
  v4[100 + 52 + 10] = 4;
  const std::string first = "SON,00:00:00.500,2,16,8967,60,84,0,8,81,2400,4000,16,3232,3,1,2,3\n";
  const std::string second = "SON,00:00:00.600,4,16,8967,60,84,0,8,81,2400,4000,16,3232,3,1,2,3\n";
  for (const FileBytes& file : {FileBytes{"capture", joined({line_at(3200), other, line_at(3216)})},
                                {"a.V4LOG", v4},
                                {"dump.csv", bytes_of(first + second + first)}}) {
    const auto all = all_beams(file);
    EXPECT_EQ(all.items.size(), 2U) << file.name;
    EXPECT_EQ(all.skipped, 1U) << file.name;
    EXPECT_THAT(all_beams(file, Damage::kFail).error, testing::EndsWith("beam of another head")) << file.name;
  }
}

// A wrong bit in the first beam's sender made all beams those of another head.
TEST(Seanet, ADamagedNumberOfTheFirstHeadCostsFewBeams) {
  std::vector<std::uint16_t> bearings(20, 3200);
  auto v4 = v4log(bearings);
  v4[100 + 10] = 66;
  std::vector<std::vector<std::uint8_t>> lines(20, line_at(3200));
  lines[0][7] = 66;
  std::vector<std::uint8_t> capture;
  for (const auto& line : lines) capture.insert(capture.end(), line.begin(), line.end());
  std::string dump = "SON,00:00:00.500,9,16,8967,60,84,0,8,81,2400,4000,16,3232,3,1,2,3\n";
  for (int i = 1; i < 20; ++i) dump += "SON,00:00:00.600,2,16,8967,60,84,0,8,81,2400,4000,16,3232,3,1,2,3\n";
  for (const FileBytes& file : {FileBytes{"capture", capture}, {"a.V4LOG", v4}, {"dump.csv", bytes_of(dump)}}) {
    const auto all = all_beams(file);
    EXPECT_EQ(all.items.size(), 13U) << file.name;
    EXPECT_EQ(all.skipped, 7U) << file.name;
  }
}

// A head without power, which is heard first, is not the head of the log.
TEST(Seanet, TheFirstHeadIsOneThatHearsSomething) {
  auto v4 = v4log({3200, 3216, 3232});
  v4[100 + 10] = 4;
  v4[100 + 18] |= 1;
  const auto all = all_beams({"a.V4LOG", v4});
  EXPECT_EQ(all.items.size(), 2U);
  EXPECT_EQ(all.skipped, 1U);
}

TEST(Seanet, ADumpLogHasItsHeadsStatusAndSamplesOf4Bits) {
  const auto line = [](const char* status_and_control, const char* samples) {
    return fmt::format("SON,00:00:00.500,2,{},60,84,0,8,81,2400,4000,16,3232,{}\n", status_and_control, samples);
  };
  const auto all =
      all_beams({"dump.csv", bytes_of(line("16,8967", "2,9,15") + line("1,8967", "2,9,15") + line("2,8967", "2,9,15") +
                                      line("0,8966", "2,9,15") + line("0,8966", "2,9,16"))});
  EXPECT_EQ(all.skipped, 2U);
  ASSERT_EQ(all.items.size(), 3U);
  EXPECT_THAT(all.items[0].intensities, ElementsAre(9, 15));
  EXPECT_THAT(all.items[1].intensities, ElementsAre(153, 255));
  EXPECT_THAT(all.items[2].intensities, ElementsAre(9, 16)) << "of 8 bits after all";
}

// Kills beams that are left out in silence where the header's numbers are damaged.
TEST(Seanet, AV4logSaysWhatItsHeaderGetsWrong) {
  const auto with = [](std::size_t place, std::uint8_t value) {
    auto log = v4log({3200, 3216, 3232, 3248});
    log[place] = value;
    log.insert(log.end(), 64, 0xee);  // the index
    return all_beams({"a.V4LOG", log});
  };
  EXPECT_EQ(with(0x30, 204).items.size(), 4U) << "the end of the records is behind the second";
  EXPECT_EQ(with(0x30, 204).skipped, 1U);
  EXPECT_EQ(with(0x28, 152).items.size(), 3U) << "the first record is the second";
  EXPECT_EQ(with(0x28, 152).skipped, 1U);
}

/// A line of a profiling head: limits, step, scan time and count, then times, all of 16 bits.
std::vector<std::uint8_t> profile_line(std::uint8_t type) {
  std::vector<std::uint8_t> frame = from_hex(kLine);
  frame.resize(31);
  frame[15] = type;
  for (const unsigned value : {2400U, 4000U, 16U + (50U << 8U), 3U, 1200U, 1210U, 1220U}) {
    frame.push_back(static_cast<std::uint8_t>(value & 0xffU));
    frame.push_back(static_cast<std::uint8_t>(value >> 8U));
  }
  while (frame.size() < 51 + 2 * 3 - 1) frame.push_back(0);
  frame.push_back('\n');
  const std::string length = fmt::format("{:04X}", frame.size() - 6);
  std::copy(length.begin(), length.end(), frame.begin() + 1);
  frame[5] = static_cast<std::uint8_t>(frame.size() - 6);
  frame[13] = static_cast<std::uint8_t>(frame.size() - 14);
  return frame;
}

// Kills times of echoes that are taken for a picture, and frames that are called damaged though they are whole.
TEST(Seanet, LinesOfAProfilingHeadAreCountedAsSuch) {
  for (const std::uint8_t type : {std::uint8_t{5}, std::uint8_t{20}}) {
    const auto source = open_beams({"capture", joined({line_at(3200), profile_line(type), line_at(3216)})});
    ASSERT_TRUE(source);
    EXPECT_EQ(read_all(**source)->size(), 2U);
    ASSERT_EQ((*source)->damage().size(), 1U);
    EXPECT_EQ((*source)->damage()[0].what, "line of a profiling head");
  }
}

// Kills a device that is taken from a line which is not read.
TEST(Seanet, AV4logWithAProfilingHeadIsOfTheOtherOne) {
  auto log = v4log({3200, 3216, 3232});
  const std::size_t first = log[0x28] + log[0x29] * 256U;
  log[first + 17] = 20;
  const auto source = open_beams({"a.V4LOG", log});
  ASSERT_TRUE(source);
  EXPECT_EQ(read_all(**source)->size(), 2U);
  ASSERT_EQ((*source)->damage().size(), 1U);
  EXPECT_EQ((*source)->damage()[0].what, "line of a profiling head");
  ASSERT_NE((*source)->device(), nullptr);
  EXPECT_EQ((*source)->device()->name, "micron");
}

// A hub of several heads. Kills a sonar's port that is that of the profiler.
TEST(Seanet, PacketsOfAProfilingHeadAreNotTheSonars) {
  const std::string at = "2017.11.02 08.58.46.723;10.3.0.40;";
  const auto all = all_beams({"hub.csv", bytes_of(at + "4001;" + hex_of(profile_line(20)) + "\r\n" + at + "4002;" +
                                                  hex_of(line_at(3200)) + "\r\n")});
  EXPECT_EQ(all.error, "");
  EXPECT_EQ(all.items.size(), 1U);
}

// Kills a log that lacks beams and does not say so.
TEST(Seanet, LinesThatAreCutIntoPacketsAreCounted) {
  auto part = line_at(3300);
  part[11] = 0;
  const auto all = all_beams({"capture", joined({line_at(3200), part, line_at(3216)})});
  EXPECT_EQ(all.items.size(), 2U);
  EXPECT_EQ(all.skipped, 1U);
}

TEST(Seanet, AV4logIsReadUpToItsIndexAndOnBehindDamage) {
  auto log = v4log({3200, 3216, 3232, 3248});
  log.insert(log.end(), 64, 0xee);  // the index
  EXPECT_EQ(format_of(log), Format::kV4log);
  const auto all = all_beams({"a.V4LOG", log}, Damage::kFail);
  EXPECT_EQ(all.error, "");
  ASSERT_EQ(all.items.size(), 4U);
  EXPECT_NEAR(all.items[1].time_s - all.items[0].time_s, 1.0, 1e-5);
  EXPECT_NEAR(all.items[0].time_s, 8640000.0, 1e-5);
  EXPECT_THAT(all.items[0].intensities, ElementsAre(0, 10, 13, 64, 255, 9));

  const std::size_t second = 100 + 52;
  log[second] = 200;
  const auto damaged = all_beams({"a.V4LOG", log});
  EXPECT_EQ(damaged.items.size(), 3U);
  EXPECT_EQ(damaged.skipped, 1U);
  EXPECT_EQ(all_beams({"a.V4LOG", log}, Damage::kFail).error, "a.V4LOG: byte 152: its length or its time is damaged");

  log = v4log({3200, 3216});
  log.pop_back();
  const auto cut = all_beams({"a.V4LOG", log});
  EXPECT_EQ(cut.items.size(), 1U);
  EXPECT_EQ(cut.skipped, 1U) << "a record that is cut off is the only one that is missing";
}

const std::string kRaw = PINGVOX_SHARED_DATA "/seanet-rov-raw/";

TEST(Seanet, TheRealCaptureGivesEachOfIts765Lines) {
  auto stream = ByteStream::open(kRaw + "UdpHubLog_4001_2017_11_02_09_00_03.csv");
  if (!stream) GTEST_SKIP() << kRaw << " is missing: skipped";
  const auto source = open_beams(std::move(*stream));
  ASSERT_TRUE(source);
  const auto all = read_all(**source);
  ASSERT_TRUE(all);
  ASSERT_EQ(all->size(), 765U);
  std::set<double> bearings;
  for (std::size_t i = 0; i < all->size(); ++i) {
    EXPECT_EQ((*all)[i].intensities.size(), 794U);
    EXPECT_NEAR((*all)[i].bin_length_m, 0.06384, 1e-12);
    bearings.insert((*all)[i].bearing_rad);
    EXPECT_GE((*all)[i].time_s, (*all)[i > 0 ? i - 1 : 0].time_s);
  }
  EXPECT_EQ(bearings.size(), 90U);
  // The bytes in front of the first line, and the last one, which is cut off.
  EXPECT_EQ((*source)->skipped(), 2U);

  // The same bytes as they came over the serial line.
  std::ifstream hub(kRaw + "UdpHubLog_4001_2017_11_02_09_00_03.csv");
  std::vector<std::uint8_t> serial;
  for (std::string line; std::getline(hub, line);) {
    if (line.find(";4002;") == std::string::npos) continue;
    for (std::size_t i = line.rfind(';') + 1; i + 1 < line.size(); i += 3) {
      serial.push_back(static_cast<std::uint8_t>(std::stoi(line.substr(i, 2), nullptr, 16)));
    }
  }
  EXPECT_EQ(serial.size(), 641'888U);
  const auto raw = all_beams({"serial", serial});
  ASSERT_EQ(raw.items.size(), all->size());
  for (std::size_t i = 0; i < all->size(); ++i) {
    ASSERT_EQ(raw.items[i].intensities, (*all)[i].intensities);
    ASSERT_EQ(raw.items[i].bearing_rad, (*all)[i].bearing_rad);
  }
}

TEST(Seanet, TheRealV4logGivesEachOfIts468Records) {
  auto stream = ByteStream::open(kRaw + "90degree_scan_target_moving_in.V4LOG");
  if (!stream) GTEST_SKIP() << kRaw << " is missing: skipped";
  const auto source = open_beams(std::move(*stream), Damage::kFail);
  ASSERT_TRUE(source);
  EXPECT_EQ((*source)->device(), find_device("seaking-325"));
  const auto all = read_all(**source);
  ASSERT_TRUE(all) << all.error().message;
  ASSERT_EQ(all->size(), 468U);
  int right = 0, left = 0, same = 0;
  for (std::size_t i = 0; i < all->size(); ++i) {
    EXPECT_EQ((*all)[i].intensities.size(), 642U);
    if (i == 0) continue;
    EXPECT_GT((*all)[i].time_s, (*all)[i - 1].time_s);
    const double turned_deg =
        std::remainder((*all)[i].bearing_rad - (*all)[i - 1].bearing_rad, 2.0 * std::numbers::pi) * 180.0 /
        std::numbers::pi;
    right += std::abs(turned_deg + 3.6) < 1e-9 ? 1 : 0;
    left += std::abs(turned_deg - 3.6) < 1e-9 ? 1 : 0;
    same += turned_deg == 0.0 ? 1 : 0;
  }
  EXPECT_EQ(left, 225);
  EXPECT_EQ(right, 224);
  EXPECT_EQ(same, 18);
  EXPECT_NEAR(all->back().time_s - all->front().time_s, 45.2, 0.1);
}

}  // namespace
}  // namespace pingvox
