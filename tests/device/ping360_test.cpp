#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "device/internal/link.hpp"
#include "device/internal/live_source.hpp"
#include "device/internal/ping360_emulator.hpp"
#include "device/ping360_driver.hpp"
#include "io/internal/ping_frame.hpp"
#include "io/internal/ping_viewer_recorder.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "tests/device/dialogue.hpp"
#include "tests/device/recording.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using namespace test;

/// Intensities that tell the angle.
std::vector<std::uint8_t> hear_angle(int angle_grad, std::size_t bins, double) {
  std::vector<std::uint8_t> heard(bins, 7);
  heard[0] = static_cast<std::uint8_t>(angle_grad & 255);
  heard[1] = 'B';
  heard[2] = 'R';
  return heard;
}

/// The angle that a request is for; nullopt: it is for something else.
std::optional<int> asked_angle(const std::optional<std::vector<std::uint8_t>>& message) {
  if (!message || ping_message(*message) != PingMessage::kTransducer) return std::nullopt;
  const auto payload = ping_payload(*message);
  return payload[2] | (payload[3] << 8);
}

std::vector<std::uint8_t> information() {
  constexpr std::array<std::uint8_t, 6> kInformation = {2, 0x43, 3, 1, 1, 0};
  return make_ping_frame(PingMessage::kDeviceInformation, 2, 0, kInformation);
}

std::vector<std::uint8_t> answer_of(int angle_grad) {
  std::vector<std::uint8_t> payload(14, 0);
  payload[2] = static_cast<std::uint8_t>(angle_grad & 255);
  payload[3] = static_cast<std::uint8_t>(angle_grad >> 8);
  return make_ping_frame(PingMessage::kDeviceData, 2, 0, payload);
}

// The settings of Ping Viewer in its logs.
TEST(Ping360Sampling, IsThatOfPingViewer) {
  struct Case {
    double range_m;
    int samples, period, transmit_us;
  };
  for (const Case& c : {Case{1, 666, 80, 5}, Case{2, 1200, 88, 11}, Case{15, 1200, 666, 80}, Case{30, 1200, 1333, 160},
                        Case{50, 1200, 2222, 267}, Case{60, 1200, 2666, 320}}) {
    const Ping360Sampling sampling = ping360_sampling(c.range_m);
    EXPECT_EQ(sampling.samples, c.samples) << c.range_m;
    EXPECT_EQ(sampling.period_25ns, c.period) << c.range_m;
    EXPECT_EQ(sampling.transmit_us, c.transmit_us) << c.range_m;
  }
}

TEST(Ping360Driver, RepeatsWhatIsNotAnsweredAndGivesUpAfterThree) {
  Ping360Driver driver({.timeout_s = 1.0});
  ASSERT_TRUE(driver.message(0.0));
  driver.take(information());
  ASSERT_EQ(asked_angle(driver.message(0.1)), 0);
  EXPECT_FALSE(driver.message(1.0));
  EXPECT_EQ(asked_angle(driver.message(1.1)), 0) << "the same angle again";
  EXPECT_EQ(driver.unanswered(), 1U);
  driver.take(answer_of(0));
  ASSERT_EQ(asked_angle(driver.message(1.2)), 1);
  for (const double now_s : {2.2, 3.2, 4.2}) {
    EXPECT_FALSE(driver.is_lost());
    driver.message(now_s);
  }
  EXPECT_TRUE(driver.is_lost());
}

// Kills a head that is taken for silent where it says what is wrong.
TEST(Ping360Driver, SaysWhyTheHeadRefuses) {
  Ping360Driver driver({.timeout_s = 1.0});
  driver.message(0.0);
  EXPECT_EQ(driver.problem(), "no answer");
  driver.take(information());
  driver.message(0.0);
  constexpr std::string_view kRefused = "\x29\x0atransmit\x1b too long";
  const std::vector<std::uint8_t> payload(kRefused.begin(), kRefused.end());
  driver.take(make_ping_frame(PingMessage::kNack, 2, 0, payload));
  EXPECT_EQ(driver.problem(), "refused: transmit too long");
  driver.take(make_ping_frame(PingMessage::kNack, 2, 0, {}));
  EXPECT_EQ(driver.problem(), "refused: without a reason");
  driver.take(answer_of(0));
  EXPECT_EQ(driver.problem(), "no answer");
}

// A line that doubles an answer must not make the head skip an angle.
TEST(Ping360Driver, TakesOnlyTheAnswerThatItWaitsFor) {
  Ping360Driver driver({});
  driver.message(0.0);
  driver.take(answer_of(0));
  EXPECT_FALSE(driver.is_connected()) << "not yet known to be a Ping360";
  driver.take(information());
  ASSERT_EQ(asked_angle(driver.message(0.0)), 0);
  driver.take(answer_of(0));
  ASSERT_EQ(asked_angle(driver.message(0.0)), 1);
  driver.take(answer_of(0));
  driver.take(information());
  EXPECT_FALSE(driver.message(0.0));
}

std::vector<int> angles_of(const Ping360Settings& settings, int count) {
  Ping360Driver driver(settings);
  driver.message(0.0);
  driver.take(information());
  std::vector<int> angles;
  for (int i = 0; i < count; ++i) {
    angles.push_back(asked_angle(driver.message(0.0)).value_or(-1));
    driver.take(answer_of(angles.back()));
  }
  return angles;
}

TEST(Ping360Driver, TurnsAroundAtTheEndsOfASectorAndWrapsInFullTurns) {
  EXPECT_THAT(angles_of({.step_grad = 10, .sector = {{.first_grad = 390, .width_grad = 25}}}, 7),
              ElementsAre(390, 0, 10, 0, 390, 0, 10));
  EXPECT_THAT(angles_of({.step_grad = 9, .sector = {{.first_grad = 5, .width_grad = 3}}}, 3), ElementsAre(5, 5, 5));
  const std::vector<int> turn = angles_of({.step_grad = 20}, 22);
  EXPECT_EQ(turn[19], 380);
  EXPECT_EQ(turn[20], 0);
}

// Kills a head that turns around a step before the end of its sector.
TEST(Ping360Driver, PingsBothEndsOfASector) {
  constexpr int kFirst_grad = 390, kTurn = 400;
  for (const int step_grad : {1, 3, 20}) {
    for (const int steps : {1, 2, 7}) {
      SCOPED_TRACE(testing::Message() << steps << " steps of " << step_grad);
      Ping360Settings settings;
      settings.step_grad = step_grad;
      settings.sector = Ping360Settings::Sector{.first_grad = kFirst_grad, .width_grad = steps * step_grad};
      int nearest_grad = kTurn, farthest_grad = 0;
      for (const int angle_grad : angles_of(settings, 4 * steps)) {
        const int place_grad = (angle_grad - kFirst_grad + kTurn) % kTurn;
        nearest_grad = std::min(nearest_grad, place_grad);
        farthest_grad = std::max(farthest_grad, place_grad);
      }
      EXPECT_EQ(nearest_grad, 0);
      EXPECT_EQ(farthest_grad, steps * step_grad);
    }
  }
}

// Virtual time and no line: 300 pings in order, whatever the line does to single bytes.
TEST(Ping360Driver, GetsEachPingOverALineThatLosesDoublesAndDamagesBytes) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    Ping360Driver driver({.range_m = 1.0, .timeout_s = 1.0});
    Ping360Emulator head({.lost = 2e-4, .doubled = 2e-4, .damaged = 2e-4, .seed = seed}, hear_angle);
    FrameFinder finder(check_ping_frame);
    std::vector<int> angles;
    double now_s = 0.0;
    for (int i = 0; i < 10'000 && angles.size() < 300; ++i) {
      if (const auto message = driver.message(now_s)) head.take(*message, now_s);
      now_s = std::min(driver.due_s(), std::max(now_s, head.due_s()));
      finder.push(head.send(now_s));
      while (const auto frame = finder.next()) {
        const std::optional<Ping360Ping> ping = ping360_ping(frame->bytes);
        if (ping) {
          EXPECT_EQ(ping->data[0], ping->angle_grad & 255) << "a damaged ping was taken";
        }
        if (ping && (angles.empty() || angles.back() != ping->angle_grad)) angles.push_back(ping->angle_grad);
        driver.take(frame->bytes);
      }
      if (driver.is_lost()) driver.connect();
    }
    ASSERT_EQ(angles.size(), 300U);
    for (std::size_t i = 0; i < angles.size(); ++i) EXPECT_EQ(angles[i], static_cast<int>(i));
    EXPECT_GT(driver.unanswered(), 0U);
  }
}

/// What a host sends to scan from one angle to another, with 8 samples.
std::vector<std::uint8_t> scan_request(int start_grad, int stop_grad, int step_grad) {
  std::vector<std::uint8_t> payload = {1, 1, 11, 0, 88, 0, 0xee, 2, 8, 0};
  for (const int angle : {start_grad, stop_grad}) {
    payload.push_back(static_cast<std::uint8_t>(angle & 255));
    payload.push_back(static_cast<std::uint8_t>(angle >> 8));
  }
  payload.push_back(static_cast<std::uint8_t>(step_grad));
  payload.push_back(0);
  return make_ping_frame(PingMessage::kAutoTransmit, 0, 2, payload);
}

/// The pings of a scan, recorded and read.
std::vector<Beam> scanned(int start_grad, int stop_grad, int step_grad, int pings) {
  const Folder folder;
  Ping360Emulator head({}, hear_angle);
  Result<PingViewerRecorder> recorder = PingViewerRecorder::create(folder.path("scan.bin"));
  EXPECT_TRUE(recorder);
  head.take(scan_request(start_grad, stop_grad, step_grad), 0.0);
  for (int i = 0; i < pings; ++i) {
    const double now_s = head.due_s();
    EXPECT_TRUE(recorder->append(static_cast<std::uint64_t>(std::lround(now_s * 1e3)), head.send(now_s)));
  }
  return beams_in(folder.path("scan.bin"));
}

// By the layout in docs/formats.md: texts are their length in bytes and UTF-16, numbers are big-endian.
TEST(PingViewerRecorder, BeginsWithTheHeaderOfAPing360) {
  const Folder folder;
  ASSERT_TRUE(PingViewerRecorder::create(folder.path("dive.bin")));
  std::ifstream in(folder.path("dive.bin"), std::ios::binary);
  const auto number = [&in] {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) value = value << 8U | static_cast<std::uint32_t>(in.get());
    return value;
  };
  const auto text = [&in, &number] {
    const std::uint32_t bytes = number();
    std::string letters;
    for (std::uint32_t i = 0; i < bytes && bytes != 0xffffffffU; ++i) {
      const int byte = in.get();
      if (i % 2 == 1) letters.push_back(static_cast<char>(byte));
    }
    return letters;
  };
  EXPECT_EQ(text(), "PingViewer sensor log file");
  EXPECT_EQ(number(), 1U) << "version";
  for (int i = 0; i < 5; ++i) text();
  EXPECT_EQ(number(), 1U) << "family: Ping";
  EXPECT_EQ(number(), 2U) << "type: Ping360";
  EXPECT_EQ(in.get(), std::ifstream::traits_type::eof());
}

int angle_of(const Beam& beam) {
  return (600 - static_cast<int>(std::lround(beam.bearing_rad / std::numbers::pi * 200.0))) % 400;
}

struct Steps {
  std::size_t skipped = 0, repeated = 0, turns = 0;
};

/// How the head went, by the angles of its beams.
Steps steps_of(const std::vector<Beam>& beams, int step_grad) {
  Steps steps;
  int before = 0;
  for (std::size_t i = 1; i < beams.size(); ++i) {
    const int by = (angle_of(beams[i]) - angle_of(beams[i - 1]) + 600) % 400 - 200;
    if (std::abs(by) == 2 * step_grad) ++steps.skipped;
    if (by == 0) ++steps.repeated;
    if (by * before < 0) ++steps.turns;
    if (by != 0) before = by;
  }
  return steps;
}

// The head's own scan leaves angles out and goes too far: no sweep may end or go on for that.
TEST(Ping360Emulator, ScansOfAHeadThatSkipsAndOvershootsGiveWholeSweeps) {
  constexpr int kPings = 4000;
  const auto sector = scanned(150, 250, 2, kPings);
  ASSERT_EQ(sector.size(), static_cast<std::size_t>(kPings));
  const Steps to_and_fro = steps_of(sector, 2);
  EXPECT_GT(to_and_fro.skipped, 20U);
  const auto [first, last] = std::ranges::minmax(sector, {}, angle_of);
  EXPECT_EQ(angle_of(first), 148) << "a step before the start";
  EXPECT_EQ(angle_of(last), 252) << "a step beyond the end";
  const std::vector<Sweep> passes = sweeps_of(sector);
  EXPECT_EQ(passes.size(), to_and_fro.turns + 1);
  EXPECT_GT(passes.size(), 70U);
  for (std::size_t i = 0; i + 1 < passes.size(); ++i) EXPECT_EQ(passes[i].extent, Sweep::Extent::kSector) << i;

  const auto circle = scanned(0, 399, 1, kPings);
  const Steps around = steps_of(circle, 1);
  EXPECT_GT(around.skipped, 20U);
  EXPECT_GT(around.repeated, 0U) << "beyond the end is the start";
  EXPECT_EQ(around.turns, 0U);
  const std::vector<Sweep> turns = sweeps_of(circle);
  EXPECT_EQ(turns.size(), 11U);
  for (std::size_t i = 0; i + 1 < turns.size(); ++i) EXPECT_EQ(turns[i].extent, Sweep::Extent::kTurn) << i;

  // Wider than half a turn it flies back.
  const std::vector<Sweep> wide = sweeps_of(scanned(350, 250, 5, kPings));
  EXPECT_GT(wide.size(), 60U);
  for (std::size_t i = 0; i + 1 < wide.size(); ++i) {
    EXPECT_EQ(wide[i].extent, Sweep::Extent::kSector) << i;
    EXPECT_EQ(angle_of(wide[i].beams.front()), 350) << i;
  }
}

TEST(Ping360Emulator, ScansUntilMotorOff) {
  Ping360Emulator head({.pings_per_s = 10.0}, hear_angle);
  head.take(scan_request(10, 20, 11), 0.0);
  EXPECT_TRUE(std::isfinite(head.due_s()));
  EXPECT_EQ(ping_message(head.send(head.due_s())), PingMessage::kNack) << "a step of 11";
  EXPECT_TRUE(std::isinf(head.due_s()));
  head.take(scan_request(10, 10, 5), 1.0);
  for (int i = 1; i <= 3; ++i) {
    EXPECT_NEAR(head.due_s(), 1.0 + 0.1 * i, 1e-9);
    const auto frame = head.send(head.due_s());
    EXPECT_EQ(ping_message(frame), PingMessage::kAutoDeviceData);
    EXPECT_EQ(ping360_ping(frame)->angle_grad, 10) << "a sector without a width";
    EXPECT_EQ(ping360_ping(frame)->samples, 8);
    EXPECT_EQ(ping360_ping(frame)->period_25ns, 88);
  }
  head.take(Ping360Driver::motor_off(), 1.35);
  EXPECT_EQ(ping_message(head.send(1.35)), PingMessage::kAck);
  EXPECT_TRUE(std::isinf(head.due_s()));
}

TEST(PingViewerRecorder, WritesWhatReadersReadAndOverwritesNothing) {
  const Folder folder;
  const std::string path = folder.path("dive.bin");
  constexpr std::uint64_t kDay_ms = 86'400'000;
  const auto payload = [](int angle) {
    std::vector<std::uint8_t> bytes(14, 0);
    bytes[2] = static_cast<std::uint8_t>(angle);
    bytes[6] = 88;
    bytes[12] = 1;
    bytes.push_back(200);
    return make_ping_frame(PingMessage::kDeviceData, 2, 0, bytes);
  };
  Result<PingViewerRecorder> recorder = PingViewerRecorder::create(path);
  ASSERT_TRUE(recorder);
  for (const std::uint64_t time_ms : {std::uint64_t{2140}, kDay_ms - 1, kDay_ms + 59'999}) {
    ASSERT_TRUE(recorder->append(time_ms, payload(3)));
  }
  const std::vector<Beam> beams = beams_in(path);
  ASSERT_EQ(beams.size(), 3U);
  EXPECT_EQ(beams[0].time_s, recorded_time_s(2140));
  EXPECT_EQ(beams[0].time_s, 2.14);
  EXPECT_EQ(beams[1].time_s, recorded_time_s(kDay_ms - 1));
  EXPECT_EQ(beams[2].time_s, recorded_time_s(kDay_ms + 59'999));

  // 2026-11-23 17:53:46.123 UTC.
  Result<PingViewerRecorder> dated = PingViewerRecorder::create(folder.path("dated.bin"), 1'795'456'426'123);
  ASSERT_TRUE(dated);
  for (const std::uint64_t time_ms : {kDay_ms - 1, kDay_ms + 59'999}) ASSERT_TRUE(dated->append(time_ms, payload(3)));
  const std::vector<Beam> later = beams_in(folder.path("dated.bin"));
  ASSERT_EQ(later.size(), 2U);
  EXPECT_NEAR(later[0].time_s, 1'795'542'826.122, 1e-6);
  EXPECT_NEAR(later[1].time_s, 1'795'542'886.122, 1e-6);

  const Result<PingViewerRecorder> again = PingViewerRecorder::create(path);
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().message, HasSubstr(path));
}

bool is_of_scan(const Beam& beam) {
  return beam.intensities.size() == 8;  // scan_request's
}

/// A source at a line of a kind, whose other end the test has.
class OverALine : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    line_ = Link::listen(GetParam());
    ASSERT_TRUE(line_) << line_.error().message;
    Result<PingViewerRecorder> recorder = PingViewerRecorder::create(folder_.path("dive.bin"));
    ASSERT_TRUE(recorder);
    source_ = ping360_source(line_->address(), {.range_m = 1.0, .timeout_s = 1.0}, std::move(*recorder), now_s_);
  }
  void run_until(std::size_t count, Ping360Emulator& head) { run(*source_, *line_, head, now_s_, beams_, count); }
  /// The bytes decide: beams and their times are those of the recording, however they were cut into reads. Only pings
  /// of a scan, which were not asked for, are left out.
  /// @return how many these were
  std::size_t expect_equal_recording() {
    source_->finish(beams_);
    std::vector<Beam> recorded = beams_in(folder_.path("dive.bin"));
    const std::size_t left_out = std::erase_if(recorded, is_of_scan);
    expect_equal(beams_, recorded);
    EXPECT_EQ(source_->status().unexpected, left_out);
    return left_out;
  }

  const Folder folder_;
  double now_s_ = 5.0;
  Result<Link> line_ = fail(Error::Code::kIo, "not open");
  std::unique_ptr<LiveSource> source_;
  std::vector<Beam> beams_;
};

TEST_P(OverALine, TheRecordingHasTheBeamsOfTheLiveSource) {
  Ping360Emulator head({.lost = 2e-4, .doubled = 2e-4, .damaged = 2e-4}, hear_angle);
  run_until(40, head);
  ASSERT_GE(beams_.size(), 40U);
  expect_equal_recording();
  EXPECT_GT(source_->status().damaged, 0U);
}

// Kills a driver that leaves a head scanning, as another host may have left it.
TEST_P(OverALine, AHeadThatWasLeftScanningIsStopped) {
  Ping360Emulator head({}, hear_angle);
  head.take(scan_request(200, 300, 1), now_s_);
  run_until(60, head);
  EXPECT_LE(expect_equal_recording(), 10U);
}

// Another host makes it scan: its pings come between those that are asked for, with another range.
TEST_P(OverALine, AHeadThatScansByItselfAnswersAllTheSame) {
  Ping360Emulator head({}, hear_angle);
  run_until(5, head);
  head.take(scan_request(200, 300, 1), now_s_);
  run_until(60, head);
  EXPECT_GT(expect_equal_recording(), 10U);
  EXPECT_EQ(source_->status().first_unexpected, "a ping requested by another host");
}

INSTANTIATE_TEST_SUITE_P(Device, OverALine, testing::Values("udp://127.0.0.1:0", "pty"),
                         [](const auto& line) { return line.index == 0 ? "Udp" : "Pty"; });

// One damaged or lost byte cost the whole timeout, in which the head may have to turn.
TEST(Ping360Source, AsksAgainSoonWhereAnAnswerIsDamaged) {
  const auto seconds_of = [](const HeadEmulatorOptions& line_of_head) {
    Result<Link> line = Link::listen("udp://127.0.0.1:0");
    EXPECT_TRUE(line);
    double now_s = 0.0;
    const auto source = ping360_source(line->address(), {.range_m = 4.0, .timeout_s = 4.0}, std::nullopt, now_s);
    Ping360Emulator head(line_of_head, hear_angle);
    std::vector<Beam> beams;
    run(*source, *line, head, now_s, beams, 200);
    EXPECT_EQ(beams.size(), 200U);
    EXPECT_EQ(source->status().damaged > 0, line_of_head.damaged + line_of_head.lost > 0.0);
    return now_s;
  };
  const double clean_s = seconds_of({});
  EXPECT_LT(seconds_of({.damaged = 1e-4}), 1.4 * clean_s);
  EXPECT_LT(seconds_of({.lost = 1e-4}), 1.8 * clean_s);
}

TEST(Ping360Source, FindsTheHeadAgainAHundredTimes) {
  const Folder folder;
  Result<Link> line = Link::listen("udp://127.0.0.1:0");
  ASSERT_TRUE(line);
  Result<PingViewerRecorder> recorder = PingViewerRecorder::create(folder.path("dive.bin"));
  ASSERT_TRUE(recorder);
  double now_s = 0.0;
  const auto source = ping360_source(line->address(), {.range_m = 0.5, .timeout_s = 1.0}, std::move(*recorder), now_s);
  std::vector<Beam> beams;
  expect_found_again(*source, line, [] { return Ping360Emulator({.pings_per_s = 1000.0}, hear_angle); }, now_s, beams);
  source->finish(beams);
  expect_equal(beams, beams_in(folder.path("dive.bin")));
}

TEST(ReplaySource, KeepsTheRhythmOfTheLogAtItsSpeed) {
  std::vector<Beam> log;
  for (const double time_s : {100.0, 100.5, 102.0, 90.0, 90.5, 5000.0}) log.push_back({time_s, 0.0, 0.1, {1, 2}});
  const auto source = replay_source(std::make_unique<BeamsInMemory>(log), 2.0);
  std::vector<Beam> beams;
  std::vector<double> heard_s;
  double now_s = 10.0;
  for (int i = 0; i < 100; ++i) {
    const Result<bool> goes_on = source->step(now_s, beams);
    ASSERT_TRUE(goes_on);
    if (!*goes_on) break;
    while (heard_s.size() < beams.size()) heard_s.push_back(now_s);
    if (std::isfinite(source->due_s())) now_s = std::max(now_s, source->due_s());
  }
  EXPECT_THAT(heard_s, ElementsAre(10.0, 10.25, 11.0, 11.0, 11.25, 11.25));
}

// Kills a replay that sleeps where the recording was paused, or that hurries through what was heard.
TEST(ReplaySource, WaitsForAMinuteAtMost) {
  for (const double speed : {1.0, 4.0, 0.5}) {
    for (const double step_s : {0.04, 1.0, 59.0, 61.0, 300.0, 1e6}) {
      SCOPED_TRACE(testing::Message() << step_s << " s at speed " << speed);
      const std::vector<Beam> log = {{1000.0, 0.0, 0.1, {1, 2}}, {1000.0 + step_s, 0.0, 0.1, {1, 2}}};
      const auto source = replay_source(std::make_unique<BeamsInMemory>(log), speed);
      std::vector<Beam> beams;
      ASSERT_TRUE(source->step(5.0, beams));
      ASSERT_EQ(beams.size(), 1U);
      ASSERT_TRUE(source->step(5.0, beams));
      EXPECT_EQ(beams.size(), step_s > 60.0 ? 2U : 1U);
      if (step_s > 60.0) continue;
      EXPECT_NEAR(source->due_s(), 5.0 + step_s / speed, 1e-9);
    }
  }
}

TEST(Link, RefusesAddressesThatItDoesNotKnow) {
  for (const char* address :
       {"", "http://a:1", "tcp://a", "udp://", "udp://127.0.0.1", "udp://127.0.0.1:x", "udp://127.0.0.1:70000",
        "/dev/null@1", "/dev/null@115200x", "/dev/null@", "/dev/null@99999999999"}) {
    const Result<Link> link = Link::open(address);
    ASSERT_FALSE(link) << address;
    EXPECT_EQ(link.error().code, Error::Code::kBadOption) << address;
    EXPECT_EQ(Link::check(address).error().message, link.error().message);
  }
  for (const char* address : {"udp://a:1", "tcp://[::1]:9092", "/dev/ttyUSB0", "/dev/ttyUSB0@57600"}) {
    EXPECT_TRUE(Link::check(address)) << address;
  }
  const Result<Link> no_terminal = Link::open("/dev/null");
  ASSERT_FALSE(no_terminal);
  EXPECT_EQ(no_terminal.error().code, Error::Code::kIo);
}

}  // namespace
}  // namespace pingvox
