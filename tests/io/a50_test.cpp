// Logs of Water Linked's DVLs: JSON, serial, and tables of the same names.

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "io/nav/dvl_a50.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/nav.hpp"

namespace pingvox {
namespace {

FileBytes a50_file(const std::string& text) {
  return {"dvl.log", {text.begin(), text.end()}};
}

NavFile read_as_a50(const std::string& text) {
  auto nav = read_nav(a50_file(text));
  EXPECT_TRUE(nav) << nav.error().message;
  return nav ? *std::move(nav) : NavFile{*NavLog::make({}, NavClock::kUnknown), 0, {}};
}

const std::vector<NavSample>& samples_of(const NavFile& nav, NavQuantity quantity) {
  for (const NavSource& source : nav.log.sources()) {
    if (source.quantity == quantity) return source.samples;
  }
  static const std::vector<NavSample> kNone;
  return kNone;
}

std::string velocity(const std::string& time, const std::string& valid, const std::string& more = "") {
  return R"({"time":100,"vx":0.5,"vy":-0.25,"vz":0.125,"fom":0.01,"covariance":[[1,2],[3,4]],"altitude":1.5,)"
         R"("transducers":[{"id":0,"velocity":9,"beam_valid":true}],"velocity_valid":)" +
         valid + R"(,"status":0,"format":"json_v3","type":"velocity")" + more + time + "}\r\n";
}

std::string at_us(const std::string& made, const std::string& sent) {
  return ",\"time_of_validity\":" + made + ",\"time_of_transmission\":" + sent;
}

TEST(A50, ReadsJsonInOurFramesAndAtTheTimeOfValidity) {
  const std::string log = velocity(at_us("5000000", "5350000"), "true") +
                          R"({"response_to":"get_config","success":true,"format":"json_v3","type":"response"})"
                          "\n" +
                          velocity(at_us("5100000", "36100000"), "false") +
                          R"({"ts":5.2,"x":1,"y":2,"z":3,"std":0.1,"roll":10,"pitch":20,"yaw":30,"status":0,)"
                          R"("format":"json_v3","type":"position_local"})"
                          "\n";
  EXPECT_EQ(format_of(a50_file(log).view()), Format::kDvlA50);
  const NavFile nav = read_as_a50(log);
  EXPECT_EQ(nav.records, 4U);
  EXPECT_TRUE(nav.damage.empty());
  EXPECT_EQ(nav.log.clock(), NavClock::kUnknown) << "the device's own";
  const auto& velocities = samples_of(nav, NavQuantity::kVelocity);
  ASSERT_EQ(velocities.size(), 2U);
  EXPECT_EQ(velocities[0].value, Eigen::Vector3d(0.5, 0.25, -0.125)) << "not those of a beam";
  EXPECT_EQ(velocities[0].deviation.x(), 0.01);
  EXPECT_DOUBLE_EQ(velocities[0].time_s, 5.0);
  EXPECT_TRUE(velocities[0].valid);
  EXPECT_DOUBLE_EQ(velocities[1].time_s, 5.1) << "31 s late, and still then";
  EXPECT_FALSE(velocities[1].valid) << "its pretty numbers do not count";
  EXPECT_FALSE(samples_of(nav, NavQuantity::kRange).at(1).valid);
  EXPECT_EQ(samples_of(nav, NavQuantity::kPosition).at(0).value, Eigen::Vector3d(2, 1, -3));
  EXPECT_NEAR(samples_of(nav, NavQuantity::kAttitude).at(0).value.z(), 60 * kDegree_rad, 1e-12);
}

TEST(A50, OldReportsHaveTheSumOfTheirStepsAsTime) {
  const NavFile nav = read_as_a50(velocity("", "true") + velocity("", "true"));
  const auto& velocities = samples_of(nav, NavQuantity::kVelocity);
  ASSERT_EQ(velocities.size(), 2U);
  EXPECT_NEAR(velocities[1].time_s - velocities[0].time_s, 0.1, 1e-12);
}

TEST(A50, ReadsTheSerialProtocolWithAnyLineEnd) {
  const std::string log =
      "wrz,0.120,-0.400,2.000,y,1.30,1.855,1e-07;0;1.4;0;1.2;0;0.2;0;1e+09,7,14,123.00,1*50\r"
      "wru,0,0.070,1.10,-40,-95*9c\n"
      "wrp,49056.809,0.41,0.15,1.23,0.4,53.9,13.0,19.3,0*de\r\n";
  EXPECT_EQ(format_of(a50_file(log).view()), Format::kDvlA50);
  const NavFile nav = read_as_a50(log);
  EXPECT_EQ(nav.records, 3U);
  EXPECT_TRUE(nav.damage.empty());
  const auto& velocities = samples_of(nav, NavQuantity::kVelocity);
  ASSERT_EQ(velocities.size(), 1U);
  EXPECT_EQ(velocities[0].value, Eigen::Vector3d(0.12, 0.4, -2.0));
  EXPECT_EQ(velocities[0].deviation.x(), 1.855);
  EXPECT_DOUBLE_EQ(velocities[0].time_s, 7e-6);
  EXPECT_EQ(samples_of(nav, NavQuantity::kRange).at(0).value.x(), 1.3);
  EXPECT_EQ(samples_of(nav, NavQuantity::kPosition).at(0).value, Eigen::Vector3d(0.15, 0.41, -1.23));
  EXPECT_DOUBLE_EQ(samples_of(nav, NavQuantity::kPosition).at(0).time_s, 49056.809);
}

/// Lines of the serial protocol, with their checksums.
constexpr const char* kOldVelocity = "wrx,100.00,0.100,0.000,0.000,0.010,1.30,y,0*89\n";
constexpr const char* kBadPosition = "wrp,1637321409.000,0.41,0.15,1.23,0.4,53.9,13.0,19.3,1*f9\n";

// Kills velocities that count twice, half of them at the sum of the steps.
TEST(A50, TheDeprecatedFormOfAVelocityCountsAlone) {
  const std::string old = kOldVelocity;
  const NavFile nav = read_as_a50(old +
                                  "wrz,0.100,0.000,0.000,y,1.30,0.010,1e-07;0;1.4;0;1.2;0;0.2;0;1e+09,1637321409000000,"
                                  "1637321409100000,100.00,0*6a\n" +
                                  old +
                                  "wrz,0.100,0.000,0.000,y,1.30,0.010,1e-07;0;1.4;0;1.2;0;0.2;0;1e+09,1637321409100000,"
                                  "1637321409200000,100.00,0*b6\n");
  const auto& velocities = samples_of(nav, NavQuantity::kVelocity);
  ASSERT_EQ(velocities.size(), 2U);
  EXPECT_DOUBLE_EQ(velocities[0].time_s, 1637321409.0);
  EXPECT_DOUBLE_EQ(velocities[1].time_s, 1637321409.1);
  EXPECT_EQ(samples_of(read_as_a50(old + old), NavQuantity::kVelocity).size(), 2U);
}

// Kills an old log whose clock runs back by years behind its first position.
TEST(A50, TimesOfPositionsDoNotCountWhereVelocitiesHaveNone) {
  const auto position = [](const std::string& ts) {
    return R"({"ts":)" + ts +
           R"(,"x":0,"y":0,"z":0,"std":0,"roll":0,"pitch":0,"yaw":0,"type":"position_local"})"
           "\n";
  };
  const NavFile nav =
      read_as_a50(position("1637321409.0") + velocity("", "true") + position("1637321409.1") + velocity("", "true"));
  const auto& positions = samples_of(nav, NavQuantity::kPosition);
  ASSERT_EQ(positions.size(), 2U);
  EXPECT_DOUBLE_EQ(positions[0].time_s, 0.0);
  EXPECT_DOUBLE_EQ(positions[1].time_s, 0.1);
  EXPECT_TRUE(check_sources(nav.log));
}

// Kills positions that count though the device says that they are wrong.
TEST(A50, APositionIsAsGoodAsItsStatusAndDeviationSay) {
  const auto position = [](const std::string& more) {
    return R"({"ts":5,"x":1,"y":2,"z":3,"std":0.25,"roll":0,"pitch":0,"yaw":0,"type":"position_local")" + more + "}\n";
  };
  const NavFile nav =
      read_as_a50(position(R"(,"status":1)") + position(R"(,"status":0)") + position("") + kBadPosition);
  const auto& positions = samples_of(nav, NavQuantity::kPosition);
  const auto& attitudes = samples_of(nav, NavQuantity::kAttitude);
  ASSERT_EQ(positions.size(), 4U);
  ASSERT_EQ(attitudes.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const bool is_good = i == 1 || i == 2;
    EXPECT_EQ(positions[i].valid, is_good) << i;
    EXPECT_EQ(attitudes[i].valid, is_good) << i;
    EXPECT_EQ(positions[i].deviation, Eigen::Vector3d::Constant(i < 3 ? 0.25 : 0.4)) << i;
  }
}

TEST(A50, CountsDamageByKindAndPlace) {
  const std::string good = "wru,0,0.070,1.10,-40,-95*9c\n";
  const NavFile nav = read_as_a50(good + "wru,1,0.070,1.10,-40,-95*9c\n" + velocity("", "true") + "{\"type\":\"velo\n" +
                                  R"({"type":"velocity","vx":1,"vy":null,"vz":0,"velocity_valid":true})" + "\nnoise\n" +
                                  good + R"({"time":)");
  EXPECT_EQ(nav.records, 3U);
  ASSERT_EQ(nav.damage.size(), 4U);
  EXPECT_EQ(nav.damage[0].what, "wrong checksum");
  EXPECT_EQ(nav.damage[0].first_byte, good.size());
  EXPECT_EQ(nav.damage[1].what, "line that is not a report");
  EXPECT_EQ(nav.damage[1].count, 2U);
  EXPECT_EQ(nav.damage[2].what, "report without its numbers");
  EXPECT_EQ(nav.damage[3].what, "cut off at the end");
  EXPECT_FALSE(read_nav(a50_file(good + "noise\n"), Damage::kFail));
  // The vendor's example for water tracking has a wrong checksum.
  EXPECT_FALSE(
      format_of(a50_file("wrs,0.120,-0.400,2.000,y,1.855,1e-07;0;1.4;0;1.2;0;0.2;0;1e+09,7,14,123.00,1*50\n").view()));
}

// Kills a dive on two dates, of a host whose clock was set meanwhile.
TEST(A50, TheClockOfTheHostMayBeSetLaterOrBack) {
  for (const bool is_set_back : {false, true}) {
    std::string log = "timestamp,vx,vy,vz,altitude,velocity_valid,time_of_validity,time_of_transmission\n";
    for (int i = 0; i < 60; ++i) {
      const bool is_dated = (i < 30) == is_set_back;
      log += fmt::format("{}.{},1,2,3,0.5,True,{},{}\n", (is_dated ? 1'700'000'000 : 100) + i / 10, i % 10,
                         5'000'000 + i * 100'000, 5'000'000 + i * 100'000);
    }
    const NavFile nav = read_as_a50(log);
    EXPECT_EQ(nav.records, 60U);
    EXPECT_EQ(nav.log.clock(), NavClock::kUnix);
    ASSERT_EQ(nav.settings.size(), 1U);
    EXPECT_NEAR(nav.settings[0].by_s.value_or(0.0), is_set_back ? -1'699'999'900.0 : 1'699'999'900.0, 1e-5);
    const auto& velocities = samples_of(nav, NavQuantity::kVelocity);
    ASSERT_EQ(velocities.size(), 60U);
    for (std::size_t i = 0; i < 60; ++i) {
      ASSERT_NEAR(velocities[i].time_s, 1.7e9 + 0.1 * static_cast<double>(i), 1e-5);
    }
  }
}

TEST(A50, ReadsATableWithTheTimesOfTheHost) {
  const std::string log =
      "timestamp,vx,vy,vz,altitude,velocity_valid,time_of_validity,time_of_transmission\n"
      "1700000000.5,1,2,3,0.5,True,1000000,4000000\n"
      "1700000001.5,1,2,3,0.5,False,2000000,5000000\n"
      "1700000002,1,2,3\n";
  EXPECT_EQ(format_of(a50_file(log).view()), Format::kDvlA50);
  const NavFile nav = read_as_a50(log);
  EXPECT_EQ(nav.log.clock(), NavClock::kUnix);
  const auto& velocities = samples_of(nav, NavQuantity::kVelocity);
  ASSERT_EQ(velocities.size(), 2U);
  EXPECT_DOUBLE_EQ(velocities[0].time_s, 1699999997.5) << "when it was true, not when it came";
  EXPECT_TRUE(velocities[0].valid);
  EXPECT_FALSE(velocities[1].valid);
  ASSERT_EQ(nav.damage.size(), 1U);
}

TEST(A50, TheRecordingHasAsManyReportsAsItsReadmeSays) {
  const auto path = std::filesystem::path(PINGVOX_SHARED_DATA) / "dvl-a50/20211119-133009dvl_data_time.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto file = read_file(path.string());
  ASSERT_TRUE(file);
  const auto nav = read_nav(*file);
  ASSERT_TRUE(nav) << nav.error().message;
  EXPECT_EQ(nav->records, 751U);
  EXPECT_TRUE(nav->damage.empty());
  const NavSource* source = nav->log.best(NavQuantity::kVelocity);
  ASSERT_NE(source, nullptr);
  const NavSummary summary = summary_of(*source);
  EXPECT_EQ(summary.samples, 751U);
  EXPECT_EQ(summary.samples - summary.invalid, 745U);
  EXPECT_NEAR(summary.to_s - summary.from_s, 59.0, 0.1);
}

std::string position_at(int tenth, double x_m) {
  return R"({"ts":)" + std::to_string(1000.0 + 0.1 * tenth) + R"(,"x":)" + std::to_string(x_m) +
         R"(,"y":0,"z":0,"std":0.1,"roll":0,"pitch":0,"yaw":30,"status":0,"format":"json_v3","type":"position_local"})"
         "\n";
}

// One position 20 m aside, and no beam of the rest of the dive had a pose.
TEST(A50, AnOutlierOfThePositionEndsNothing) {
  std::string log;
  for (int i = 0; i < 200; ++i) log += position_at(i, i == 50 ? 20.0 : 2.0 + 0.01 * i);
  const NavFile nav = read_as_a50(log);
  const NavSource* const positions = nav.log.best(NavQuantity::kPosition);
  ASSERT_TRUE(positions);
  EXPECT_EQ(summary_of(*positions).invalid, 1U);
  EXPECT_FALSE(positions->samples.at(50).valid);
  EXPECT_EQ(summary_of(*nav.log.best(NavQuantity::kAttitude)).invalid, 0U);
}

// A dead reckoning that was reset to zero made two maps in one.
TEST(A50, AResetOfTheDeadReckoningIsLeftOutWithItsAttitudes) {
  std::string log;
  for (int i = 0; i < 200; ++i) log += position_at(i, i < 150 ? 5.0 : 0.01 * (i - 150));
  const NavFile nav = read_as_a50(log);
  for (const NavQuantity quantity : {NavQuantity::kPosition, NavQuantity::kAttitude}) {
    const NavSource* const source = nav.log.best(quantity);
    ASSERT_TRUE(source);
    EXPECT_EQ(summary_of(*source).invalid, 50U) << name_of(quantity);
  }
  EXPECT_TRUE(nav.log.best(NavQuantity::kPosition)->steps.at(0).is_new_start);
}

}  // namespace
}  // namespace pingvox
