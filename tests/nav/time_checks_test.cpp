#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "pingvox/nav/nav_log.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;

/// Turns slowly.
NavSource headings(double from_s, double step_s) {
  NavSource source{"compass", NavQuantity::kHeading, {}};
  for (int i = 0; i < 50; ++i) {
    NavSample sample;
    sample.time_s = from_s + step_s * i;
    sample.value.x() = 0.01 * i;
    source.samples.push_back(sample);
  }
  return source;
}

NavSource source_in_log(NavSource source) {
  return NavLog::make({std::move(source)}, NavClock::kUnix)->sources().front();
}

// Kills times in ms, us and ns since 1970: that the logs do not overlap says nothing of the reason.
TEST(TimeChecks, DatesThatAreNotInSecondsAreAFault) {
  EXPECT_THAT(source_in_log(headings(1.7e12, 100.0)).fault,
              HasSubstr("thousands of years after 1970: are they in ms?"));
  EXPECT_THAT(source_in_log(headings(1.7e15, 1e5)).fault, HasSubstr("are they in us?"));
  EXPECT_THAT(source_in_log(headings(1.7e18, 1e8)).fault, HasSubstr("are they in ns?"));
  EXPECT_EQ(source_in_log(headings(1.7e9, 0.1)).fault, "");
}

// Kills a heading of a log in ms that is known every 100 s, by which a vehicle stands still.
TEST(TimeChecks, AHeadingIsNotMeasuredEveryMinute) {
  EXPECT_THAT(source_in_log(headings(0.0, 100.0)).fault, HasSubstr("a sample every 100 s: are its times in ms?"));
  EXPECT_THAT(source_in_log(headings(0.0, 1e5)).fault, HasSubstr("are its times in us?"));
  EXPECT_THAT(source_in_log(headings(0.0, 1e8)).fault, HasSubstr("are its times in ns?"));
  const NavSource seldom = source_in_log(headings(0.0, 20.0));
  EXPECT_EQ(seldom.fault, "");
  EXPECT_THAT(seldom.doubt, HasSubstr("a sample every 20 s: are its times in ms?"));
  EXPECT_EQ(source_in_log(headings(0.0, 5.0)).doubt, "");
  NavSource fixes = headings(0.0, 100.0);
  fixes.quantity = NavQuantity::kFix;
  for (NavSample& sample : fixes.samples) sample.value *= 1e-6;
  EXPECT_EQ(source_in_log(fixes).fault, "") << "of an acoustic positioning system";
}

TEST(TimeChecks, TimesInDaysAreNamed) {
  EXPECT_THAT(source_in_log(headings(45'244.9, 0.1 / 86'400.0)).fault,
              HasSubstr("samples in a second: are its times in hours or days?"));
}

}  // namespace
}  // namespace pingvox
