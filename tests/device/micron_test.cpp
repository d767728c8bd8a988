// The dialogue with a SeaNet head by the frames of docs and drivers, and over lines with faults.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "device/internal/link.hpp"
#include "device/internal/live_source.hpp"
#include "device/internal/micron_emulator.hpp"
#include "device/micron_command.hpp"
#include "device/micron_driver.hpp"
#include "io/internal/seanet_frame.hpp"
#include "io/internal/seanet_recorder.hpp"
#include "pingvox/geometry/degree.hpp"
#include "tests/device/dialogue.hpp"
#include "tests/device/recording.hpp"

namespace pingvox::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(std::string_view hex) {
  Bytes bytes;
  std::string digits;
  for (const char c : hex) {
    if (c != ' ') digits += c;
    if (digits.size() < 2) continue;
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(digits, nullptr, 16)));
    digits.clear();
  }
  return bytes;
}

// Frames that other drivers send and read (docs/formats.md).
const Bytes kSendVersion = bytes_of("40303030380800ff02031780020a");
const Bytes kSendUserData = bytes_of("40303030380800ff02031880020a");
const Bytes kAliveWithoutParameters = bytes_of("4030303130100002ff0b04800280d2040000800c5d0a");
const Bytes kAliveReady = bytes_of("4030303130100002ff0b0480020060ea0000800c8a0a");
const Bytes kHeadCommand = bytes_of(
    "40303033433c00ff02371380020107230266666605666666 05703d0a09703d0a0928003c006009a00f510854547d007d0019102308"
    "0600e803640040060100 0000 0a");
const Bytes kLine = bytes_of(
    "40303032442d0002ff000280022500111000 07233c000000000054000051080000 23086009a00f10900c0600000a0d40ff090a");

Bytes user_data(std::size_t size, std::uint8_t duplex) {
  Bytes payload(size - 14, 0);
  payload[146 - 13] = duplex;
  return make_seanet_frame(SeanetMessage::kUserData, SeanetSender::kHead, payload);
}

bool is_request(const std::optional<Bytes>& message) {
  return message && seanet_message(*message) == SeanetMessage::kSendData;
}

/// A driver whose head has its parameters.
MicronDriver scanning(const MicronSettings& settings, const Bytes& user) {
  MicronDriver driver(settings);
  driver.message(0.0);
  driver.take(kAliveWithoutParameters);
  driver.message(0.0);
  driver.take(user);
  driver.message(0.0);
  driver.take(kAliveReady);
  return driver;
}

TEST(MicronCommand, IsTheFrameOfOtherDrivers) {
  const MicronCommand command{.control = 0x2307,
                              .head_type = MicronCommand::kImaging,
                              .frequency_hz = 675e3,
                              .pulse_us = 40,
                              .range_dm = 60,
                              .left = 2400,
                              .right = 4000,
                              .span = 81,
                              .low = 8,
                              .gain = 84,
                              .slope = 125,
                              .step = 16,
                              .interval_640ns = 2083,
                              .bins = 6};
  EXPECT_EQ(frame_of(command), kHeadCommand);
}

TEST(MicronSampling, CoversTheRangeInAtMost400Bins) {
  for (const double range_m : {0.5, 1.0, 2.0, 5.0, 10.0, 33.0, 75.0, 300.0}) {
    const MicronSampling sampling = micron_sampling(range_m);
    const double bin_m = 750.0 * 640e-9 * sampling.interval_640ns;
    EXPECT_NEAR(bin_m * sampling.bins, range_m, 0.51 * bin_m) << range_m;
    EXPECT_LE(sampling.bins, 400);
    EXPECT_GE(sampling.interval_640ns, 5);
  }
}

TEST(MicronSettings, NameEveryBrokenField) {
  const auto valid = MicronSettings{.range_m = 0.1, .step = 256, .sector = {{.left = 6400, .right = -1}}}.validate();
  ASSERT_FALSE(valid);
  for (const char* field : {"range_m", "step", "left", "right"}) EXPECT_THAT(valid.error().message, HasSubstr(field));
  EXPECT_TRUE(MicronSettings{}.validate());
}

TEST(MicronDriver, WaitsForTheHeadConfiguresItAndAsksForLines) {
  MicronDriver driver({.range_m = 6.0});
  EXPECT_EQ(driver.message(0.0), kSendVersion);
  EXPECT_FALSE(driver.message(0.5));
  driver.take(kAliveWithoutParameters);
  EXPECT_EQ(driver.message(0.5), kSendUserData);
  driver.take(user_data(264, 1));
  const auto command = driver.message(0.6);
  ASSERT_TRUE(command);
  const auto parameters = micron_command_in(seanet_payload(*command));
  ASSERT_TRUE(parameters);
  EXPECT_EQ(parameters->head_type, MicronCommand::kDst);
  EXPECT_EQ(parameters->control, 0x2307);
  EXPECT_EQ(parameters->range_dm, 60);
  driver.take(kAliveWithoutParameters);  // it still finds its centre
  EXPECT_FALSE(driver.message(1.0));
  EXPECT_FALSE(driver.is_connected());
  driver.take(kAliveReady);
  EXPECT_TRUE(driver.is_connected());
  EXPECT_TRUE(is_request(driver.message(1.1)));
  EXPECT_FALSE(driver.message(1.2));
  driver.take(kLine);
  EXPECT_TRUE(is_request(driver.message(1.2)));
}

// Kills parameters that are sent again while the head finds its centre.
TEST(MicronDriver, LeavesTheHeadTenSecondsToFindItsCentre) {
  MicronDriver driver({.timeout_s = 0.5});
  driver.message(0.0);
  driver.take(kAliveWithoutParameters);
  driver.message(0.0);
  driver.take(user_data(264, 1));
  ASSERT_EQ(seanet_message(*driver.message(20.0)), SeanetMessage::kHeadCommand);
  for (double now_s = 20.0; now_s < 30.0; now_s += 1.0) {
    driver.take(kAliveWithoutParameters);
    EXPECT_FALSE(driver.message(now_s)) << now_s;
  }
  EXPECT_EQ(driver.unanswered(), 0U);
  const auto again = driver.message(30.0);
  ASSERT_TRUE(again);
  EXPECT_EQ(seanet_message(*again), SeanetMessage::kHeadCommand);
  EXPECT_EQ(driver.unanswered(), 1U);
}

// Kills a pulse that does not grow with the range, or is longer or shorter than heads take.
TEST(MicronDriver, SendsAPulseAsLongAsTheRangeAsks) {
  struct Case {
    double range_m;
    int pulse_us;
  };
  for (const auto& [range_m, pulse_us] :
       {Case{0.5, 37}, Case{2.0, 37}, Case{10.0, 50}, Case{30.0, 100}, Case{75.0, 212}, Case{300.0, 350}}) {
    MicronDriver driver({.range_m = range_m});
    driver.message(0.0);
    driver.take(kAliveWithoutParameters);
    driver.message(0.0);
    driver.take(user_data(264, 1));
    const auto command = driver.message(0.0);
    ASSERT_TRUE(command);
    const auto parameters = micron_command_in(seanet_payload(*command));
    ASSERT_TRUE(parameters);
    EXPECT_EQ(parameters->pulse_us, pulse_us) << range_m;
    EXPECT_EQ(parameters->range_dm, 10.0 * range_m) << range_m;
  }
}

// Kills a head that never gets its parameters since it was ready, with older ones, before they were sent.
TEST(MicronDriver, AHeadThatSaysThatItIsReadyBeforeItWasConfiguredIsConfigured) {
  MicronDriver driver({});
  driver.message(0.0);
  driver.take(kAliveReady);
  driver.message(0.0);
  driver.take(user_data(264, 1));
  driver.take(kAliveReady);  // in the same read
  const auto command = driver.message(0.1);
  ASSERT_TRUE(command);
  EXPECT_TRUE(micron_command_in(seanet_payload(*command)));
  driver.take(kAliveReady);
  EXPECT_TRUE(is_request(driver.message(0.2)));
}

// Kills a request for each line of a head that answers with two: they would pile up in it.
TEST(MicronDriver, AsksAfterTheSecondLineOfAHeadThatSendsTwo) {
  MicronDriver driver = scanning({}, user_data(175, 0));
  ASSERT_TRUE(is_request(driver.message(1.0)));
  driver.take(kLine);
  EXPECT_FALSE(driver.message(1.0));
  driver.take(kLine);
  EXPECT_TRUE(is_request(driver.message(1.0)));
}

TEST(MicronDriver, GoesOnWithoutUserDataAndTakesNoEchoOfItsOwnMessages) {
  MicronDriver driver({});
  driver.message(0.0);
  driver.take(kSendVersion);
  driver.take(kLine);
  EXPECT_FALSE(driver.message(0.5));
  driver.take(kAliveWithoutParameters);
  EXPECT_EQ(driver.message(0.5), kSendUserData);
  const auto command = driver.message(2.0);
  ASSERT_TRUE(command);
  EXPECT_EQ(seanet_message(*command), SeanetMessage::kHeadCommand);
  EXPECT_EQ(driver.unanswered(), 0U);
}

TEST(MicronDriver, ConfiguresAHeadAgainThatRestartedOrLostItsStep) {
  MicronDriver driver = scanning({}, user_data(264, 1));
  ASSERT_TRUE(is_request(driver.message(1.0)));
  driver.take(kAliveWithoutParameters);
  EXPECT_FALSE(driver.is_connected());
  auto command = driver.message(1.0);
  ASSERT_TRUE(command);
  EXPECT_EQ(seanet_message(*command), SeanetMessage::kHeadCommand);
  driver.take(kAliveReady);
  ASSERT_TRUE(is_request(driver.message(2.0)));
  Bytes lost_step = kLine;
  lost_step[16] |= 2;
  driver.take(lost_step);
  command = driver.message(2.0);
  ASSERT_TRUE(command);
  EXPECT_EQ(seanet_message(*command), SeanetMessage::kHeadCommand);
}

TEST(MicronDriver, RepeatsWhatIsNotAnsweredAndGivesUpAfterThree) {
  MicronDriver driver = scanning({.timeout_s = 1.0}, user_data(264, 1));
  ASSERT_TRUE(is_request(driver.message(1.0)));
  EXPECT_FALSE(driver.message(1.9));
  for (const double now_s : {2.0, 3.0, 4.0}) {
    EXPECT_FALSE(driver.is_lost());
    EXPECT_TRUE(is_request(driver.message(now_s)));
  }
  EXPECT_TRUE(driver.is_lost());
  EXPECT_EQ(driver.unanswered(), 3U);
  driver.connect();
  EXPECT_FALSE(driver.is_lost());
  EXPECT_EQ(driver.message(5.0), kSendVersion);
}

/// Intensities that tell the bearing.
Bytes hear_bearing(int bearing, std::size_t bins, double) {
  Bytes heard(bins, 7);
  heard[0] = static_cast<std::uint8_t>(bearing & 255);
  heard[1] = '@';
  return heard;
}

/// The bearings of the first lines that an emulator sends to a driver.
std::vector<int> bearings_of(const MicronSettings& settings, const HeadEmulatorOptions& options, std::size_t count) {
  MicronDriver driver(settings);
  MicronEmulator head(options, hear_bearing);
  FrameFinder finder(check_seanet_frame);
  std::vector<int> bearings;
  double now_s = 0.0;
  for (int i = 0; i < 20'000 && bearings.size() < count; ++i) {
    if (const auto message = driver.message(now_s)) head.take(*message, now_s);
    now_s = std::max(now_s, std::min(driver.due_s(), head.due_s()));
    finder.push(head.send(now_s));
    while (const auto frame = finder.next()) {
      if (const auto line = seanet_line(frame->bytes)) bearings.push_back(line->bearing);
      driver.take(frame->bytes);
    }
    if (driver.is_lost()) driver.connect();
  }
  return bearings;
}

TEST(MicronEmulator, SendsTheLineOfOtherDrivers) {
  MicronEmulator head({}, [](int bearing, std::size_t bins, double bin_length_m) {
    EXPECT_EQ(bearing, 3216);
    EXPECT_EQ(bins, 6U);
    EXPECT_NEAR(bin_length_m, 0.99984, 1e-9);
    return Bytes{0, 10, 13, 64, 255, 9};
  });
  const MicronCommand command{.range_dm = 60, .left = 2400, .right = 4000, .interval_640ns = 2083, .bins = 6};
  head.take(frame_of(command), 0.0);
  EXPECT_EQ(seanet_message(head.send(0.5)), SeanetMessage::kAlive);
  head.take(make_seanet_frame(SeanetMessage::kSendData, SeanetSender::kHost, Bytes(4)), 0.6);
  EXPECT_EQ(head.send(0.65), kLine);
}

TEST(MicronEmulator, TurnsAroundAtTheEndsOfASectorAndWrapsInFullTurns) {
  EXPECT_THAT(bearings_of({.step = 100, .sector = {{.left = 6300, .right = 100}}}, {}, 6),
              ElementsAre(0, 100, 0, 6300, 0, 100));
  const std::vector<int> turn = bearings_of({.step = 200}, {.lines_per_request = 2}, 18);
  ASSERT_EQ(turn.size(), 18U);
  EXPECT_EQ(turn[0], 3400);
  EXPECT_EQ(turn[14], 6200);
  EXPECT_EQ(turn[16], 200);
}

TEST(SeanetRecorder, WritesWhatReadersReadAndOverwritesNothing) {
  const Folder folder;
  const std::string path = folder.path("dive.csv");
  constexpr std::uint64_t kDay_ms = 86'400'000;
  Result<SeanetRecorder> recorder = SeanetRecorder::create(path);
  ASSERT_TRUE(recorder);
  // A head that takes its time before it scans.
  for (std::uint64_t i = 0; i < 2000; ++i) ASSERT_TRUE(recorder->append(i, kAliveReady));
  for (const std::uint64_t time_ms : {std::uint64_t{2140}, kDay_ms - 1, 40 * kDay_ms + 59'999}) {
    ASSERT_TRUE(recorder->append(time_ms, kLine));
  }
  const std::vector<Beam> beams = beams_in(path);
  ASSERT_EQ(beams.size(), 3U);
  EXPECT_EQ(beams[0].time_s, 2.14);
  EXPECT_EQ(beams[1].time_s, recorded_time_s(kDay_ms - 1));
  EXPECT_EQ(beams[2].time_s, recorded_time_s(40 * kDay_ms + 59'999));
  EXPECT_NEAR(beams[0].bearing_rad, 359.1 * kDegree_rad, 1e-12);
  EXPECT_EQ(beams[0].intensities, (Bytes{0, 10, 13, 64, 255, 9}));
  EXPECT_FALSE(SeanetRecorder::create(path));

  Result<SeanetRecorder> dated = SeanetRecorder::create(folder.path("dated.csv"), 1'795'456'426'123);
  ASSERT_TRUE(dated);
  ASSERT_TRUE(dated->append(2140, kLine));
  const std::vector<Beam> later = beams_in(folder.path("dated.csv"));
  ASSERT_EQ(later.size(), 1U);
  EXPECT_NEAR(later[0].time_s, 1'795'456'428.263, 1e-6);
}

class MicronOverALine : public testing::TestWithParam<const char*> {};

// The bytes decide: beams and their times are those of the recording, however they were cut into reads, whatever the
// line does to single bytes, and though the head restarts.
TEST_P(MicronOverALine, TheRecordingHasTheBeamsOfTheLiveSource) {
  const Folder folder;
  Result<Link> line = Link::listen(GetParam());
  ASSERT_TRUE(line) << line.error().message;
  Result<SeanetRecorder> recorder = SeanetRecorder::create(folder.path("dive.csv"));
  ASSERT_TRUE(recorder);
  MicronEmulator head({.lost = 2e-4, .doubled = 2e-4, .damaged = 2e-4, .stall_every = 20}, hear_bearing);
  double now_s = 5.0;
  const auto source = micron_source(line->address(), {.range_m = 10.0, .timeout_s = 1.0}, std::move(*recorder), now_s);
  std::vector<Beam> beams;
  run(*source, *line, head, now_s, beams, 60);
  ASSERT_GE(beams.size(), 60U);
  source->finish(beams);
  EXPECT_GT(source->status().damaged, 0U);
  EXPECT_GT(source->status().unanswered, 0U);
  EXPECT_GE(source->status().connections, 3U) << "each restart asks for parameters";
  for (const Beam& beam : beams) EXPECT_EQ(beam.intensities.size(), 393U);
  expect_equal(beams, beams_in(folder.path("dive.csv")));
}

INSTANTIATE_TEST_SUITE_P(Device, MicronOverALine, testing::Values("udp://127.0.0.1:0", "tcp://127.0.0.1:0", "pty"),
                         [](const auto& line) { return line.index == 0   ? "Udp"
                                                       : line.index == 1 ? "Tcp"
                                                                         : "Pty"; });

TEST(MicronSource, DrivesTheHeadInAnotherWayAfterTheLinesThatItWasAskedFor) {
  Result<Link> line = Link::listen("udp://127.0.0.1:0");
  ASSERT_TRUE(line);
  double now_s = 0.0;
  const auto source = micron_source(line->address(), {.range_m = 10.0, .timeout_s = 1.0}, std::nullopt, now_s);
  MicronEmulator head({.pings_per_s = 25.0}, hear_bearing);
  std::vector<Beam> beams;
  run(*source, *line, head, now_s, beams, 5);
  ASSERT_TRUE(source->drive(MicronSettings{.range_m = 5.0, .timeout_s = 1.0}));
  EXPECT_FALSE(source->drive(Ping360Settings{})) << "of another head";
  run(*source, *line, head, now_s, beams, 12);
  ASSERT_GE(beams.size(), 12U);
  EXPECT_EQ(source->status().unexpected, 0U);
  const auto range_m = [](const Beam& beam) {
    return static_cast<double>(beam.intensities.size()) * beam.bin_length_m;
  };
  EXPECT_NEAR(range_m(beams.front()), 10.0, 0.5);
  EXPECT_NEAR(range_m(beams.back()), 5.0, 0.5);
  EXPECT_FALSE(source->is_recording());
}

TEST(MicronSource, FindsTheHeadAgainAHundredTimes) {
  const Folder folder;
  Result<Link> line = Link::listen("udp://127.0.0.1:0");
  ASSERT_TRUE(line);
  Result<SeanetRecorder> recorder = SeanetRecorder::create(folder.path("dive.csv"));
  ASSERT_TRUE(recorder);
  double now_s = 0.0;
  const auto source = micron_source(line->address(), {.range_m = 0.5, .timeout_s = 1.0}, std::move(*recorder), now_s);
  std::vector<Beam> beams;
  expect_found_again(*source, line, [] { return MicronEmulator({.pings_per_s = 1000.0}, hear_bearing); }, now_s, beams);
  source->finish(beams);
  expect_equal(beams, beams_in(folder.path("dive.csv")));
}

}  // namespace
}  // namespace pingvox::test
