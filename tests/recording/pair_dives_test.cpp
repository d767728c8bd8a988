#include "recording/pair_dives.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace pingvox::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Clock = NavTimes::Clock;

constexpr double kHour_s = 3600.0;
/// 2026-01-01 00:00 UTC.
constexpr double kYear_s = 1'767'225'600.0;

LogTimes log(const std::string& path, double from_s, double to_s, std::optional<double> zero_s = std::nullopt) {
  return {path, {from_s, to_s}, zero_s, zero_s == 0.0};
}
NavTimes nav(const std::string& path, double from_s, double to_s, Clock clock = Clock::kUnknown,
             const std::string& source = "GPS") {
  return {path, {from_s, to_s}, clock, {{source, NavQuantity::kFix, {from_s, to_s}}}};
}

TEST(PairByTime, TakesAllNavigationThatOverlaps) {
  const std::vector<LogTimes> logs = {log("a", 0, 10), log("b", 20, 30), log("c", 40, 50)};
  const std::vector<NavTimes> navs = {nav("first", -5, 25), nav("rest", 26, 29),
                                      nav("dvl", 9, 35, Clock::kUnknown, "DVL")};
  const auto pairs = pair_by_time(logs, navs, std::nullopt);
  EXPECT_THAT(pairs[0].navs, ElementsAre(0U, 2U));
  EXPECT_THAT(pairs[1].navs, ElementsAre(0U, 1U, 2U));
  EXPECT_THAT(pairs[2].navs, IsEmpty());
  EXPECT_THAT(pairs[2].reason,
              HasSubstr("no navigation at its time: of dvl, the nearest, the navigation ends 35.000 s, "
                        "the log begins 40.000 s"));
}

TEST(PairByTime, TakesThatOfItsFolderOfTwoThatTellTheSame) {
  const std::vector<LogTimes> logs = {log("one/a", 0, 10), log("two/b", 1, 11), log("three/c", 2, 12)};
  const std::vector<NavTimes> navs = {nav("one/nav", 0, 10), nav("two/nav", 0, 10)};
  const auto pairs = pair_by_time(logs, navs, std::nullopt);
  EXPECT_THAT(pairs[0].navs, ElementsAre(0U));
  EXPECT_THAT(pairs[1].navs, ElementsAre(1U));
  EXPECT_THAT(pairs[2].navs, IsEmpty());
  EXPECT_THAT(pairs[2].reason, HasSubstr("one/nav and two/nav both have GPS at its time"));
  EXPECT_THAT(pairs[2].in_conflict, ElementsAre(0U, 1U));
  const std::vector<NavTimes> bags = {nav("two/b", 0, 10), nav("two/c", 0, 10)};
  EXPECT_THAT(pair_by_time(logs, bags, std::nullopt)[1].navs, ElementsAre(0U)) << "a bag has its own";
}

// Kills a zone for each log alone: with eight hours more the first one fits the second navigation as well.
TEST(PairByTime, FindsTheZoneThatFitsMostLogs) {
  const double local_s = kYear_s - 7 * kHour_s;
  std::vector<LogTimes> logs = {log("a", 0, 600, local_s + kHour_s), log("b", 0, 600, local_s + 9 * kHour_s + 1200)};
  const std::vector<NavTimes> navs = {
      nav("a.tlog", kYear_s + kHour_s - 60, kYear_s + kHour_s + 660, Clock::kDates),
      nav("b.tlog", kYear_s + 9 * kHour_s + 1140, kYear_s + 9 * kHour_s + 1860, Clock::kDates),
      nav("other", kYear_s + 4 * kHour_s, kYear_s + 4 * kHour_s + 800, Clock::kDates)};
  for (LogTimes& one : logs) one.are_dates_own = false;
  const auto pairs = pair_by_time(logs, navs, std::nullopt);
  EXPECT_THAT(pairs[0].navs, ElementsAre(0U));
  EXPECT_THAT(pairs[1].navs, ElementsAre(1U));
  ASSERT_TRUE(pairs[0].offset_s);
  EXPECT_EQ(*pairs[0].offset_s, -7 * kHour_s - (local_s + kHour_s));
  const auto alone = pair_by_time(std::span(logs).first(1), navs, std::nullopt);
  EXPECT_THAT(alone[0].navs, IsEmpty());
  EXPECT_THAT(alone[0].reason, HasSubstr("may be in UTC-"));
  const auto given = pair_by_time(std::span(logs).first(1), navs, -7 * kHour_s - (local_s + kHour_s));
  EXPECT_THAT(given[0].navs, ElementsAre(0U));
  EXPECT_FALSE(given[0].offset_s);
}

TEST(PairByTime, TakesDatesAsUtcWhereTheyFit) {
  const std::vector<LogTimes> logs = {log("a", kYear_s, kYear_s + 600, 0.0)};
  const std::vector<NavTimes> navs = {nav("all", kYear_s - 20 * kHour_s, kYear_s + 20 * kHour_s, Clock::kDates)};
  const auto pairs = pair_by_time(logs, navs, std::nullopt);
  EXPECT_THAT(pairs[0].navs, ElementsAre(0U));
  EXPECT_FALSE(pairs[0].offset_s);
}

TEST(PairByTime, JoinsWhatCountsFromAStartByFolder) {
  const std::vector<LogTimes> logs = {log("one/a", 0, 10), log("two/b", 20, 30), log("two/c", 40, 50)};
  const std::vector<NavTimes> navs = {nav("one/nav", 0, 10), nav("one/dvl", 500, 600, Clock::kStart, "DVL"),
                                      nav("two/dvl", 500, 600, Clock::kStart, "DVL")};
  const auto pairs = pair_by_time(logs, navs, std::nullopt);
  EXPECT_THAT(pairs[0].navs, ElementsAre(0U, 1U));
  EXPECT_THAT(pairs[1].navs, IsEmpty());
  const auto alone = pair_by_time(std::span(logs).first(2), std::span(navs).last(1), std::nullopt);
  EXPECT_THAT(alone[0].navs, IsEmpty());
  EXPECT_THAT(alone[0].reason, HasSubstr("has no dates"));
  EXPECT_THAT(alone[1].navs, ElementsAre(0U));
}

}  // namespace
}  // namespace pingvox::test
