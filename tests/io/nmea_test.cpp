// NMEA 0183 as users log it.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/nav.hpp"

namespace pingvox {
namespace {

FileBytes nmea_file(const std::string& text) {
  return {"topside.txt", {text.begin(), text.end()}};
}

NavFile read_as_nmea(const std::string& text) {
  auto nav = read_nav(nmea_file(text));
  EXPECT_TRUE(nav) << nav.error().message;
  return nav ? *std::move(nav) : NavFile{*NavLog::make({}, NavClock::kUnknown), 0, {}};
}

const std::vector<NavSample>& samples_of(const NavFile& nav, const std::string& name) {
  for (const NavSource& source : nav.log.sources()) {
    if (source.name == name) return source.samples;
  }
  static const std::vector<NavSample> kNone;
  return kNone;
}

// The last second of 2023.
constexpr const char* kRmc = "$GPRMC,235959.50,A,4736.4517,N,12220.4723,W,0.1,194.8,311223,15.2,E,A*10\r\n";
constexpr double kRmc_s = 1704067199.5;

TEST(Nmea, ReadsFixesBetweenOtherText) {
  // From a receiver, behind the text of a logger; nmea-simple 3.3.0 reads the same from it.
  const std::string log =
      "2023-09-01 15:56:44.5 | INFO | costs $5, says *hello*\n\n"
      "2023-09-01 15:56:44.6 | DEBUG | recv - $GPGGA,225645.000,4736.4517768,N,12220.4723713,W,1,19,0.9,8.378,M,-20.815"
      ",M,,*66\n";
  EXPECT_EQ(format_of(nmea_file(log).view()), Format::kNmea);
  const NavFile nav = read_as_nmea(log);
  EXPECT_EQ(nav.records, 1U);
  EXPECT_TRUE(nav.damage.empty());
  EXPECT_EQ(nav.log.clock(), NavClock::kUnknown) << "a time of day alone";
  const auto& fixes = samples_of(nav, "GPGGA");
  ASSERT_EQ(fixes.size(), 1U);
  EXPECT_NEAR(fixes[0].value.x() / kDegree_rad, 47.60752961, 5e-9);
  EXPECT_NEAR(fixes[0].value.y() / kDegree_rad, -122.34120619, 5e-9);
  EXPECT_EQ(fixes[0].value.z(), 8.378);
  EXPECT_DOUBLE_EQ(fixes[0].time_s, 22 * 3600 + 56 * 60 + 45);
}

TEST(Nmea, TakesTheDayFromTheNearestDateAndRollsItAtMidnight) {
  const NavFile nav = read_as_nmea(std::string("$GPHDT,90.0,T*0C\r\n") + kRmc +
                                   "$GPGGA,000000.50,4736.4517,N,12220.4723,W,1,19,0.9,8.378,M,-20.8,M,,*59\r\n"
                                   "$GPGGA,000000.50,4736.4517,S,12220.4723,E,0,00,,,M,,M,,*6B\r\n");
  EXPECT_EQ(nav.log.clock(), NavClock::kUnix);
  EXPECT_DOUBLE_EQ(samples_of(nav, "GPRMC").at(0).time_s, kRmc_s);
  EXPECT_DOUBLE_EQ(samples_of(nav, "GPGGA").at(0).time_s, kRmc_s + 1.0);
  EXPECT_DOUBLE_EQ(samples_of(nav, "GPHDT").at(0).time_s, kRmc_s) << "before any sentence with a time";
  EXPECT_NEAR(samples_of(nav, "GPHDT").at(0).value.x(), 0.0, 1e-12) << "east";
  EXPECT_TRUE(samples_of(nav, "GPGGA").at(0).valid);
  EXPECT_FALSE(samples_of(nav, "GPGGA").at(1).valid) << "quality 0";
  EXPECT_LT(samples_of(nav, "GPGGA").at(1).value.x(), 0.0) << "south";
}

// Kills a log that begins decades before its dive, and one whose only dates are thrown away.
TEST(Nmea, ADateWithoutAFixCountsWhereThereIsNoOther) {
  const std::string cold = "$GPRMC,000002.00,V,,,,,,,060180,,,N*70\r\n$GPHDT,90.0,T*0C\r\n";
  const NavFile nav = read_as_nmea(cold + kRmc + "$GPHDT,90.0,T*0C\r\n");
  EXPECT_EQ(nav.log.clock(), NavClock::kUnix);
  EXPECT_DOUBLE_EQ(samples_of(nav, "GPRMC").at(0).time_s, kRmc_s);
  EXPECT_NEAR(samples_of(nav, "GPHDT").at(0).time_s, kRmc_s, 43'200.0) << "a heading of a receiver that starts";
  const NavFile under_water = read_as_nmea("$GPRMC,235957.50,V,,,,,,,311223,,,N*77\r\n$GPHDT,90.0,T*0C\r\n");
  EXPECT_EQ(under_water.log.clock(), NavClock::kUnix);
  EXPECT_DOUBLE_EQ(samples_of(under_water, "GPHDT").at(0).time_s, kRmc_s - 2.0);
}

// A computer without a clock wrote 1970, and its log was of 2070.
TEST(Nmea, TwoDigitsOfAClockThatWasNotSetAreNoYearToCome) {
  const NavFile nav = read_as_nmea("$GPRMC,000140.00,A,4736.4517,N,12220.4723,W,0.1,194.8,010170,15.2,E,A*16\r\n");
  EXPECT_DOUBLE_EQ(samples_of(nav, "GPRMC").at(0).time_s, 100.0);
}

/// With its checksum.
std::string sentence(const std::string& body) {
  unsigned sum = 0;
  for (const char character : body) sum ^= static_cast<unsigned char>(character);
  return fmt::format("${}*{:02X}\r\n", body, sum);
}

// Kills a day of 257 that is the first of its month.
TEST(Nmea, ADateThatIsNoneIsNoDate) {
  const auto clock_with = [](const std::string& day, const std::string& month, const std::string& year) {
    return read_as_nmea(sentence("GPZDA,235959.50," + day + "," + month + "," + year + ",00,00") +
                        sentence("GPHDT,90.0,T"))
        .log.clock();
  };
  EXPECT_EQ(clock_with("31", "12", "2023"), NavClock::kUnix);
  for (const auto& [day, month, year] : {std::array{"32", "12", "2023"},
                                         {"257", "12", "2023"},
                                         {"31", "13", "2023"},
                                         {"01", "257", "2023"},
                                         {"31", "02", "2023"},
                                         {"0", "01", "2023"},
                                         {"01", "01", "12023"}}) {
    EXPECT_NE(clock_with(day, month, year), NavClock::kUnix) << day << "." << month << "." << year;
  }
}

// Kills headings that vanish without a word.
TEST(Nmea, ALogWithoutAnyTimeIsTold) {
  const NavFile nav = read_as_nmea("$GPHDT,90.0,T*0C\r\n");
  EXPECT_TRUE(nav.log.sources().empty());
  ASSERT_EQ(nav.damage.size(), 1U);
  EXPECT_EQ(nav.damage[0].what, "sample of a log without any time");
  EXPECT_EQ(nav.damage[0].count, 1U);
  EXPECT_TRUE(read_as_nmea("$GPGSA,A,1,,,,,,,,,,,,,,,*1E\r\n").damage.empty()) << "no navigation";
}

TEST(Nmea, WhatIsEmptyIsNotZero) {
  const NavFile nav = read_as_nmea(std::string(kRmc) + "$HEHDT,,T*01\r\n$GNRMC,000001.00,V,,,,,,,010124,,,N*64\r\n");
  EXPECT_EQ(nav.records, 3U);
  EXPECT_TRUE(nav.damage.empty());
  EXPECT_EQ(nav.log.sources().size(), 1U);
}

TEST(Nmea, ReadsCompassSounderAndLog) {
  const NavFile nav = read_as_nmea(std::string(kRmc) +
                                   "$IIHDG,10.0,2.0,W,5.0,E*6D\r\n$SDDBT,30.0,f,9.1,M,5.0,F*38\r\n$SDDPT,3.5,0.2*53\r\n"
                                   "$VDVBW,,,V,2.0,1.0,A*45\r\n$YXMTW,12.5,C*14\r\n");
  EXPECT_NEAR(samples_of(nav, "IIHDG").at(0).value.x(), 77 * kDegree_rad, 1e-12) << "10 - 2 + 5 from north";
  EXPECT_EQ(samples_of(nav, "SDDBT").at(0).value.x(), 9.1) << "metres, not feet";
  EXPECT_EQ(samples_of(nav, "SDDPT").at(0).value.x(), 3.5);
  EXPECT_EQ(samples_of(nav, "YXMTW").at(0).value.x(), 12.5);
  const NavSample& velocity = samples_of(nav, "VDVBW").at(0);
  EXPECT_NEAR(velocity.value.x(), 2 * 1852.0 / 3600.0, 1e-12);
  EXPECT_NEAR(velocity.value.y(), -1852.0 / 3600.0, 1e-12) << "to starboard";
}

TEST(Nmea, CountsDamageByKindAndPlace) {
  std::string wrong = kRmc;
  wrong[20] = '8';
  const std::string cut = "$GPGGA,000000.50,4736.45";
  const NavFile nav =
      read_as_nmea(kRmc + wrong + cut + kRmc + "$GPGLL,9136.45,N,12220.47,W,000001.00,A*1B\r\n$GPHDT,9");
  EXPECT_EQ(nav.records, 3U);
  EXPECT_EQ(samples_of(nav, "GPRMC").size(), 2U) << "one behind a sentence that was cut";
  EXPECT_TRUE(samples_of(nav, "GPGLL").empty()) << "no place on the earth";
  ASSERT_EQ(nav.damage.size(), 4U);
  EXPECT_EQ(nav.damage[0].what, "wrong checksum");
  EXPECT_EQ(nav.damage[0].first_byte, wrong.size());
  EXPECT_EQ(nav.damage[1].what, "sentence without checksum");
  EXPECT_EQ(nav.damage[1].first_byte, 2 * wrong.size());
  EXPECT_EQ(nav.damage[2].what, "impossible values");
  EXPECT_EQ(nav.damage[3].what, "cut off at the end");
}

// Checksums are optional: a log without them was "text of no known format".
TEST(Nmea, ReadsSentencesOfADeviceWithoutChecksums) {
  const std::string log =
      "$GPRMC,120000.00,A,5400.0000,N,01000.0000,E,0.5,90.0,150924,,\r\n$HEHDT,90.0,T\n"
      "$GPRMC,120001.00,A,5400.0000,N,01000.0000,E,0.5,90.0,150924,,\r\n$HEHDT,91.0,T\n$HEHDT,9";
  EXPECT_EQ(format_of(nmea_file(log).view()), Format::kNmea);
  const NavFile nav = read_as_nmea(log);
  EXPECT_EQ(nav.records, 4U);
  EXPECT_EQ(samples_of(nav, "GPRMC").size(), 2U);
  EXPECT_EQ(samples_of(nav, "HEHDT").size(), 2U);
  EXPECT_EQ(nav.log.clock(), NavClock::kUnix);
  ASSERT_EQ(nav.damage.size(), 1U);
  EXPECT_EQ(nav.damage[0].what, "cut off at the end");
  // Where a device sends them, what lacks one is damaged.
  const NavFile mixed =
      read_as_nmea(std::string(kRmc) + "$GPGLL,4736.45,N,12220.47,W,000001.00,A\r\n$HEHDT,90.0,T\r\n");
  EXPECT_TRUE(samples_of(mixed, "GPGLL").empty());
  EXPECT_EQ(samples_of(mixed, "HEHDT").size(), 1U);
  EXPECT_EQ(mixed.damage.at(0).what, "sentence without checksum");
  EXPECT_EQ(format_of(nmea_file("it costs $AB,5\nor $PRICE,7\n").view()), std::nullopt);
}

struct NmeaRecording {
  const char* file;
  std::size_t sentences;
  NavClock clock;
  std::map<std::string, std::size_t> sources;
  double from_s;
};

class RealNmea : public testing::TestWithParam<NmeaRecording> {};

TEST_P(RealNmea, HasAsManySentencesAsItsReadmeSays) {
  const auto path = std::filesystem::path(PINGVOX_SHARED_DATA) / "nmea-topside" / GetParam().file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto file = read_file(path.string());
  ASSERT_TRUE(file);
  EXPECT_EQ(format_of(file->view()), Format::kNmea);
  const auto nav = read_nav(*file);
  ASSERT_TRUE(nav) << nav.error().message;
  EXPECT_EQ(nav->records, GetParam().sentences);
  EXPECT_TRUE(nav->damage.empty());
  EXPECT_EQ(nav->log.clock(), GetParam().clock);
  std::map<std::string, std::size_t> sources;
  for (const NavSource& source : nav->log.sources()) {
    sources[source.name] = source.samples.size();
    EXPECT_NEAR(source.samples.front().time_s, GetParam().from_s, 30.0);
  }
  EXPECT_EQ(sources, GetParam().sources);
}

INSTANTIATE_TEST_SUITE_P(
    Recordings, RealNmea,
    // 2023-09-01 22:56:44 UTC; 2019-09-12 20:36:37 UTC; a USBL alone has no time.
    testing::Values(
        NmeaRecording{
            "ugps_nmea_log_2023-09-01.txt", 274, NavClock::kUnix, {{"GPRMC", 129}, {"GPGGA", 16}}, 1693609004.0},
        NmeaRecording{
            "raw_gps_data.txt", 1724, NavClock::kUnix, {{"GNRMC", 154}, {"GNGGA", 154}, {"GNGLL", 154}}, 1568320597.0},
        NmeaRecording{"raw_rth_data.txt", 90, NavClock::kUnknown, {}, 0.0}));

// Kills places and directions that are none: 75 minutes, and more than a turn or a quarter of it.
TEST(Nmea, ImpossibleValuesAreDamage) {
  const NavFile nav = read_as_nmea(
      "$GPGGA,120000.00,5475.0000,N,01000.0000,E,1,9,1.0,0,M,0,M,,\n$GPGGA,120001.00,9130.0000,N,01000.0000,E,1,9,1.0,"
      "0,M,"
      "0,M,,\n$HEHDT,400.0,T\n$HEHDT,360.0,T\n$GPGGA,120002.00,5415.0000,N,01000.0000,E,1,9,1.0,0,M,0,M,,\n");
  EXPECT_EQ(samples_of(nav, "GPGGA").size(), 1U);
  EXPECT_EQ(samples_of(nav, "HEHDT").size(), 1U);
  ASSERT_EQ(nav.damage.size(), 1U);
  EXPECT_EQ(nav.damage[0].what, "impossible values");
  EXPECT_EQ(nav.damage[0].count, 3U);
}

// Kills 54.3 degrees north that become 0.9.
TEST(Nmea, DecimalDegreesAreNoPlace) {
  const NavFile nav = read_as_nmea(
      "$GPRMC,221320.00,A,54.300000,N,10.100000,E,0.5,90.0,141123,,\n$GPRMC,221321.00,A,54.300000,N,010.100000,E,0.5,"
      "90.0,141123,,\n$GPRMC,221322.00,A,5418.0000,N,01006.0000,E,0.5,90.0,141123,,\n");
  EXPECT_EQ(samples_of(nav, "GPRMC").size(), 1U);
  ASSERT_EQ(nav.damage.size(), 1U);
  EXPECT_EQ(nav.damage[0].count, 2U);
  EXPECT_NE(nav.damage[0].what.find("is it in decimal degrees"), std::string_view::npos);
  const NavFile all = read_as_nmea("$GPRMC,221320.00,A,54.300000,N,10.100000,E,0.5,90.0,141123,,\n");
  ASSERT_EQ(all.log.sources().size(), 1U);
  EXPECT_NE(all.log.sources()[0].fault.find("is it in decimal degrees"), std::string::npos);
}

TEST(Nmea, APlaceIsNotSouthTwice) {
  const NavFile nav = read_as_nmea("$GPRMC,221320.00,A,-5400.0000,S,01000.0000,E,0.5,90.0,141123,,\n");
  EXPECT_TRUE(nav.log.sources().empty());
  ASSERT_EQ(nav.damage.size(), 1U);
  EXPECT_EQ(nav.damage[0].what, "impossible values");
}

}  // namespace
}  // namespace pingvox
