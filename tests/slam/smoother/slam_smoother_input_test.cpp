// The smoother on input that it cannot use, or hardly.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "pingvox/slam/slam_smoother.hpp"
#include "slam/smoother_in_basin.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

void expect_refused(const SlamSmoother& smoother, const char* reason) {
  const auto solved = smoother.solve();
  ASSERT_FALSE(solved);
  EXPECT_THAT(solved.error().message, HasSubstr(reason));
}

TEST(SlamSmoother, RefusesToGuessWithoutBeamsOrHeading) {
  const Basin basin;
  const auto sources = basin.sources();
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, sources);
  expect_refused(smoother, "no beams");

  SlamSmoother turning = smoother_of(basin, {});
  for (const Beam& beam : basin.beams()) turning.add(beam);
  add(turning, {sources[0]});
  expect_refused(turning, "no valid heading");
}

// Kills a trajectory that nothing tells: a vehicle that stands still, or goes on for ever.
TEST(SlamSmoother, RefusesToGuessWithoutVelocityAndEchoes) {
  const Basin basin{.duration_s = 100.0};
  for (const bool has_heading : {true, false}) {
    SlamSmoother smoother = smoother_of(basin, {});
    if (has_heading) add(smoother, {basin.sources()[1]});
    for (Beam beam : basin.beams()) {
      std::ranges::fill(beam.intensities, std::uint8_t{0});
      smoother.add(std::move(beam));
    }
    expect_refused(smoother, "0 of 9 sweeps match");
  }
}

TEST(SlamSmoother, RefusesAHeadingOfAnotherTimeWithoutVelocity) {
  const Basin basin{.duration_s = 100.0};
  NavSource compass = basin.sources()[1];
  for (NavSample& sample : compass.samples) sample.time_s += 10'000.0;
  const auto solved = solve_without_velocity(basin, {}, compass);
  ASSERT_FALSE(solved);
  EXPECT_THAT(solved.error().message, HasSubstr("do not overlap in time"));
}

TEST(SlamSmoother, RefusesNavigationOfAnotherTime) {
  const Basin basin;
  std::vector<NavSource> sources = basin.sources();
  for (NavSource& source : sources) {
    for (NavSample& sample : source.samples) sample.time_s += 10'000.0;
  }
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, sources);
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  expect_refused(smoother, "do not overlap in time");
}

TEST(SlamSmoother, RefusesNumbersThatAreNotFinite) {
  SlamSmoother smoother = smoother_of(Basin(), {});
  NavSample sample;
  sample.value.x() = std::numeric_limits<double>::quiet_NaN();
  const auto added = smoother.add("dvl", NavQuantity::kVelocity, sample);
  ASSERT_FALSE(added);
  EXPECT_THAT(added.error().message, HasSubstr("dvl"));
}

TEST(SlamSmoother, RefusesBeamsThatGoBackInTime) {
  const Basin basin;
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, basin.sources());
  std::vector<Beam> beams = basin.beams();
  beams[700].time_s = 3.0;
  for (const Beam& beam : beams) smoother.add(beam);
  expect_refused(smoother, "beam 699");
}

TEST(SlamSmoother, RefusesBeamsThatJumpInTime) {
  const Basin basin;
  SlamSmoother smoother = smoother_of(basin, {});
  std::vector<Beam> beams = basin.beams();
  beams.resize(400);
  beams.back().time_s = 1e9;
  for (const Beam& beam : beams) smoother.add(beam);
  std::vector<NavSource> sources = basin.sources();
  for (NavSource& source : sources) {
    source.samples.push_back(source.samples.back());
    source.samples.back().time_s = 2e9;
  }
  add(smoother, sources);
  expect_refused(smoother, "times jump");
}

// Kills turns that are made up where the clock of the navigation jumps ahead.
TEST(SlamSmoother, RefusesBeamsWhereNoHeadingIsKnown) {
  const Basin basin{.duration_s = 200.0};
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, with_jump_of_the_clock(basin.sources()));
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  expect_refused(smoother, "no heading is known from 100.000 to 3700.200 s, where there are 1000 beams");
}

// Kills a log whose clock was set back, added as a whole.
TEST(SlamSmoother, RefusesNavigationWhoseClockWasSetBack) {
  const Basin basin{.duration_s = 60.0};
  std::vector<NavSource> sources = basin.sources();
  for (NavSample& sample : sources[1].samples) sample.time_s -= sample.time_s > 30.0 ? 20.0 : 0.0;
  const auto log = NavLog::make(sources, NavClock::kUnknown);
  ASSERT_TRUE(log);
  SlamSmoother smoother = smoother_of(basin, {});
  const auto added = smoother.add(*log);
  ASSERT_FALSE(added);
  EXPECT_THAT(added.error().message, HasSubstr("heading of compass runs back"));
}

// Kills a solution without any step, whose calibration has no deviations.
TEST(SlamSmoother, ReckonsAlongOneSweepAlone) {
  const Basin basin{.duration_s = 10.0};
  const auto solved = solve(basin, {});
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_EQ(solved->report.pairs.count, 0U);
  EXPECT_FALSE(solved->report.velocity.check);
  EXPECT_GT(solved->calibration.velocity_yaw_rad.deviation, 0.0);
  EXPECT_LT(error_m(solved->trajectory), 0.5);
  SlamSmoother without = smoother_of(basin, {});
  add(without, {basin.sources()[1]});
  for (const Beam& beam : basin.beams()) without.add(beam);
  expect_refused(without, "only one sweep");
}

TEST(SlamSmoother, RefusesVelocitiesThatNoVehicleHas) {
  const Basin basin{.duration_s = 60.0};
  for (const double velocity_m_s : {40.0, 1e6, 1e300}) {
    SlamSmoother smoother = smoother_of(basin, {});
    add(smoother, with_velocity_ahead(velocity_m_s, basin.sources()));
    for (const Beam& beam : basin.beams()) smoother.add(beam);
    expect_refused(smoother, velocity_m_s > 100.0 ? "is beyond 100 m/s" : "m/s most of the time");
  }
}

TEST(SlamSmoother, NeedsNoEchoToReckon) {
  const Basin basin;
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, basin.sources());
  for (Beam beam : basin.beams()) {
    std::ranges::fill(beam.intensities, std::uint8_t{0});
    smoother.add(std::move(beam));
  }
  const auto solved = smoother.solve();
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_EQ(solved->report.pairs.count, 0U);
}

}  // namespace
}  // namespace pingvox::test
