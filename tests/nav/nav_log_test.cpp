#include "pingvox/nav/nav_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "pingvox/geometry/pose.hpp"

namespace pingvox {
namespace {

NavSource depths(std::string name, const std::vector<double>& times_s) {
  NavSource source{std::move(name), NavQuantity::kDepth, {}};
  for (const double time_s : times_s) {
    NavSample sample;
    sample.time_s = time_s;
    sample.value.x() = static_cast<double>(source.samples.size());
    source.samples.push_back(sample);
  }
  return source;
}

NavSource source_of_values(std::string name, NavQuantity quantity, const std::vector<double>& values) {
  NavSource source{std::move(name), quantity, {}};
  for (const double value : values) {
    NavSample sample;
    sample.time_s = static_cast<double>(source.samples.size());
    sample.value.x() = value;
    source.samples.push_back(sample);
  }
  return source;
}

TEST(NavLog, PutsSamplesInOrderAndKeepsThatOfEqualTimes) {
  const auto log = NavLog::make({depths("a", {3, 1, 2, 1}), depths("empty", {})}, NavClock::kBoot);
  ASSERT_TRUE(log) << log.error().message;
  ASSERT_EQ(log->sources().size(), 1U);
  std::vector<double> came;
  for (const NavSample& sample : log->sources()[0].samples) came.push_back(sample.value.x());
  EXPECT_THAT(came, testing::ElementsAre(1, 3, 2, 0));
}

// Two swapped messages of an echosounder were a clock that runs back, and the log was refused.
TEST(NavLog, SwappedSamplesAreLateAndAClockThatWasSetBackStaysBack) {
  std::vector<double> quick, quick_back;
  for (int i = 0; i < 100; ++i) quick.push_back(0.1 * i);
  std::rotate(quick.begin() + 30, quick.begin() + 33, quick.begin() + 48);  // three come 1.5 s late
  for (int i = 0; i < 100; ++i) quick_back.push_back(0.1 * i - (i < 50 ? 0.0 : 1.5));
  const auto log = NavLog::make(
      {depths("swapped", {0, 1.5, 3, 6, 4.5, 7.5}), depths("quick", quick), depths("at the end", {0, 1, 2, 3.5, 2}),
       depths("back", quick_back), depths("slow back", {0, 2, 4, 6, 4.5, 6.5, 8.5}),
       depths("far back", {1, 2, 3, 4, 5, 1, 6}), depths("ends back", {3, 4, 5, 3, 3.5})},
      NavClock::kBoot);
  ASSERT_TRUE(log) << log.error().message;
  const std::vector<NavSource>& sources = log->sources();
  ASSERT_EQ(sources.size(), 7U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_FALSE(sources[i].step_back) << sources[i].name;
    EXPECT_EQ(sources[i].late, i == 1 ? 3U : 1U) << sources[i].name;
    EXPECT_TRUE(std::ranges::is_sorted(sources[i].samples, {}, &NavSample::time_s)) << sources[i].name;
  }
  for (std::size_t i = 3; i < 7; ++i) {
    EXPECT_TRUE(sources[i].step_back) << sources[i].name;
    EXPECT_FALSE(check_source(sources[i])) << sources[i].name;
  }
}

// Kills a clock that is put in order without a word, one that is found in every queue, and a step between two logs.
TEST(NavLog, NotesWhereAClockWasSetBack) {
  const auto log =
      NavLog::make({depths("late", {1, 2, 3, 2.5, 4}), depths("back", {9, 10, 5, 6, 7, 11})}, NavClock::kBoot);
  ASSERT_TRUE(log);
  EXPECT_FALSE(log->sources()[0].step_back);
  const auto& step = log->sources()[1].step_back;
  ASSERT_TRUE(step);
  EXPECT_EQ(step->from_s, 10.0);
  EXPECT_EQ(step->to_s, 5.0);
  EXPECT_EQ(step->late, 3U);
  const auto checked = check_sources(*log);
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message,
              testing::HasSubstr("depth of back runs back by 5.000 s, from 10.000 to 5.000 s"));

  NavSource both = depths("a", {11, 12});
  add_samples(depths("a", {1, 2}), both);
  const auto joined = NavLog::make({both}, NavClock::kBoot);
  ASSERT_TRUE(joined);
  EXPECT_TRUE(check_sources(*joined));
  EXPECT_EQ(joined->sources()[0].samples.front().time_s, 1.0);
}

TEST(NavLog, RefusesWhatIsNotFinite) {
  const auto log = NavLog::make({depths("a", {1, std::nan("")})}, NavClock::kBoot);
  ASSERT_FALSE(log);
  EXPECT_EQ(log.error().message, "depth of a: sample 1 has a number that is not finite");
}

TEST(NavLog, TakesTheSourceWithMostValidSamples) {
  NavSource invalid = depths("invalid", {1, 2, 3});
  for (NavSample& sample : invalid.samples) sample.valid = false;
  const auto log =
      NavLog::make({invalid, depths("few", {1}), depths("many", {1, 2}), depths("as many", {1, 2})}, NavClock::kUnix);
  ASSERT_TRUE(log);
  ASSERT_NE(log->best(NavQuantity::kDepth), nullptr);
  EXPECT_EQ(log->best(NavQuantity::kDepth)->name, "as many") << "of equals by name, whatever the order of the files";
  EXPECT_EQ(log->best(NavQuantity::kFix), nullptr);
}

// Kills the barometer within the hull as a depth, and hectopascals.
TEST(DepthSource, IsThatOfThePressureInWaterWhereThereIsNoDepth) {
  const NavSource inside = source_of_values("inside", NavQuantity::kPressure, {101'000, 102'000, 103'000, 103'000}),
                  outside = source_of_values("outside", NavQuantity::kPressure, {101'325, 151'325, 201'325});
  const auto depth = depth_source(*NavLog::make({inside, outside}, NavClock::kBoot));
  ASSERT_TRUE(depth);
  EXPECT_EQ(depth->name, "outside");
  EXPECT_EQ(depth->quantity, NavQuantity::kDepth);
  // 100 kPa over 10.05 kPa for a metre of sea water.
  EXPECT_NEAR(depth->samples[2].value.x(), 9.95, 0.01);
  EXPECT_NEAR(depth->samples[0].value.x(), 0.0, 1e-9);
  EXPECT_FALSE(depth_source(*NavLog::make({inside}, NavClock::kBoot))) << "air";
  EXPECT_EQ(depth_source(*NavLog::make({outside, depths("bar", {1, 2})}, NavClock::kBoot))->name, "bar");
}

// Kills a step that is not the one back to the sample that is farthest behind.
TEST(NavLog, NotesTheStepToTheSampleThatIsFarthestBehind) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::vector<double> times_s;
    for (int i = 0; i < 12; ++i) times_s.push_back(0.25 * static_cast<double>(random() % 40));
    double latest_s = times_s.front(), farthest_s = 0.0;
    std::size_t late = 0;
    for (const double time_s : times_s) {
      latest_s = std::max(latest_s, time_s);
      farthest_s = std::max(farthest_s, latest_s - time_s);
      if (latest_s - time_s > kMaxLate_s) ++late;
    }
    const auto log = NavLog::make({depths("a", times_s)}, NavClock::kBoot);
    ASSERT_TRUE(log);
    const auto& step = log->sources()[0].step_back;
    ASSERT_EQ(step.has_value(), late > 0);
    if (!step) continue;
    EXPECT_EQ(log->sources()[0].late, late);
    EXPECT_EQ(step->from_s - step->to_s, farthest_s);
  }
}

// Kills the first gauge that is under water instead of the deepest, whatever their order.
TEST(DepthSource, IsThatOfTheHighestPressure) {
  const std::vector<NavSource> gauges = {source_of_values("low", NavQuantity::kPressure, {101'325, 120'000}),
                                         source_of_values("high", NavQuantity::kPressure, {101'325, 151'325}),
                                         source_of_values("middle", NavQuantity::kPressure, {101'325, 140'000})};
  for (std::size_t first = 0; first < gauges.size(); ++first) {
    std::vector<NavSource> turned;
    for (std::size_t i = 0; i < gauges.size(); ++i) turned.push_back(gauges[(first + i) % gauges.size()]);
    const auto depth = depth_source(*NavLog::make(turned, NavClock::kBoot));
    ASSERT_TRUE(depth);
    EXPECT_EQ(depth->name, "high");
  }
}

// Kills a deviation of a depth that is one of a pressure.
TEST(DepthSource, HasTheDeviationOfItsMetres) {
  NavSource gauge = source_of_values("bar", NavQuantity::kPressure, {101'325, 111'325, 151'325});
  for (NavSample& sample : gauge.samples) sample.deviation.x() = 10'000.0;
  const auto depth = depth_source(*NavLog::make({gauge}, NavClock::kBoot));
  ASSERT_TRUE(depth);
  const double metres = depth->samples[1].value.x() - depth->samples[0].value.x();  // of 10,000 Pa
  for (const NavSample& sample : depth->samples) EXPECT_NEAR(sample.deviation.x(), metres, 1e-9);
}

// Kills a step back of a part that is forgotten when the parts of a source are joined, or made by joining them.
TEST(NavLog, PartsOfASourceKeepTheirStepBack) {
  const auto made = [](const std::vector<double>& times_s) {
    return NavLog::make({depths("a", times_s)}, NavClock::kUnix)->sources().front();
  };
  const NavSource early = made({0, 1, 2}), late = made({10, 11, 12}), back = made({20, 25, 21, 26});
  ASSERT_TRUE(back.step_back);
  for (const NavSource& other : {early, late}) {
    NavSource joined = other;
    add_samples(back, joined);
    EXPECT_FALSE(check_source(joined));
    joined = back;
    add_samples(other, joined);
    EXPECT_FALSE(check_source(joined));
  }
  NavSource joined = late;
  add_samples(early, joined);
  EXPECT_TRUE(check_source(joined));
  EXPECT_EQ(joined.samples.front().time_s, 0.0);
}

// Kills the inside of the hull as water, and the air before the dive.
TEST(WaterAround, IsAsWarmAsTheColdestSensorUsuallyIs) {
  using enum NavQuantity;
  const NavSource hull = source_of_values("hull", kTemperature, {28, 30, 31}),
                  outside = source_of_values("outside", kTemperature, {19, 12, 12.5, 12, 12.1}),
                  broken = source_of_values("broken", kTemperature, {-273, -273, -273}),
                  none = source_of_values("none", kTemperature, {0, 0}),
                  depth = source_of_values("bar", kDepth, {0, 9, 8}), surface = source_of_values("bar", kDepth, {-0.2});
  const auto water = water_around(*NavLog::make({hull, broken, none, outside, depth}, NavClock::kBoot));
  ASSERT_TRUE(water);
  EXPECT_EQ(water->temperature_c, 12.1);
  EXPECT_EQ(water->depth_m, 8.0);
  const auto at_surface = water_around(*NavLog::make({outside, surface}, NavClock::kBoot));
  ASSERT_TRUE(at_surface);
  EXPECT_EQ(at_surface->depth_m, 0.0);
  EXPECT_FALSE(water_around(*NavLog::make({broken, depth}, NavClock::kBoot)));
}

TEST(NavSummary, CountsGapsAndIgnoresRepeatedTimes) {
  NavSource source = depths("a", {0, 0.1, 0.1, 0.2, 0.3, 5, 5.1, 5.2});
  source.samples[1].valid = false;
  const NavSummary summary = summary_of(source);
  EXPECT_EQ(summary.samples, 8U);
  EXPECT_EQ(summary.invalid, 1U);
  EXPECT_NEAR(summary.rate_hz, 10.0, 1e-9);
  EXPECT_EQ(summary.gaps, 1U);
  EXPECT_EQ(summary.from_s, 0.0);
  EXPECT_EQ(summary.to_s, 5.2);
  EXPECT_EQ(summary_of(depths("one", {7})).rate_hz, 0.0);
  EXPECT_EQ(summary_of(depths("still", {7, 7})).rate_hz, 0.0);
}

// Kills short pauses of quick sensors that are gaps, and long ones of slow sensors.
TEST(NavSummary, AGapIsAtLeastHalfASecondAndFiveSteps) {
  for (const double step_s : {0.01, 0.05, 0.1, 0.5, 2.0}) {
    SCOPED_TRACE(step_s);
    const double limit_s = std::max(0.5, 5.0 * step_s);
    for (const double share : {0.9, 1.1}) {
      std::vector<double> times_s;
      for (int i = 0; i < 20; ++i) times_s.push_back(i * step_s + (i >= 10 ? share * limit_s - step_s : 0.0));
      EXPECT_EQ(summary_of(depths("a", times_s)).gaps, share > 1.0 ? 1U : 0U) << share;
    }
  }
}

TEST(NavQuantity, IsFoundByItsName) {
  for (const auto quantity :
       {NavQuantity::kVelocity, NavQuantity::kTurnRate, NavQuantity::kPressure, NavQuantity::kTemperature}) {
    EXPECT_EQ(nav_quantity_of(name_of(quantity)), quantity);
  }
  EXPECT_EQ(nav_quantity_of("speed"), std::nullopt);
}

// The oracle turns vectors by matrices instead of angles.
TEST(FromNed, TurnsAnAttitudeAsItTurnsVectors) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(-1.5, 1.5), heading(-3.0, 6.0);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d rpy(angle(random), angle(random), heading(random));
    const Eigen::Vector3d frd(angle(random), angle(random), angle(random));
    const Eigen::Vector3d ned = pose_from_rpy({0, 0, 0}, rpy.x(), rpy.y(), rpy.z()) * frd;
    const Eigen::Vector3d ours = from_ned::attitude(rpy);
    const Eigen::Vector3d enu = pose_from_rpy({0, 0, 0}, ours.x(), ours.y(), ours.z()) * from_ned::body(frd);
    EXPECT_TRUE(enu.isApprox(from_ned::world(ned), 1e-12)) << rpy.transpose();
  }
  EXPECT_NEAR(from_ned::yaw(0.0), std::numbers::pi / 2, 1e-15);                 // north
  EXPECT_NEAR(from_ned::yaw(1.5 * std::numbers::pi), std::numbers::pi, 1e-15);  // west
}

}  // namespace
}  // namespace pingvox
