#include "io/nav/tlog.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "io/internal/mavlink.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/nav.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

// Records that a ground station wrote (BlueROV2, 2023-05-04).
constexpr std::string_view kTimedAttitude =
    "0005fae152744f08 fd1c0000ec01011e0000 53840a00 9c11c7bc 2b3eca3c a04516c0 1673bfbc 590e303c 070737ba 07ba";
constexpr std::string_view kPosition =
    "0005fae1527452f0 fd1c0000160101210000 c1840a00 ad23d71c 40e2b6b5 14000000 1c000000 0e00 0500 0700 1358 fdfc";
constexpr std::string_view kTimedPressure =
    "0005fae15272fb30 fd0e0000d70101890000 17840a00 33f37d44 00000000 dd04 f85f";

Result<NavFile> read_as_tlog(std::vector<std::uint8_t> bytes, Damage damage = Damage::kSkip) {
  return read_nav({"dive.tlog", std::move(bytes)}, damage);
}

std::vector<std::uint8_t> golden_tlog() {
  return from_hex(std::string(kTimedPressure) + std::string(kTimedAttitude) + std::string(kPosition));
}

const NavSource* source_of(const NavLog& log, std::string_view name, NavQuantity quantity) {
  for (const NavSource& source : log.sources()) {
    if (source.name == name && source.quantity == quantity) return &source;
  }
  return nullptr;
}

/// @param at_s  in units of 2^20 us after 2023-05-04
std::vector<std::uint8_t> record_at(std::uint8_t at_s, const std::vector<std::uint8_t>& frame) {
  std::vector<std::uint8_t> record = {0x00, 0x05, 0xfa, 0xe1, 0, static_cast<std::uint8_t>(at_s << 4U), 0, 0};
  record.insert(record.end(), frame.begin(), frame.end());
  return record;
}

/// A record with a DISTANCE_SENSOR of 1.5 m. @param boot_ms  0: the sender does not know its time
std::vector<std::uint8_t> distance_record(std::uint8_t at_s, std::uint16_t boot_ms, std::uint8_t id) {
  const std::vector<std::uint8_t> payload = {static_cast<std::uint8_t>(boot_ms & 0xffU),
                                             static_cast<std::uint8_t>(boot_ms >> 8U),
                                             0,
                                             0,
                                             20,
                                             0,
                                             0x10,
                                             0x27,
                                             150,
                                             0,
                                             4,
                                             id,
                                             25,
                                             0};
  return record_at(at_s, make_mavlink_frame(132, payload, {0, 1, 194}));
}

// Kills times that repeat the first one because the sender does not know its own.
TEST(Tlog, AMessageWithoutItsTimeIsOfTheTimeWhenItCame) {
  std::vector<std::uint8_t> log;
  for (const auto& [at_s, boot_ms] : {std::pair<std::uint8_t, std::uint16_t>{1, 1000}, {2, 0}, {3, 0}, {4, 4146}}) {
    const auto record = distance_record(at_s, boot_ms, 0);
    log.insert(log.end(), record.begin(), record.end());
  }
  const auto nav = read_as_tlog(log);
  ASSERT_TRUE(nav) << nav.error().message;
  const NavSource* range = source_of(nav->log, "DISTANCE_SENSOR 1/194", NavQuantity::kRange);
  ASSERT_NE(range, nullptr);
  ASSERT_EQ(range->samples.size(), 4U);
  for (std::size_t i = 1; i < 4; ++i) {
    const double since_first_s = range->samples[i].time_s - range->samples[0].time_s;
    EXPECT_NEAR(since_first_s, static_cast<double>(i) * 1.048576, 1e-3) << i;
  }
}

// Kills rangefinders that look ahead and down and are taken for one.
TEST(Tlog, RangefindersOfOneSenderAreSourcesOfTheirOwn) {
  std::vector<std::uint8_t> log = distance_record(1, 1000, 0);
  const auto other = distance_record(2, 2048, 2);
  log.insert(log.end(), other.begin(), other.end());
  const auto nav = read_as_tlog(log);
  ASSERT_TRUE(nav) << nav.error().message;
  EXPECT_EQ(nav->log.sources().size(), 2U);
  EXPECT_NE(source_of(nav->log, "DISTANCE_SENSOR 1/194", NavQuantity::kRange), nullptr);
  EXPECT_NE(source_of(nav->log, "DISTANCE_SENSOR[2] 1/194", NavQuantity::kRange), nullptr);
}

/// Appends a record with a LOCAL_POSITION_NED.
/// @param received_ms  after 2023-05-04
void add_position(std::vector<std::uint8_t>& log, std::uint64_t received_ms, std::uint8_t system, std::uint32_t boot_ms,
                  float north_m) {
  constexpr std::uint64_t kStart_us = 0x0005fae100000000;
  const std::uint64_t time_us = kStart_us + received_ms * 1000;
  for (unsigned shift = 64; shift > 0; shift -= 8) {
    log.push_back(static_cast<std::uint8_t>((time_us >> (shift - 8)) & 0xffU));
  }
  std::vector<std::uint8_t> payload;
  for (const std::uint32_t word : {boot_ms, std::bit_cast<std::uint32_t>(north_m), std::bit_cast<std::uint32_t>(1.0F),
                                   std::bit_cast<std::uint32_t>(1.0F), 0U, 0U, 0U}) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
      payload.push_back(static_cast<std::uint8_t>((word >> shift) & 0xffU));
    }
  }
  const auto frame = make_mavlink_frame(32, payload, {0, system, 1});
  log.insert(log.end(), frame.begin(), frame.end());
}

/// Of the one source of positions: how many are there, all of them beyond a place to the north or to the south of it.
void expect_positions(const NavFile& nav, std::size_t count, double north_m) {
  ASSERT_EQ(nav.log.sources().size(), 1U);
  const NavSource& source = nav.log.sources().front();
  EXPECT_EQ(source.samples.size(), count);
  for (const NavSample& sample : source.samples) EXPECT_NEAR(sample.value.y(), north_m, 1.0);
}

// The attitude of one vehicle was taken with the position of another one.
TEST(Tlog, OfSeveralVehiclesOneIsReadAndTheOthersAreNamed) {
  std::vector<std::uint8_t> log;
  for (std::uint32_t i = 0; i < 60; ++i) {
    if (i % 3 == 0) add_position(log, 1000 + 100 * i, 1, 5000 + 100 * i, 200.0F);
    add_position(log, 1050 + 100 * i, 2, 50'000 + 100 * i, 10.0F);
  }
  const auto nav = read_as_tlog(log, Damage::kFail);
  ASSERT_TRUE(nav) << nav.error().message;
  expect_positions(*nav, 60, 10.0);
  EXPECT_EQ(nav->records, 80U);
  ASSERT_EQ(nav->notes.size(), 1U);
  EXPECT_EQ(nav->notes.front(),
            "holds several vehicles: system 2 (60 messages) is read, left out: system 1 (20 messages)");
}

// Two vehicles that are both system 1 gave walls 100 m apart, without a word.
TEST(Tlog, OfVehiclesWithTheSameAddressOneIsRead) {
  std::vector<std::uint8_t> log;
  for (std::uint32_t i = 0; i < 60; ++i) {
    add_position(log, 1000 + 100 * i, 1, 500'000 + 100 * i, 200.0F);
    if (i % 2 == 0) add_position(log, 1050 + 100 * i, 1, 50'000 + 100 * i, 100.0F);
  }
  const auto nav = read_as_tlog(log, Damage::kFail);
  ASSERT_TRUE(nav) << nav.error().message;
  expect_positions(*nav, 60, 200.0);
  ASSERT_EQ(nav->notes.size(), 1U);
  EXPECT_THAT(nav->notes.front(), testing::HasSubstr("same address, system 1"));
  EXPECT_THAT(nav->notes.front(), testing::HasSubstr("60 samples of one are read, left out: 30 of others"));
}

// Kills an autopilot that restarts and taken for two.
TEST(Tlog, AVehicleThatIsStartedAnewIsOne) {
  std::vector<std::uint8_t> log;
  for (std::uint32_t i = 0; i < 60; ++i) add_position(log, 1000 + 100 * i, 1, 500'000 + 100 * i, 10.0F);
  for (std::uint32_t i = 0; i < 60; ++i) add_position(log, 20'000 + 100 * i, 1, 2000 + 100 * i, 10.0F);
  const auto nav = read_as_tlog(log, Damage::kFail);
  ASSERT_TRUE(nav) << nav.error().message;
  expect_positions(*nav, 120, 10.0);
  EXPECT_TRUE(nav->notes.empty());
}

// Kills navigation of a companion computer that is taken for another vehicle's.
TEST(Tlog, AGroundStationIsNoVehicle) {
  std::vector<std::uint8_t> log;
  for (std::uint32_t i = 0; i < 20; ++i) {
    add_position(log, 1000 + 100 * i, 1, 5000 + 100 * i, 10.0F);
    add_position(log, 1050 + 100 * i, 255, 5000 + 100 * i, 11.0F);
  }
  const auto nav = read_as_tlog(log, Damage::kFail);
  ASSERT_TRUE(nav) << nav.error().message;
  EXPECT_EQ(nav->log.sources().size(), 2U);
  EXPECT_TRUE(nav->notes.empty());
}

TEST(Tlog, TurnsWhatAVehicleSaidIntoOurFrames) {
  EXPECT_EQ(format_of(golden_tlog()), Format::kTlog);
  const auto nav = read_as_tlog(golden_tlog());
  ASSERT_TRUE(nav) << nav.error().message;
  EXPECT_EQ(nav->records, 3U);
  EXPECT_TRUE(nav->damage.empty());
  const NavSource* attitude = source_of(nav->log, "ATTITUDE", NavQuantity::kAttitude);
  ASSERT_NE(attitude, nullptr);
  const Eigen::Vector3d rpy = attitude->samples.at(0).value;
  EXPECT_NEAR(rpy.x(), -0.0243004, 1e-7);
  EXPECT_NEAR(rpy.y(), -0.0246878, 1e-7);
  EXPECT_NEAR(rpy.z(), std::numbers::pi / 2 + 2.3480 - 2 * std::numbers::pi, 1e-4);
  const NavSource* depth = source_of(nav->log, "GLOBAL_POSITION_INT", NavQuantity::kDepth);
  ASSERT_NE(depth, nullptr);
  EXPECT_NEAR(depth->samples.at(0).value.x(), -0.028, 1e-9);
  const NavSource* fix = source_of(nav->log, "GLOBAL_POSITION_INT", NavQuantity::kFix);
  ASSERT_NE(fix, nullptr);
  EXPECT_NEAR(fix->samples.at(0).value.x() * 180 / std::numbers::pi, 48.3861421, 1e-9);
  EXPECT_NEAR(fix->samples.at(0).value.y() * 180 / std::numbers::pi, -124.6305728, 1e-9);
  const NavSource* pressure = source_of(nav->log, "SCALED_PRESSURE2", NavQuantity::kPressure);
  ASSERT_NE(pressure, nullptr);
  EXPECT_NEAR(pressure->samples.at(0).value.x(), 101580, 1);
  const NavSource* temperature = source_of(nav->log, "SCALED_PRESSURE2", NavQuantity::kTemperature);
  ASSERT_NE(temperature, nullptr);
  EXPECT_NEAR(temperature->samples.at(0).value.x(), 12.45, 1e-9);
}

TEST(Tlog, PutsSamplesWhereTheirSenderMadeThemNotWhereTheyArrived) {
  const auto nav = read_as_tlog(golden_tlog());
  ASSERT_TRUE(nav);
  // All three carry the sender's own clock: their distances are those of that clock.
  const double pressure_s = source_of(nav->log, "SCALED_PRESSURE2", NavQuantity::kPressure)->samples[0].time_s;
  const double attitude_s = source_of(nav->log, "ATTITUDE", NavQuantity::kAttitude)->samples[0].time_s;
  const double position_s = source_of(nav->log, "GLOBAL_POSITION_INT", NavQuantity::kDepth)->samples[0].time_s;
  EXPECT_NEAR(attitude_s - pressure_s, 0.060, 1e-6);
  EXPECT_NEAR(position_s - attitude_s, 0.110, 1e-6);
  EXPECT_LE(attitude_s, 1683220541.493 + 1e-6);
}

TEST(Tlog, StepsOverDamageAndSaysWhere) {
  auto flipped = golden_tlog();
  const std::size_t first = from_hex(kTimedPressure).size();
  flipped[first + 20] ^= 1;
  const auto one_lost = read_as_tlog(flipped);
  ASSERT_TRUE(one_lost);
  EXPECT_EQ(one_lost->records, 2U);
  ASSERT_EQ(one_lost->damage.size(), 1U);
  EXPECT_EQ(one_lost->damage[0].what, "wrong checksum");
  EXPECT_EQ(one_lost->damage[0].first_byte, first);

  auto stray = golden_tlog();
  stray.insert(stray.begin() + static_cast<std::ptrdiff_t>(first), {1, 2, 3, 4, 5});
  const auto all = read_as_tlog(stray);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->records, 3U);
  ASSERT_EQ(all->damage.size(), 1U);
  EXPECT_EQ(all->damage[0].what, "bytes between records");

  auto cut = golden_tlog();
  cut.resize(cut.size() - 3);
  const auto without_last = read_as_tlog(cut);
  ASSERT_TRUE(without_last);
  EXPECT_EQ(without_last->records, 2U);
  ASSERT_EQ(without_last->damage.size(), 1U);
  EXPECT_EQ(without_last->damage[0].what, "cut off at the end");
  EXPECT_EQ(without_last->damage[0].first_byte, cut.size() - 45);

  const auto strict = read_as_tlog(cut, Damage::kFail);
  ASSERT_FALSE(strict);
  EXPECT_THAT(strict.error().message, testing::StartsWith("dive.tlog: byte "));
}

/// Records of one frame at these times.
std::vector<std::uint8_t> tlog_at(const std::vector<std::uint64_t>& times_us) {
  std::vector<std::uint8_t> bytes;
  for (const std::uint64_t time_us : times_us) {
    for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(time_us >> shift));
    const std::vector<std::uint8_t> record = from_hex(kTimedAttitude);
    bytes.insert(bytes.end(), record.begin() + 8, record.end());
  }
  return bytes;
}

std::vector<std::uint64_t> times_in(const std::vector<std::uint8_t>& bytes, std::vector<DamageKind>& damage) {
  std::vector<std::uint64_t> times_us;
  for_each_tlog_record(bytes, damage, [&](const TlogRecord& record) { times_us.push_back(record.time_us); });
  return times_us;
}

TEST(Tlog, AWrongBitInATimeCostsItsRecordOnly) {
  constexpr std::uint64_t kStart_us = 1'683'220'541'493'000, kStep_us = 10'000;
  std::vector<std::uint64_t> right_us;
  for (std::uint64_t i = 0; i < 5; ++i) right_us.push_back(kStart_us + i * kStep_us);
  const std::size_t third = 2 * from_hex(kTimedAttitude).size();
  std::size_t skipped = 0;
  for (int bit = 0; bit < 64; ++bit) {
    SCOPED_TRACE(bit);
    auto times_us = right_us;
    times_us[2] ^= std::uint64_t{1} << bit;
    std::vector<DamageKind> damage;
    const auto read_us = times_in(tlog_at(times_us), damage);
    if (damage.empty()) {
      EXPECT_EQ(read_us, times_us);
      EXPECT_LE(bit, 19) << "0.5 s";
      continue;
    }
    ++skipped;
    times_us.erase(times_us.begin() + 2);
    EXPECT_EQ(read_us, times_us);
    ASSERT_EQ(damage.size(), 1U);
    EXPECT_EQ(damage[0].count, 1U);
    EXPECT_EQ(damage[0].first_byte, third);
  }
  EXPECT_EQ(skipped, 44U);
}

TEST(Tlog, AClockThatIsSetIsNoDamage) {
  constexpr std::uint64_t kStart_us = 1'683'220'541'493'000, kSecond_us = 1'000'000;
  for (const std::vector<int>& times_s :
       {std::vector{0, 1, 100, 101}, {100, 101, 0, 1}, {0, 100, 200}, {0, 1, 100}, {100, 0, 1}, {0, 1, 30, 60, 2, 3}}) {
    std::vector<std::uint64_t> times_us;
    for (const int time_s : times_s) times_us.push_back(kStart_us + static_cast<std::uint64_t>(time_s) * kSecond_us);
    std::vector<DamageKind> damage;
    EXPECT_EQ(times_in(tlog_at(times_us), damage), times_us);
    EXPECT_TRUE(damage.empty());
  }
}

TEST(Tlog, DamageBehindAWrongTimeIsNotTheFirst) {
  constexpr std::uint64_t kStart_us = 1'683'220'541'493'000;
  auto bytes = tlog_at({kStart_us, kStart_us + 100'000'000, kStart_us + 2, kStart_us + 3});
  const std::size_t record = bytes.size() / 4;
  bytes[2 * record + 30] ^= 1;
  std::vector<DamageKind> damage;
  EXPECT_EQ(times_in(bytes, damage).size(), 2U);
  ASSERT_EQ(damage.size(), 2U);
  EXPECT_EQ(damage[0].what, "wrong time");
  EXPECT_EQ(damage[0].first_byte, record);
  EXPECT_EQ(damage[1].what, "wrong checksum");
}

/// Attitudes in turn with fixes, whose messages have no time of their own, ten times a second.
template <class Clock>
std::vector<std::uint8_t> dive_by(const Clock& clock_s, int count = 300) {
  std::vector<std::uint8_t> bytes;
  for (int k = 0; k < count; ++k) {
    const auto time_us = static_cast<std::uint64_t>(std::llround((clock_s(k) + 0.1 * k) * 1e6));
    const auto boot_ms = static_cast<std::uint32_t>(100'000 + 100 * k);
    std::vector<std::uint8_t> attitude(28), fix(30);
    for (unsigned i = 0; i < 4; ++i) attitude[i] = static_cast<std::uint8_t>(boot_ms >> (8 * i));
    fix[8] = fix[12] = fix[28] = 3;
    for (const auto& [message, payload] : {std::pair(30U, attitude), std::pair(24U, fix)}) {
      for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(time_us >> shift));
      const std::vector<std::uint8_t> frame = make_mavlink_frame(message, payload, {});
      bytes.insert(bytes.end(), frame.begin(), frame.end());
    }
  }
  return bytes;
}

// Logs of 1970 and 1980 were of an unknown format, and where the clock was set, half of the records were one damage.
TEST(Tlog, TheClockOfTheComputerMayBeSetLaterOrBackOrNever) {
  constexpr double kDate_s = 1'684'351'479.0, kYear1980_s = 315'532'800.0;
  const auto first = [](double before_s, double after_s) {
    return [=](int k) { return k < 150 ? before_s : after_s; };
  };
  const struct {
    double before_s, after_s, right_s;
  } cases[] = {{100.0, 100.0, 100.0},     {kYear1980_s, kYear1980_s, kYear1980_s},
               {100.0, kDate_s, kDate_s}, {kYear1980_s, kDate_s, kDate_s},
               {kDate_s, 100.0, kDate_s}, {kDate_s, kYear1980_s, kDate_s}};
  for (const auto& [before_s, after_s, right_s] : cases) {
    SCOPED_TRACE(testing::Message() << before_s << ", " << after_s);
    const std::vector<std::uint8_t> bytes = dive_by(first(before_s, after_s));
    EXPECT_EQ(format_of(bytes), Format::kTlog);
    const auto nav = read_as_tlog(bytes, Damage::kFail);
    ASSERT_TRUE(nav) << nav.error().message;
    EXPECT_EQ(nav->records, 600U);
    EXPECT_EQ(nav->settings.size(), before_s == after_s ? 0U : 1U);
    ASSERT_EQ(nav->runs.size(), 1U);
    EXPECT_NEAR(nav->runs[0].zero_s, right_s - 100.0, 1e-5);
    ASSERT_EQ(nav->log.sources().size(), 3U);
    for (const NavSource& source : nav->log.sources()) {
      ASSERT_EQ(source.samples.size(), 300U);
      EXPECT_FALSE(source.step_back) << source.name;
      for (int k = 0; k < 300; ++k) {
        ASSERT_NEAR(source.samples[static_cast<std::size_t>(k)].time_s, right_s + 0.1 * k, 1e-5) << source.name;
      }
    }
  }
}

// Kills records of unknown messages that are taken for damage because their dates are none, and ghosts that are taken
// for records.
TEST(Tlog, AMessageThatIsNotKnownIsARecordInAnyYearIfRightOnesFollow) {
  const auto unknown = [](double time_s) {
    std::vector<std::uint8_t> record;
    const auto time_us = static_cast<std::uint64_t>(time_s * 1e6);
    for (int shift = 56; shift >= 0; shift -= 8) record.push_back(static_cast<std::uint8_t>(time_us >> shift));
    const auto frame = from_hex("fd010000000101f0ff00 07 1234");
    record.insert(record.end(), frame.begin(), frame.end());
    return record;
  };
  std::vector<std::uint8_t> bytes;
  for (const double time_s : {99.8, 99.9}) {
    const auto record = unknown(time_s);
    bytes.insert(bytes.end(), record.begin(), record.end());
  }
  const auto dive = dive_by([](int) { return 100.0; }, 10);
  bytes.insert(bytes.end(), dive.begin(), dive.end());
  std::vector<DamageKind> damage;
  EXPECT_EQ(times_in(bytes, damage).size(), 22U);
  EXPECT_TRUE(damage.empty());
  // In front of what is no record it is none either.
  auto ghost = unknown(99.8);
  ghost.insert(ghost.end(), 40, 0x55);
  ghost.insert(ghost.end(), dive.begin(), dive.end());
  EXPECT_EQ(times_in(ghost, damage).size(), 20U);
  ASSERT_EQ(damage.size(), 1U);
  EXPECT_EQ(damage[0].what, "bytes between records");
}

// Kills a wrong bit in the first or last time of a log that makes a record of 1970 of it.
TEST(Tlog, ATimeWithoutADateIsNotAlone) {
  constexpr std::uint64_t kStart_us = 1'683'220'541'493'000, kStep_us = 10'000;
  for (const std::size_t wrong : {0U, 3U}) {
    std::vector<std::uint64_t> times_us = {kStart_us, kStart_us + kStep_us, kStart_us + 2 * kStep_us,
                                           kStart_us + 3 * kStep_us};
    times_us[wrong] &= 0xff'ffff'ffffU;
    std::vector<DamageKind> damage;
    EXPECT_EQ(times_in(tlog_at(times_us), damage).size(), 3U);
    ASSERT_EQ(damage.size(), 1U);
    EXPECT_EQ(damage[0].what, "wrong time");
  }
}

struct TlogRecording {
  const char* file;
  std::size_t frames;  ///< right ones, and those of messages that we do not check
  std::size_t right_padded;
  std::map<std::uint32_t, std::size_t> messages;
};

class RealTlog : public testing::TestWithParam<TlogRecording> {};

TEST_P(RealTlog, HasAsManyFramesAsItsReadmeSays) {
  const std::filesystem::path path = std::filesystem::path(PINGVOX_SHARED_DATA) / GetParam().file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto file = read_file(path.string());
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(format_of(file->view()), Format::kTlog);
  std::vector<DamageKind> damage;
  std::map<std::uint32_t, std::size_t> messages;
  std::size_t padded = 0;
  const std::size_t frames = for_each_tlog_record(file->view(), damage, [&](const TlogRecord& record) {
    ++messages[record.frame.message];
    padded += record.frame.check == MavlinkFrame::Check::kRightPadded ? 1 : 0;
  });
  if (GetParam().frames > 0) {
    EXPECT_EQ(frames, GetParam().frames);
    EXPECT_TRUE(damage.empty());
  }
  EXPECT_EQ(padded, GetParam().right_padded);
  for (const auto& [message, count] : GetParam().messages) EXPECT_EQ(messages[message], count) << message;
}

// The four frames of camera messages whose checksum is wrong are of messages that we do not check.
INSTANTIATE_TEST_SUITE_P(
    Recordings, RealTlog,
    testing::Values(TlogRecording{"bluerov2-tlog-bin/ugps_2023-05-04.tlog",
                                  35'916,
                                  0,
                                  {{30, 5245},
                                   {178, 5245},
                                   {251, 4224},
                                   {74, 3060},
                                   {232, 1011},
                                   {33, 792},
                                   {32, 792},
                                   {29, 528},
                                   {137, 635},
                                   {22, 888}}},
                    TlogRecording{"bluerov2-tlog-bin/badcrc_2023-04-18.tlog", 52'103, 1949, {{132, 919 + 1949}}},
                    TlogRecording{
                        "bluerov2-tlog-bin/dive5m_2023-07-14_09-02-35.tlog", 48'343, 73, {{132, 2767 + 73 + 899}}},
                    TlogRecording{"bluerov2-echosounder-nav/2024-04-05 09-19-03.tlog", 27'362, 0, {{132, 1463 + 465}}},
                    TlogRecording{"bluerov2-echosounder-nav/2024-04-05 09-25-32.tlog", 59'880, 0, {{132, 3930 + 1117}}},
                    TlogRecording{"generic-mavlink-dataflash/flight_v1_2015.tlog", 0, 0, {{30, 2829}}}));

TEST(RealTlogs, TheDiveIsAsDeepAsItWas) {
  const std::string path = PINGVOX_SHARED_DATA "/bluerov2-tlog-bin/dive5m_2023-07-14_09-02-35.tlog";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto file = read_file(path);
  ASSERT_TRUE(file);
  const auto nav = read_nav(*file);
  ASSERT_TRUE(nav) << nav.error().message;
  const NavSource* depth = nav->log.best(NavQuantity::kDepth);
  ASSERT_NE(depth, nullptr);
  double least_m = 1e9, most_m = -1e9;
  for (const NavSample& sample : depth->samples) {
    least_m = std::min(least_m, sample.value.x());
    most_m = std::max(most_m, sample.value.x());
  }
  EXPECT_NEAR(least_m, 0.07, 0.005);
  EXPECT_NEAR(most_m, 5.36, 0.005);
}

}  // namespace
}  // namespace pingvox
