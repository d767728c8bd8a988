// Heads that answer with other values than they were asked for, and lines that flood.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "device/internal/a50_receiver.hpp"
#include "device/internal/link.hpp"
#include "device/internal/live_source.hpp"
#include "device/internal/micron_emulator.hpp"
#include "device/internal/ping360_emulator.hpp"
#include "device/ping360_driver.hpp"
#include "io/internal/frame_finder.hpp"
#include "io/internal/ping_frame.hpp"
#include "io/internal/seanet_frame.hpp"
#include "tests/device/altered_head.hpp"
#include "tests/device/dialogue.hpp"
#include "tests/device/recording.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;
using namespace test;
using Bytes = std::vector<std::uint8_t>;

std::vector<std::uint8_t> hear_nothing(int, std::size_t bins, double) {
  return Bytes(bins, 7);
}

/// A device_data with a word of its payload set; empty: another message.
Bytes with_word(const Bytes& frame, std::size_t at, std::uint16_t word) {
  if (ping_message(frame) != PingMessage::kDeviceData) return {};
  const auto payload = ping_payload(frame);
  Bytes changed(payload.begin(), payload.end());
  changed[at] = static_cast<std::uint8_t>(word & 0xffU);
  changed[at + 1] = static_cast<std::uint8_t>(word >> 8U);
  return make_ping_frame(PingMessage::kDeviceData, 2, 0, changed);
}

// One answer of 374 m where 4 m were asked for ended mapping, answers of 185 m took 80 MB each.
TEST(HostileHead, AnAnswerOfAnotherRangeCostsItsBeam) {
  const Folder folder;
  Result<Link> line = Link::listen("udp://127.0.0.1:0");
  ASSERT_TRUE(line);
  Result<PingViewerRecorder> recorder = PingViewerRecorder::create(folder.path("dive.bin"));
  ASSERT_TRUE(recorder);
  double now_s = 0.0;
  const auto source = ping360_source(line->address(), {.range_m = 4.0, .timeout_s = 1.0}, *std::move(recorder), now_s);
  constexpr std::size_t kPeriod = 6;
  AlteredHead<Ping360Emulator> head(hear_nothing, 3, [period = std::uint16_t{16'000}](const Bytes& frame) mutable {
    Bytes altered = with_word(frame, kPeriod, period);
    if (!altered.empty()) ++period;  // each third is sent: 16,002 is the first
    return altered;
  });
  std::vector<Beam> beams;
  run(*source, *line, head, now_s, beams, 60);
  ASSERT_EQ(beams.size(), 60U);
  source->finish(beams);
  for (const Beam& beam : beams) {
    EXPECT_NEAR(beam.bin_length_m * static_cast<double>(beam.intensities.size()), 4.0, 0.1);
  }
  EXPECT_GT(head.altered(), 20U);
  EXPECT_EQ(source->status().unexpected, head.altered());
  EXPECT_EQ(source->status().first_unexpected, "sample_period 16002 instead of 177");
  EXPECT_EQ(source->status().damaged, 0U);
  EXPECT_EQ(beams_in(folder.path("dive.bin")).size(), beams.size() + head.altered()) << "recorded all the same";
}

// Kills a field that is not compared.
TEST(HostileHead, EachValueOfAPingIsComparedWithTheRequest) {
  Ping360Driver driver({.range_m = 4.0});
  Ping360Emulator head({}, hear_nothing);
  const auto dialogue = [&](double now_s) {
    head.take(*driver.message(now_s), now_s);
    FrameFinder finder(check_ping_frame);
    while (std::isfinite(head.due_s())) finder.push(head.send(head.due_s()));
    Bytes answer;  // the last one
    while (const auto frame = finder.next()) answer.assign(frame->bytes.begin(), frame->bytes.end());
    return answer;
  };
  driver.take(dialogue(0.0));
  ASSERT_TRUE(driver.is_connected());
  const Bytes first = dialogue(1.0);
  EXPECT_EQ(driver.contradiction(first), std::nullopt);
  driver.take(first);
  const Bytes answer = dialogue(2.0);
  EXPECT_EQ(driver.contradiction(answer), std::nullopt);
  EXPECT_EQ(driver.contradiction(first), std::nullopt) << "late, or doubled";

  struct Case {
    std::size_t at;
    std::uint16_t word;
    const char* name;
  };
  for (const Case& c :
       {Case{0, 0x0201, "gain 2 instead of 1"}, Case{2, 7, "angle 7 instead of 1"}, Case{6, 80, "sample_period 80"},
        Case{8, 700, "transmit_frequency 700 instead of 750"}, Case{10, 1100, "number_of_samples 1100"}}) {
    const auto contradiction = driver.contradiction(with_word(answer, c.at, c.word));
    ASSERT_TRUE(contradiction) << c.name;
    EXPECT_THAT(*contradiction, HasSubstr(c.name));
  }
  // Fewer samples than the message says.
  Bytes cut(ping_payload(answer).begin(), ping_payload(answer).end() - 100);
  cut[12] = static_cast<std::uint8_t>((cut.size() - 14) & 0xffU);
  cut[13] = static_cast<std::uint8_t>((cut.size() - 14) >> 8U);
  const auto contradiction = driver.contradiction(make_ping_frame(PingMessage::kDeviceData, 2, 0, cut));
  ASSERT_TRUE(contradiction);
  EXPECT_THAT(*contradiction, HasSubstr("data_length 1100 instead of 1200"));
}

TEST(HostileHead, AMicronsLineOfAnotherRangeCostsItsBeam) {
  const Folder folder;
  Result<Link> line = Link::listen("udp://127.0.0.1:0");
  ASSERT_TRUE(line);
  Result<SeanetRecorder> recorder = SeanetRecorder::create(folder.path("dive.csv"));
  ASSERT_TRUE(recorder);
  double now_s = 0.0;
  const MicronSettings settings{.range_m = 4.0, .sector = {{.left = 2400, .right = 4000}}, .timeout_s = 1.0};
  const auto source = micron_source(line->address(), settings, *std::move(recorder), now_s);
  int kind = 0;
  AlteredHead<MicronEmulator> head(hear_nothing, 4, [&](const Bytes& frame) -> Bytes {
    if (seanet_message(frame) != SeanetMessage::kHeadData) return {};
    constexpr std::size_t kBlock = 15, kInterval = kBlock + 18, kBearing = kBlock + 25;
    Bytes changed = frame;
    const bool is_range = ++kind % 8 == 0;  // of each fourth line one or the other
    const std::size_t at = is_range ? kInterval : kBearing;
    const std::uint16_t number = is_range ? 600 : 5000;  // a longer range that a sonar may have, and out of the sector
    changed[at] = static_cast<std::uint8_t>(number & 0xFFU);
    changed[at + 1] = static_cast<std::uint8_t>(number >> 8U);
    return changed;
  });
  std::vector<Beam> beams;
  run(*source, *line, head, now_s, beams, 80);
  ASSERT_EQ(beams.size(), 80U);
  source->finish(beams);
  for (const Beam& beam : beams) {
    EXPECT_NEAR(beam.bin_length_m * static_cast<double>(beam.intensities.size()), 4.0, 0.1);
    EXPECT_LT(std::min(beam.bearing_rad, 6.2831853 - beam.bearing_rad), 0.9) << "in the sector";
  }
  EXPECT_GT(head.altered(), 20U);
  EXPECT_EQ(source->status().unexpected, head.altered());
  EXPECT_EQ(beams_in(folder.path("dive.csv")).size(), beams.size() + head.altered()) << "recorded all the same";
}

/// Sends junk until a connection takes no more for now, at most 4 MB.
void flood(Link& line) {
  const Bytes junk(65'536, 'x');
  for (int i = 0; i < 64; ++i) ASSERT_TRUE(line.write(junk));
}

constexpr std::size_t kMuch = 400'000;

// Megabytes were read, recorded and parsed before a beam was mapped or a signal heard.
TEST(Flood, OfAHeadIsReadInPortions) {
  const Folder folder;
  Result<Link> line = Link::listen("tcp://127.0.0.1:0");
  ASSERT_TRUE(line);
  Result<SeanetRecorder> recorder = SeanetRecorder::create(folder.path("dive.csv"));
  ASSERT_TRUE(recorder);
  const auto source = micron_source(line->address(), {}, *std::move(recorder), 0.0);
  std::vector<Beam> beams;
  Bytes bytes(65'536);
  for (int i = 0; i < 1000 && source->descriptor() >= 0; ++i) {
    ASSERT_TRUE(source->step(0.0, beams));
    const auto got = line->read(bytes);
    ASSERT_TRUE(got);
    if (*got > 0) break;
  }
  flood(*line);
  // A line of the record has three characters for a byte.
  const auto recorded = [&] { return std::filesystem::file_size(folder.path("dive.csv")) / 3; };
  ASSERT_TRUE(source->step(0.0, beams));
  EXPECT_LT(recorded(), kMuch);
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(source->step(0.0, beams));
  if (recorded() < 2 * kMuch) GTEST_SKIP() << "sockets of this system buffer less";
}

TEST(Flood, OfADvlIsReadInPortions) {
  const Folder folder;
  Result<Link> line = Link::listen("tcp://127.0.0.1:0");
  ASSERT_TRUE(line);
  Result<RecordFile> recorder = RecordFile::create(folder.path("dive.jsonl"));
  ASSERT_TRUE(recorder);
  Result<A50Receiver> receiver = A50Receiver::make(line->address(), *std::move(recorder), 0.0);
  ASSERT_TRUE(receiver);
  Bytes bytes(256);
  const int before = line->descriptor();
  for (int i = 0; i < 1000 && line->descriptor() == before; ++i) {
    receiver->read(0.0);
    ASSERT_TRUE(line->read(bytes));
  }
  flood(*line);
  const auto recorded = [&] { return std::filesystem::file_size(folder.path("dive.jsonl")); };
  receiver->read(0.0);
  EXPECT_LT(recorded(), kMuch);
  for (int i = 0; i < 200; ++i) receiver->read(0.0);
  if (recorded() < 2 * kMuch) GTEST_SKIP() << "sockets of this system buffer less";
}

}  // namespace
}  // namespace pingvox
