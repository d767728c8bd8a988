#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "pingvox/io/format.hpp"
#include "pingvox/io/nav.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

Result<NavFile> read_as_csv(std::string_view text, Damage damage = Damage::kSkip) {
  return read_nav({"nav.csv", bytes_of(text)}, damage);
}

TEST(NavCsv, TakesColumnsByNameAndLeavesOutUnknownOnes) {
  const std::string_view text =
      "# clock: boot\n"
      "quantity, note, time_s, source, x, y, z, sd_x, sd_y, sd_z, valid\n"
      "velocity,a,1.5,dvl,1,-2,0.5,0.1,,0.3,0\n"
      "depth,b,2,bar,3,,,,,,\n";
  EXPECT_EQ(format_of(bytes_of(text)), Format::kNavCsv);
  const auto nav = read_as_csv(text);
  ASSERT_TRUE(nav) << nav.error().message;
  EXPECT_EQ(nav->log.clock(), NavClock::kBoot);
  ASSERT_EQ(nav->log.sources().size(), 2U);
  const NavSource& dvl = nav->log.sources()[0];
  EXPECT_EQ(dvl.name, "dvl");
  EXPECT_EQ(dvl.samples.at(0).time_s, 1.5);
  EXPECT_EQ(dvl.samples[0].value, Eigen::Vector3d(1, -2, 0.5));
  EXPECT_EQ(dvl.samples[0].deviation.x(), 0.1);
  EXPECT_TRUE(std::isnan(dvl.samples[0].deviation.y()));
  EXPECT_FALSE(dvl.samples[0].valid);
  EXPECT_TRUE(nav->log.sources()[1].samples.at(0).valid);
}

// As editors and spreadsheets leave it. Kills a clock that is only known in the first bytes.
TEST(NavCsv, TheClockIsInAnyCommentAboveTheColumns) {
  constexpr std::string_view kSamples = "time_s,source,quantity,x,y,z\n1,dvl,velocity,1,2,3\n";
  for (const std::string_view comments :
       {"\xef\xbb\xbf# clock: unix\n", "# clock: unix,,,,,\r\n", "\n# a dive\n# clock: unix\n"}) {
    const auto nav = read_as_csv(fmt::format("{}{}", comments, kSamples));
    ASSERT_TRUE(nav) << nav.error().message;
    EXPECT_EQ(nav->log.clock(), NavClock::kUnix) << comments;
  }
  const auto nav = read_as_csv(fmt::format("{}# clock: unix\n", kSamples));
  ASSERT_TRUE(nav);
  EXPECT_EQ(nav->log.clock(), NavClock::kUnknown) << "below the samples";
}

TEST(NavCsv, LeavesOutLinesThatAreNoSample) {
  const auto nav = read_as_csv(
      "time_s,source,quantity,x,y,z\n"
      "1,dvl,velocity,1,2\n"
      "nan,dvl,velocity,1,2,3\n"
      "1,dvl,speed,1,2,3\n"
      "1,,velocity,1,2,3\n"
      "1,dvl,velocity,1,2,\n"
      "1,dvl,velocity,1,2,3,4\n"
      "1,dvl,velocity,1,2,3\n");
  ASSERT_TRUE(nav);
  EXPECT_EQ(nav->records, 1U);
  ASSERT_EQ(nav->damage.size(), 1U);
  EXPECT_EQ(nav->damage[0].count, 6U);
  EXPECT_EQ(nav->damage[0].first_byte, 29U);
}

// Another notation skipped all lines, and nothing said which word was not understood.
TEST(NavCsv, NamesTheFirstWordThatIsNotUnderstood) {
  const auto note_of = [](std::string_view line) {
    const auto nav = read_as_csv(fmt::format("time_s,source,quantity,x,y,z,sd_x,sd_y,sd_z,valid\n{}\n", line));
    return nav && !nav->notes.empty() ? nav->notes.front() : "";
  };
  EXPECT_EQ(note_of("2023-11-14T22:13:20,P,position,1,2,3,,,,1"),
            "1 of 1 lines are not samples, the first: line 2: time_s '2023-11-14T22:13:20' is not a finite number of "
            "seconds");
  EXPECT_THAT(note_of("1,P,orientation,1,2,3,,,,1"),
              testing::HasSubstr("quantity 'orientation' is not one of velocity, "));
  EXPECT_THAT(note_of("1,P,position,1,2,3,,,,ok"), testing::HasSubstr("valid 'ok' is neither 0 nor 1"));
  EXPECT_THAT(note_of("1,P,position,1,?,3,,,,1"), testing::HasSubstr("y '?' is not a finite number"));
  EXPECT_EQ(note_of("1,P,position,1,2,3,,,,1"), "");
}

TEST(NavCsv, TakesNamesInUpperCaseAndDeviationsThatAreNotKnown) {
  const auto nav = read_as_csv(
      "time_s,source,quantity,x,y,z,sd_x,sd_y,sd_z,valid\n"
      "1,P,Position,1,2,3,-1,-1,-1,1\n"
      "1,G,turn_rate,0.1,0.2,0.3,,,,1\n");
  ASSERT_TRUE(nav);
  ASSERT_EQ(nav->log.sources().size(), 2U);
  EXPECT_TRUE(std::isnan(nav->log.sources()[0].samples.at(0).deviation.x())) << "as ROS has it";
  EXPECT_EQ(nav->log.sources()[1].quantity, NavQuantity::kTurnRate);
  EXPECT_TRUE(nav->notes.empty());
}

TEST(NavCsv, ReadsBackWhatItWrote) {
  NavSource velocity{"DVL 1/194", NavQuantity::kVelocity, {}}, depth{"bar", NavQuantity::kDepth, {}};
  for (int i = 0; i < 100; ++i) {
    NavSample sample;
    sample.time_s = 1.7e9 + i / 3.0;
    sample.value = {i / 7.0, -i / 11.0, 1e-9 * i};
    if (i % 2 == 0) sample.deviation = {0.1 / 3, 0.2, 1e-12};
    sample.valid = i % 3 != 0;
    velocity.samples.push_back(sample);
    sample.value.tail<2>().setZero();
    sample.deviation.tail<2>().setConstant(std::nan(""));
    depth.samples.push_back(sample);
  }
  const auto log = NavLog::make({velocity, depth}, NavClock::kUnix);
  ASSERT_TRUE(log);
  std::stringstream text;
  ASSERT_EQ(write_nav_csv(*log, text).value_or(0), 200U);
  const auto back = read_as_csv(text.str());
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->log.clock(), NavClock::kUnix);
  ASSERT_EQ(back->log.sources().size(), 2U);
  for (std::size_t s = 0; s < 2; ++s) {
    const NavSource &a = log->sources()[s], &b = back->log.sources()[s];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.quantity, b.quantity);
    ASSERT_EQ(a.samples.size(), b.samples.size());
    for (std::size_t i = 0; i < a.samples.size(); ++i) {
      EXPECT_EQ(a.samples[i].time_s, b.samples[i].time_s);
      EXPECT_EQ(a.samples[i].value, b.samples[i].value);
      EXPECT_EQ(a.samples[i].valid, b.samples[i].valid);
      for (int n = 0; n < 3; ++n) {
        const double x = a.samples[i].deviation[n], y = b.samples[i].deviation[n];
        EXPECT_TRUE(x == y || (std::isnan(x) && std::isnan(y)));
      }
    }
  }
}

TEST(NavCsv, ValidIsOneOrZero) {
  const auto nav = read_as_csv(
      "time_s,source,quantity,x,y,z,valid\n1,dvl,velocity,1,2,3,true\n2,dvl,velocity,1,2,3,1\n3,dvl,velocity,1,2\n");
  ASSERT_TRUE(nav);
  EXPECT_EQ(nav->records, 1U);
  ASSERT_EQ(nav->damage.size(), 2U);
  EXPECT_EQ(nav->damage[0].what, "line whose valid is neither 0 nor 1");
}

}  // namespace
}  // namespace pingvox
