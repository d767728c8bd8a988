#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "io/internal/ping_frame.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "support/frames.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kPing = "42521200 fc08 0200 01 00 c900 0b00 5800 ee02 0400 0400 5299bedc 5606";
constexpr const char* kAutoPing =
    "42521800 fd08 0200 01 01 0000 6b00 7803 ee02 0000 8f01 01 00 0400 0400 000a40ff 6d05";
constexpr const char* kInformation = "42520600 0400 0200 024303010100 ea00";

/// A log with records of a time and some bytes, as Qt writes it.
class LogWriter {
 public:
  explicit LogWriter(std::uint32_t type = 2) {
    text(U"PingViewer sensor log file");
    number(1);
    for (const auto* about : {U"a1", U"d", U"t", U"o", U"1"}) text(about);
    number(1);
    number(type);
  }
  LogWriter& record(const std::u32string& time, const std::vector<std::uint8_t>& data) {
    text(time);
    number(static_cast<std::uint32_t>(data.size()));
    bytes_.insert(bytes_.end(), data.begin(), data.end());
    return *this;
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  void number(std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes_.push_back(static_cast<std::uint8_t>(value >> shift));
  }
  void text(const std::u32string& characters) {
    number(static_cast<std::uint32_t>(2 * characters.size()));
    for (const char32_t c : characters) {
      bytes_.push_back(static_cast<std::uint8_t>(c >> 8));
      bytes_.push_back(static_cast<std::uint8_t>(c));
    }
  }
  std::vector<std::uint8_t> bytes_;
};

std::vector<std::uint8_t> cut(const std::vector<std::uint8_t>& bytes, std::size_t from, std::size_t to) {
  return {bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.begin() + static_cast<std::ptrdiff_t>(to)};
}

/// A ping with some samples, for angles and settings of any kind.
std::vector<std::uint8_t> ping_frame(std::uint16_t angle, std::uint16_t period, std::vector<std::uint8_t> samples) {
  std::vector<std::uint8_t> frame = from_hex("4252 0000 fc08 0200 01 00");
  const auto put = [&](std::size_t value) {
    frame.push_back(static_cast<std::uint8_t>(value));
    frame.push_back(static_cast<std::uint8_t>(value >> 8));
  };
  for (const std::size_t value :
       {std::size_t{angle}, std::size_t{11}, std::size_t{period}, std::size_t{750}, samples.size(), samples.size()}) {
    put(value);
  }
  frame.insert(frame.end(), samples.begin(), samples.end());
  frame[2] = static_cast<std::uint8_t>(frame.size() - 8);
  frame[3] = static_cast<std::uint8_t>((frame.size() - 8) >> 8);
  std::size_t sum = 0;
  for (const std::uint8_t byte : frame) sum += byte;
  put(sum);
  return frame;
}

TEST(PingFrames, AreFoundHoweverTheStreamIsCutIntoPieces) {
  const Frames frames = {from_hex(kInformation), from_hex(kPing), from_hex(kAutoPing), ping_frame(3, 100, {1, 2}),
                         from_hex("42520200 0100 0200 570b fb00")};
  const auto stream = joined(frames);
  for (std::size_t piece = 1; piece <= stream.size(); ++piece) {
    EXPECT_EQ(frames_in(check_ping_frame, stream, piece), frames) << "pieces of " << piece;
  }
  for (std::size_t place = 0; place <= stream.size(); ++place) {
    FrameFinder finder(check_ping_frame);
    std::size_t found = 0;
    finder.push(std::span(stream).first(place));
    while (finder.next()) ++found;
    finder.push(std::span(stream).subspan(place));
    while (finder.next()) ++found;
    EXPECT_EQ(found, frames.size()) << "split at " << place;
    EXPECT_TRUE(finder.damage().empty());
  }
}

TEST(PingFrames, AWrongBitALostAndADoubledByteCostOneFrameAndNoOther) {
  const auto before = from_hex(kPing), behind = from_hex(kAutoPing);
  // Samples that look like the beginning of a frame of many bytes.
  const auto hit = ping_frame(10, 88, {'B', 'R', 0x00, 0x10, 'B', 'R', 4, 0, 9, 'B'});
  const Frames left = {before, behind};
  std::size_t cases = 0;
  const auto judge = [&](const std::vector<std::uint8_t>& damaged, const std::string& how) {
    ++cases;
    EXPECT_EQ(frames_in(check_ping_frame, joined({before, damaged, behind}), 7), left) << how;
  };
  for (std::size_t i = 0; i < hit.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      auto damaged = hit;
      damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ (1U << bit));
      judge(damaged, "byte " + std::to_string(i) + " bit " + std::to_string(bit));
    }
    auto damaged = hit;
    damaged.erase(damaged.begin() + static_cast<std::ptrdiff_t>(i));
    // Without one of the bytes that are 0 the sum is right, and the length is not.
    judge(damaged, "without byte " + std::to_string(i));
    damaged = hit;
    damaged.insert(damaged.begin() + static_cast<std::ptrdiff_t>(i), hit[i]);
    // A 'B' more in front of a whole frame is a stray byte.
    if (i > 0 && i + 1 < hit.size()) judge(damaged, "byte " + std::to_string(i) + " twice");
  }
  EXPECT_EQ(cases, hit.size() * 10 - 2);
}

TEST(PingFrames, WhatFollowsAFrameThatBreaksOffIsNotLost) {
  const auto ping = from_hex(kPing);
  for (const std::size_t left : {std::size_t{20}, ping.size() - 2}) {
    FrameFinder finder(check_ping_frame);
    finder.push(joined({cut(ping, 0, left), ping}));
    const auto frame = finder.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->at, left);
    ASSERT_EQ(finder.damage().size(), 1U);
    EXPECT_EQ(finder.damage()[0].what, left == 20 ? "impossible length" : "wrong checksum");
    EXPECT_EQ(finder.damage()[0].first_byte, 0U);
  }
}

// Kills a live head that is silent until a damaged length is filled: each answer is waited for.
TEST(PingFrames, ADamagedLengthDelaysNoOther) {
  const auto ping = from_hex(kPing);
  for (int bit = 0; bit < 16; ++bit) {
    auto damaged = ping;
    damaged[static_cast<std::size_t>(2 + bit / 8)] ^= static_cast<std::uint8_t>(1U << bit % 8);
    FrameFinder finder(check_ping_frame);
    finder.push(joined({damaged, ping}));
    EXPECT_TRUE(finder.next()) << bit;
  }
}

TEST(PingFrames, OneThatIsCutOffAtTheEndIsNoFrameAndTold) {
  const auto ping = from_hex(kPing);
  FrameFinder finder(check_ping_frame);
  finder.push(cut(ping, 0, ping.size() - 3));
  finder.end();
  EXPECT_FALSE(finder.next());
  ASSERT_EQ(finder.damage().size(), 1U);
  EXPECT_EQ(finder.damage()[0].what, FrameFinder::kCutOff);
  EXPECT_EQ(finder.damage()[0].count, 1U);
  EXPECT_EQ(finder.position(), ping.size() - 3);
}

TEST(PingFrames, DamagedFramesBesideEachOtherAreCountedEach) {
  auto wrong = from_hex(kPing);
  wrong.back() ^= 1;
  FrameFinder finder(check_ping_frame);
  finder.push(joined({wrong, wrong, {0xfe, 0xfe}, from_hex(kPing), {0xfe}, from_hex(kPing)}));
  std::size_t found = 0;
  while (finder.next()) ++found;
  EXPECT_EQ(found, 2U);
  ASSERT_EQ(finder.damage().size(), 2U);
  EXPECT_EQ(finder.damage()[0].count, 2U);
  EXPECT_EQ(finder.damage()[1].what, FrameFinder::kBetween);
  EXPECT_EQ(finder.damage()[1].count, 1U) << "what directly follows a damaged frame is of its damage";
  EXPECT_EQ(finder.damage()[1].first_byte, 2 * wrong.size() + 2 + wrong.size());
}

TEST(PingFrames, ADeviceCountsClockwiseFrom200Ahead) {
  const auto bearing_deg = [](std::uint16_t angle) {
    const auto frame = ping_frame(angle, 88, {1});
    const auto beam = beam_of(*ping360_ping(frame), 0.0);
    return beam ? beam->bearing_rad * 180.0 / std::numbers::pi : -1.0;
  };
  EXPECT_NEAR(bearing_deg(200), 0.0, 1e-12);
  EXPECT_NEAR(bearing_deg(300), 270.0, 1e-12) << "to the right";
  EXPECT_NEAR(bearing_deg(100), 90.0, 1e-12) << "to the left";
  EXPECT_NEAR(bearing_deg(0), 180.0, 1e-12);
  EXPECT_NEAR(bearing_deg(400), 180.0, 1e-12);
  EXPECT_EQ(bearing_deg(401), -1.0);
}

// Kills a beam of another length than the head was asked for.
TEST(PingFrames, SamplesThatAreNotAsManyAsWereAskedForAreRefused) {
  const auto frame = ping_frame(200, 88, {1, 2, 3});
  Ping360Ping ping = *ping360_ping(frame);
  EXPECT_TRUE(beam_of(ping, 0.0));
  ping.samples = 200;
  const auto beam = beam_of(ping, 0.0);
  ASSERT_FALSE(beam);
  EXPECT_EQ(beam.error(), "number_of_samples 200 does not fit 3 samples");
}

TEST(PingViewer, AFrameHasTheTimeOfTheRecordThatHoldsItsLastByte) {
  const auto ping = from_hex(kPing);
  const auto log =
      LogWriter().record(U"00:00:02.103", cut(ping, 0, 9)).record(U"00:00:02.140", cut(ping, 9, ping.size()));
  ASSERT_EQ(log.bytes().size(), 192U);
  EXPECT_EQ(format_of(log.bytes()), Format::kPingViewer);
  const auto all = all_beams({"two.bin", log.bytes()}, Damage::kFail);
  EXPECT_EQ(all.error, "");
  ASSERT_EQ(all.items.size(), 1U);
  EXPECT_DOUBLE_EQ(all.items[0].time_s, 2.140);
  EXPECT_DOUBLE_EQ(all.items[0].bin_length_m, 0.00165);
  EXPECT_NEAR(all.items[0].bearing_rad, 2.0 * std::numbers::pi - 2.0 * std::numbers::pi / 400.0, 1e-15);
  EXPECT_THAT(all.items[0].intensities, ElementsAre(0x52, 0x99, 0xbe, 0xdc));
}

TEST(PingViewer, IsReadWhereverTheLinkWasCutIntoRecords) {
  const auto stream = joined({from_hex(kInformation), from_hex(kPing), ping_frame(205, 88, {}), from_hex(kAutoPing)});
  for (std::size_t place = 0; place <= stream.size(); ++place) {
    const auto log = LogWriter()
                         .record(U"00:00:01.000", cut(stream, 0, place))
                         .record(U"00:00:02.000", cut(stream, place, stream.size()));
    const auto all = all_beams({"cut.bin", log.bytes()}, Damage::kFail);
    EXPECT_EQ(all.error, "");
    ASSERT_EQ(all.items.size(), 3U) << place;
    EXPECT_TRUE(all.items[1].intensities.empty()) << "a ping that was not sent keeps its time and bearing";
  }
}

TEST(PingViewer, TimesHaveTheDigitsOfAnyScriptAndGoOnBehindADay) {
  const auto ping = from_hex(kPing);
  const auto log = LogWriter()
                       .record(U"\u06F2\u06F3:\u06F5\u06F9:\u06F5\u06F9.\u06F9\u06F9\u06F0", ping)
                       .record(U"\u0660\u0660:\u0660\u0660:\u0660\u0661.\u0665\u0660\u0660", ping)
                       .record(U"00:00:02.000", ping);
  const auto all = all_beams({"day.bin", log.bytes()});
  ASSERT_EQ(all.items.size(), 3U);
  EXPECT_DOUBLE_EQ(all.items[0].time_s, 86399.99);
  EXPECT_DOUBLE_EQ(all.items[1].time_s, 86401.5);
  EXPECT_DOUBLE_EQ(all.items[2].time_s, 86402.0);
}

TEST(PingViewer, StringsMayBeUtf8) {
  std::string log;
  const auto number = [&](std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) log += static_cast<char>(value >> shift);
  };
  const auto text = [&](const std::string& characters) {
    number(static_cast<std::uint32_t>(characters.size()));
    log += characters;
  };
  text("PingViewer sensor log file");
  number(1);
  for (const auto* about : {"a1", "d", "t", "o", "1"}) text(about);
  number(1);
  number(2);
  const auto ping = from_hex(kPing);
  for (const auto* time : {"00:00:01.250", "\u06F0\u06F0:\u06F0\u06F0:\u06F0\u06F2.\u06F5\u06F0\u06F0"}) {
    text(time);
    number(static_cast<std::uint32_t>(ping.size()));
    log.append(ping.begin(), ping.end());
  }
  const auto all = all_beams({"script.bin", bytes_of(log)}, Damage::kFail);
  EXPECT_EQ(all.error, "");
  ASSERT_EQ(all.items.size(), 2U);
  EXPECT_DOUBLE_EQ(all.items[0].time_s, 1.25);
  EXPECT_DOUBLE_EQ(all.items[1].time_s, 2.5);
}

TEST(PingViewer, ARecordOfImpossibleLengthCostsItsOwnFramesAtMost) {
  const auto ping = from_hex(kPing);
  auto log = LogWriter();
  log.record(U"00:00:01.000", ping);
  const std::size_t second = log.bytes().size();
  log.record(U"00:00:02.000", ping).record(U"00:00:03.000", ping);
  auto bytes = log.bytes();
  bytes[second + 28] = 0x7f;
  const auto source = open_beams({"broken.bin", bytes});
  ASSERT_TRUE(source);
  const auto all = read_all(**source);
  ASSERT_TRUE(all);
  ASSERT_EQ(all->size(), 3U) << "the frame in the record is whole";
  EXPECT_DOUBLE_EQ(all->back().time_s, 3.0);
  const auto damage = (*source)->damage();
  ASSERT_GE(damage.size(), 1U);
  EXPECT_EQ(damage[0].what, "damaged record");
  EXPECT_EQ(damage[0].first_byte, second);
  const auto strict = all_beams({"broken.bin", bytes}, Damage::kFail);
  EXPECT_EQ(strict.items.size(), 1U);
  EXPECT_EQ(strict.error, "broken.bin: byte " + std::to_string(second) + ": damaged record");
}

TEST(PingViewer, MayBeginWithinARecord) {
  const auto ping = from_hex(kPing);
  const auto whole = LogWriter()
                         .record(U"00:00:01.000", ping)
                         .record(U"00:00:02.000", ping)
                         .record(U"23:59:59.000", ping)
                         .record(U"00:00:01.000", ping)
                         .bytes();
  const std::size_t record = 4 + 24 + 4 + ping.size(), second = whole.size() - 3 * record;
  for (std::size_t from = second - record; from <= second; ++from) {
    SCOPED_TRACE(from);
    const auto log = cut(whole, from, whole.size());
    EXPECT_EQ(format_of(log), Format::kPingViewer);
    const auto all = all_beams({"tail.bin", log});
    EXPECT_EQ(all.error, "");
    const std::size_t loose = from <= second - ping.size() ? second - ping.size() - from : second - from;
    EXPECT_EQ(all.skipped, from == second - record || loose < 10 ? 0U : 1U) << "fewer bytes than a frame has are noise";
    ASSERT_EQ(all.items.size(), from <= second - ping.size() ? 4U : 3U);
    const double first_s = from == second - record ? 1.0 : 2.0;
    EXPECT_DOUBLE_EQ(all.items.front().time_s, first_s) << "the beginning has no time of its own";
    const std::vector<Beam> last(all.items.end() - 3, all.items.end());
    EXPECT_DOUBLE_EQ(last[0].time_s, 2.0);
    EXPECT_DOUBLE_EQ(last[1].time_s, 86399.0);
    EXPECT_DOUBLE_EQ(last[2].time_s, 86401.0);
  }
  auto misnamed = whole;
  misnamed[5] ^= 1;
  EXPECT_EQ(all_beams({"misnamed.bin", misnamed}).items.size(), 4U);
}

TEST(PingViewer, DamageIsToldByItsPlaceInTheFile) {
  const auto ping = from_hex(kPing);
  auto wrong = ping;
  wrong[25] ^= 4;
  auto log = LogWriter();
  log.record(U"00:00:01.000", ping).record(U"00:00:02.000", cut(wrong, 0, 5));
  const std::size_t at = log.bytes().size() - 5;
  log.record(U"00:00:03.000", cut(wrong, 5, wrong.size())).record(U"00:00:04.000", ping);
  const auto source = open_beams({"a.bin", log.bytes()});
  ASSERT_TRUE(source);
  ASSERT_EQ(read_all(**source)->size(), 2U);
  ASSERT_EQ((*source)->damage().size(), 1U);
  EXPECT_EQ((*source)->damage()[0].what, "wrong checksum");
  EXPECT_EQ((*source)->damage()[0].first_byte, at);
  EXPECT_EQ((*source)->skipped(), 1U);
  EXPECT_EQ(all_beams({"a.bin", log.bytes()}, Damage::kFail).error,
            "a.bin: byte " + std::to_string(at) + ": wrong checksum");
}

// A transceiver that is switched adds single bytes; a frame that lost its head leaves more than a frame has at least.
TEST(PingViewer, FewBytesBetweenFramesAreNoDamageAndMoreAre) {
  const auto ping = from_hex(kPing);
  std::size_t cases = 0;
  for (std::size_t count = 0; count <= 20; ++count) {
    for (const std::size_t in_first : {std::size_t{0}, count / 2, count}) {
      const std::vector<std::uint8_t> noise(count, 0xfe);
      auto log = LogWriter();
      log.record(U"00:00:01.000", joined({ping, cut(noise, 0, in_first)}));
      const std::size_t at = log.bytes().size() - in_first;
      log.record(U"00:00:02.000", joined({cut(noise, in_first, count), ping}));
      const auto source = open_beams({"noise.bin", log.bytes()});
      ASSERT_TRUE(source);
      EXPECT_EQ(read_all(**source)->size(), 2U);
      EXPECT_EQ((*source)->skipped(), count < 10 ? 0U : 1U) << count;
      if (count >= 10 && in_first > 0) {
        EXPECT_EQ((*source)->damage()[0].first_byte, at) << count;
      }
      EXPECT_EQ(all_beams({"noise.bin", log.bytes()}, Damage::kFail).error.empty(), count < 10) << count;
      ++cases;
    }
  }
  EXPECT_EQ(cases, 63U);
}

// Kills noise that hides the frame that is lost beside it.
TEST(PingViewer, NoiseBesideADamagedFrameHidesNoDamage) {
  const auto ping = from_hex(kPing);
  auto wrong = ping;
  wrong[25] ^= 4;
  auto headless = cut(ping, 2, ping.size());
  const std::vector<std::uint8_t> noise = {0xfe};
  for (const auto& bad : {wrong, headless, cut(ping, 0, 20)}) {
    for (const auto& stream :
         {joined({ping, noise, bad, ping}), joined({ping, bad, noise, ping}), joined({noise, bad})}) {
      const auto log = LogWriter().record(U"00:00:01.000", stream);
      EXPECT_GE(all_beams({"a.bin", log.bytes()}).skipped, 1U);
    }
  }
}

TEST(PingViewer, AnEndWithinARecordKeepsWhatIsWhole) {
  const auto ping = from_hex(kPing);
  const auto whole = LogWriter().record(U"00:00:01.000", ping).record(U"00:00:02.000", joined({ping, ping})).bytes();
  for (std::size_t left = 0; left < 2 * ping.size() + 32; ++left) {
    const auto all = all_beams({"cut.bin", cut(whole, 0, whole.size() - left)});
    EXPECT_EQ(all.error, "");
    const std::size_t lost = left == 0 ? 0 : left <= ping.size() ? 1 : 2;
    EXPECT_EQ(all.items.size(), 3 - lost) << left;
    EXPECT_EQ(all.skipped > 0, left > 0) << left;
  }
}

TEST(PingViewer, AnEchosounderIsToldAsSuch) {
  const auto opened = open_beams({"down.bin", LogWriter(1).bytes()});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, Error::Code::kUnsupported);
  EXPECT_THAT(opened.error().message, HasSubstr("down.bin: is a Ping Viewer log of a Ping1D"));
  EXPECT_THAT(open_beams({"x.bin", LogWriter(7).bytes()}).error().message, HasSubstr("unknown sensor"));
  const auto header = LogWriter().bytes();
  for (std::size_t size = 56; size < header.size(); ++size) {
    EXPECT_EQ(open_beams({"x.bin", cut(header, 0, size)}).error().code, Error::Code::kCorrupt) << size;
  }
}

// Ping Viewer has written Ping1D above pings of a Ping360: the log was refused.
TEST(PingViewer, TheRecordsDecideWhereTheHeaderNamesAnotherSensor) {
  const std::vector<std::uint8_t> ping = from_hex(kPing);
  LogWriter log(1);
  log.record(U"00:00:01.000", cut(ping, 0, 7)).record(U"00:00:02.000", cut(ping, 7, ping.size()));
  const auto opened = open_beams({"dive.bin", log.bytes()});
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_EQ((*opened)->device()->name, "ping360");
  EXPECT_EQ((*opened)->first_damage(), "byte 0: header that names another sensor");
  ASSERT_TRUE((*opened)->next()->has_value());
  EXPECT_FALSE((*opened)->next()->has_value());
}

std::vector<std::string> fields_of(const std::string& line, char separator) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, separator);) fields.push_back(field);
  return fields;
}

/// hh:mm:ss.zzz
double seconds_of(const std::string& time) {
  return std::stod(time.substr(0, 2)) * 3600.0 + std::stod(time.substr(3, 2)) * 60.0 + std::stod(time.substr(6));
}

const std::filesystem::path kLogs = PINGVOX_SHARED_DATA "/ping360-logs";

TEST(PingViewer, RealLogsGiveEachFrameThatAnIndependentDecoderFound) {
  std::ifstream summary(kLogs / "frames_summary.tsv");
  if (!summary) GTEST_SKIP() << kLogs << " is missing: skipped";
  std::map<std::string, std::vector<std::vector<std::string>>> files;
  std::string line;
  std::getline(summary, line);
  while (std::getline(summary, line)) {
    auto fields = fields_of(line, '\t');
    ASSERT_EQ(fields.size(), 17U);
    const std::string name = fields[0];
    files[name].push_back(std::move(fields));
  }
  EXPECT_EQ(files.size(), 13U);
  std::size_t beams = 0;
  for (const auto& [name, frames] : files) {
    SCOPED_TRACE(name);
    auto stream = ByteStream::open((kLogs / name).string());
    ASSERT_TRUE(stream);
    const auto source = open_beams(std::move(*stream));
    ASSERT_TRUE(source);
    EXPECT_EQ((*source)->device(), find_device("ping360"));
    const auto all = read_all(**source);
    ASSERT_TRUE(all);
    ASSERT_EQ(all->size(), frames.size());
    beams += all->size();
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const auto& frame = frames[i];
      const Beam& beam = (*all)[i];
      ASSERT_NEAR(beam.time_s, seconds_of(frame[3]), 1e-9) << i;
      const double turned_deg = std::fmod(360.0 + 180.0 - 0.9 * std::stod(frame[7]), 360.0);
      ASSERT_NEAR(beam.bearing_rad * 180.0 / std::numbers::pi, turned_deg, 1e-9) << i;
      ASSERT_NEAR(beam.bin_length_m, std::stod(frame[9]) * 25e-9 * 750.0, 1e-12) << i;
      ASSERT_EQ(beam.intensities.size(), std::stoul(frame[12])) << i;
      const auto largest = std::max_element(beam.intensities.begin(), beam.intensities.end());
      ASSERT_EQ(largest - beam.intensities.begin(), std::stol(frame[15])) << i;
      const auto crc = ::crc32(0, beam.intensities.data(), static_cast<unsigned>(beam.intensities.size()));
      ASSERT_EQ(crc, std::stoul(frame[16], nullptr, 16)) << i;
    }
  }
  EXPECT_EQ(beams, 10'173U);
}

TEST(PingViewer, RealLogsEqualTheGoldenDecodesBitForBit) {
  for (const std::string name : {"20200926-110158491", "20210829-000733243-5"}) {
    std::ifstream golden(kLogs / ("golden_" + name + ".csv"));
    if (!golden) GTEST_SKIP() << kLogs << " is missing: skipped";
    const auto log = read_file((kLogs / ("ping360_" + name + ".bin")).string());
    ASSERT_TRUE(log);
    const auto all = all_beams(*log);
    std::string line;
    std::getline(golden, line);
    std::size_t frames = 0;
    for (; std::getline(golden, line); ++frames) {
      const auto fields = fields_of(line, ',');
      ASSERT_EQ(fields.size(), 13U);
      ASSERT_LT(frames, all.items.size());
      ASSERT_EQ(all.items[frames].intensities, from_hex(fields[12])) << name << " frame " << frames;
    }
    EXPECT_EQ(frames, all.items.size());
    EXPECT_GT(frames, 200U);
  }
}

TEST(PingViewer, ARealLogFromItsMiddleOnKeepsItsTimes) {
  const auto log = read_file((kLogs / "ping360_20210829-002023975.bin").string());
  if (!log) GTEST_SKIP() << kLogs << " is missing: skipped";
  const auto whole = all_beams(*log);
  for (const std::size_t from : {std::size_t{600'001}, std::size_t{600'500}, std::size_t{1'234'567}}) {
    SCOPED_TRACE(from);
    const auto tail = all_beams({"tail.bin", cut(log->bytes, from, log->bytes.size())});
    EXPECT_EQ(tail.error, "");
    EXPECT_LE(tail.skipped, whole.skipped + 1);
    ASSERT_GT(tail.items.size(), 1000U);
    // The first one may be what is left of a record without a time.
    for (std::size_t i = 1; i < tail.items.size(); ++i) {
      ASSERT_TRUE(same(tail.items[i], whole.items[whole.items.size() - tail.items.size() + i])) << i;
    }
  }
}

TEST(PingViewer, ARealLogWithDamageLosesTheFramesThatAreHitAndNoOther) {
  const auto log = read_file((kLogs / "ping360_20240814-094253162.bin").string());
  if (!log) GTEST_SKIP() << kLogs << " is missing: skipped";
  const auto whole = all_beams(*log);
  ASSERT_EQ(whole.items.size(), 145U);
  // The time stands between the frames' bytes: what hits a record's header may cost its time, but no frame.
  std::size_t lost = 0, cases = 0;
  for (std::size_t place = 300; place < log->bytes.size(); place += 997, ++cases) {
    FileBytes damaged = *log;
    damaged.bytes[place] ^= 0x10;
    const auto all = all_beams(damaged);
    EXPECT_EQ(all.error, "");
    EXPECT_GE(all.items.size(), whole.items.size() - 2) << place;
    EXPECT_LE(all.items.size(), whole.items.size()) << place;
    lost += whole.items.size() - all.items.size();
    for (const Beam& beam : all.items) {
      const bool is_known =
          std::ranges::any_of(whole.items, [&](const Beam& other) { return other.intensities == beam.intensities; });
      ASSERT_TRUE(is_known) << "a frame with a wrong checksum was taken, place " << place;
    }
  }
  EXPECT_GT(cases, 150U);
  EXPECT_LE(lost, cases + 10);
}

}  // namespace
}  // namespace pingvox
