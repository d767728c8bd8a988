#include "io/internal/clock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pingvox/io/file.hpp"
#include "pingvox/io/nav.hpp"

namespace pingvox {
namespace {

using testing::Optional;

TEST(Clock, ADateInTheNameOfALog) {
  // 2024-04-05 09:16:48.974
  EXPECT_THAT(date_in_name("dives/2024/20240405-091648974.bin"), Optional(1712308608.974));
  EXPECT_THAT(date_in_name("2024-04-05 09-16-48.csv"), Optional(1712308608.0));
  EXPECT_EQ(date_in_name("20240405.bin"), std::nullopt) << "no time of day";
  EXPECT_EQ(date_in_name("20241305-091648974.bin"), std::nullopt) << "no 13th month";
  EXPECT_EQ(date_in_name("20240405-0916489745.bin"), std::nullopt) << "digits behind it";
  EXPECT_EQ(date_in_name("120240405-091648974.bin"), std::nullopt) << "digits before it";
  EXPECT_EQ(date_in_name("20240405-091648 20240405-101648.bin"), std::nullopt) << "two dates";
  EXPECT_EQ(date_in_name("1234-02-03 04-05-06.bin"), std::nullopt) << "no year of a log";
  EXPECT_EQ(date_in_name(""), std::nullopt);
}

// Kills logs that are refused because a program or a person put something before or behind the date.
TEST(Clock, ADateMayStandAnywhereInTheName) {
  for (const auto* name : {"ping360_20240405-091648974.bin", "20240405-091648974-5.bin", "20240405-091648974 (1).bin",
                           "dive1-20240405-091648974.bin", "ping360_20240405-091648974-19.bin"}) {
    EXPECT_THAT(date_in_name(name), Optional(1712308608.974)) << name;
  }
  for (const auto* name : {"UdpHubLog_4001_2024_04_05_09_16_48.csv", "20240405T091648.csv", "20240405-091648-2024.csv",
                           "20240405-091648_20240405-091648.csv"}) {
    EXPECT_THAT(date_in_name(name), Optional(1712308608.0)) << name;
  }
}

TEST(Clock, TheTimeZoneIsTheOneWithWhichTheLogsCoverEachOther) {
  EXPECT_THAT(local_from_utc_s({3600.0 + 10.0, 3600.0 + 310.0}, {0.0, 300.0}), Optional(3600.0));
  EXPECT_THAT(local_from_utc_s({-12600.0, -12590.0}, {0.0, 300.0}), Optional(-12600.0)) << "Newfoundland";
  EXPECT_THAT(local_from_utc_s({14 * 3600.0, 14 * 3600.0 + 10.0}, {0.0, 300.0}), Optional(14 * 3600.0)) << "Kiribati";
  EXPECT_THAT(local_from_utc_s({20700.0, 20700.0}, {0.0, 300.0}), Optional(20700.0)) << "a moment in Nepal";
  EXPECT_EQ(local_from_utc_s({-13 * 3600.0, -13 * 3600.0 + 10.0}, {0.0, 300.0}), std::nullopt) << "no zone";
  EXPECT_EQ(local_from_utc_s({400.0, 500.0}, {0.0, 300.0}), std::nullopt) << "neither";
  EXPECT_EQ(local_from_utc_s({3600.0 + 200.0, 3600.0 + 500.0}, {0.0, 300.0}), std::nullopt) << "a third of both";
}

// Kills logs of two dives that are joined by a time that no clock shows.
TEST(Clock, OnlyTimeZonesInUseCount) {
  for (const double hours : {-7.75, -6.25, -0.25, 0.5, 5.25, 11.5, 14.25}) {
    EXPECT_TRUE(time_zones({hours * 3600.0, hours * 3600.0 + 300.0}, {0.0, 300.0}).empty()) << hours;
  }
  for (const double hours : {-12.0, -9.5, -7.0, -2.5, 0.0, 5.75, 8.75, 12.75, 13.75, 14.0}) {
    const auto zones = time_zones({hours * 3600.0, hours * 3600.0 + 300.0}, {0.0, 300.0});
    ASSERT_EQ(zones.size(), 1U) << hours;
    EXPECT_EQ(zones[0].local_from_utc_s, hours * 3600.0);
    EXPECT_DOUBLE_EQ(zones[0].share, 1.0);
  }
}

// Kills long dives without a zone because they overlap in several.
TEST(Clock, ALongDiveHasTheTimeZoneOfTheGreatestOverlap) {
  constexpr double kZone_s = -7 * 3600.0, kMinute_s = 60.0;
  EXPECT_THAT(local_from_utc_s({kZone_s, kZone_s + 90 * kMinute_s}, {-5 * kMinute_s, 95 * kMinute_s}),
              Optional(kZone_s));
  const TimeSpan part = {kZone_s, kZone_s + 20 * kMinute_s}, day = {-120 * kMinute_s, 180 * kMinute_s};
  EXPECT_EQ(local_from_utc_s(part, day), std::nullopt) << "whole in several zones";
  EXPECT_EQ(time_zones(part, day).size(), 7U) << "-10:00, -9:30, -9:00 to -5:00";
}

// A Ping1D's log, named by its local time, and what the vehicle recorded of the same pings.
TEST(Clock, ALogOfPingViewerIsOnTheClockOfItsVehicle) {
  const auto folder = std::filesystem::path(PINGVOX_SHARED_DATA) / "bluerov2-echosounder-nav";
  const std::string name = (folder / "20240405-091648974.bin").string();
  if (!std::filesystem::exists(name)) GTEST_SKIP() << name << " is not there";
  const auto log = read_file(name);
  const auto nav = read_nav(*read_file((folder / "2024-04-05 09-25-32.tlog").string()));
  ASSERT_TRUE(log && nav);
  const NavSource* distances = nullptr;
  for (const NavSource& source : nav->log.sources()) {
    if (source.name == "DISTANCE_SENSOR[1] 1/194") distances = &source;
  }
  ASSERT_NE(distances, nullptr);

  // Each read of the serial line has its time in front, in UTF-16 of 24 bytes; a profile (1300) begins with the
  // distance in mm.
  struct Ping {
    double time_s;
    double distance_m;
  };
  std::vector<Ping> pings;
  const auto& bytes = log->bytes;
  const auto equals = [&](std::size_t at, const std::vector<std::uint8_t>& wanted) {
    return std::equal(wanted.begin(), wanted.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
  };
  double read_s = 0.0;
  for (std::size_t at = 0; at + 40 < bytes.size(); ++at) {
    if (equals(at, {0, 0, 0, 24, 0, '0'}) && equals(at + 8, {0, ':'})) {
      const auto two = [&](std::size_t i) { return 10 * (bytes[at + 5 + 2 * i] - '0') + bytes[at + 7 + 2 * i] - '0'; };
      read_s = 3600 * two(0) + 60 * two(3) + two(6) + two(9) / 100.0 + (bytes[at + 27] - '0') / 1000.0;
    }
    if (!equals(at, {'B', 'R'}) || !equals(at + 4, {0x14, 0x05})) continue;
    const int cm = (bytes[at + 8] + 256 * bytes[at + 9] + 65536 * bytes[at + 10]) / 10;
    pings.push_back({read_s, cm / 100.0});
  }
  EXPECT_GT(pings.size(), 6400U) << "of 6428; some are cut by the end of a read";

  const std::optional<double> start_s = date_in_name(name);
  ASSERT_TRUE(start_s);
  const auto& samples = distances->samples;
  const auto zone_s = local_from_utc_s({*start_s + pings.front().time_s, *start_s + pings.back().time_s},
                                       {samples.front().time_s, samples.back().time_s});
  EXPECT_THAT(zone_s, Optional(-7 * 3600.0)) << "Seattle in summer";
  std::vector<double> late_s;
  for (const Ping& ping : pings) {
    const double utc_s = *start_s - *zone_s + ping.time_s;
    double nearest_s = 0.5;
    for (auto sample = std::ranges::lower_bound(samples, utc_s - 0.5, {}, &NavSample::time_s);
         sample != samples.end() && sample->time_s < utc_s + 0.5; ++sample) {
      if (std::abs(sample->value.x() - ping.distance_m) > 1e-6) continue;
      const double difference_s = sample->time_s - utc_s;
      if (std::abs(difference_s) < std::abs(nearest_s)) nearest_s = difference_s;
    }
    if (nearest_s < 0.5) late_s.push_back(nearest_s);
  }
  ASSERT_GT(late_s.size(), 3000U);
  std::ranges::nth_element(late_s, late_s.begin() + static_cast<std::ptrdiff_t>(late_s.size() / 2));
  EXPECT_NEAR(late_s[late_s.size() / 2], 0.0, 0.02);
}

}  // namespace
}  // namespace pingvox
