#include "live/clock_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace pingvox::test {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

using Differences = std::vector<ClockWatch::Difference>;

/// Messages of a sonar, and of one device, by how much later than their stamps they come at a time.
struct Lags {
  double (*beam_s)(double) = [](double) { return 0.05; };
  double (*sample_s)(double) = [](double) { return 0.02; };
  double samples_per_s = 20.0;
};

/// From one time to another, with ten beams a second.
Differences run(ClockWatch& watch, const Lags& lags, double from_s, double to_s) {
  constexpr int kBeamsPerS = 10, kStepsPerS = 20;
  Differences found;
  const auto steps_per_sample = static_cast<int>(kStepsPerS / lags.samples_per_s);
  for (int step = static_cast<int>(from_s * kStepsPerS); step < static_cast<int>(to_s * kStepsPerS); ++step) {
    const double now_s = static_cast<double>(step) / kStepsPerS;
    if (step % (kStepsPerS / kBeamsPerS) == 0) watch.add_beam(lags.beam_s(now_s));
    if (step % steps_per_sample == 0) watch.add_sample(0, lags.sample_s(now_s));
    for (const ClockWatch::Difference& one : watch.update(now_s)) found.push_back(one);
  }
  return found;
}

double held_up(double now_s) {
  return 0.02 + 1.5 * (now_s - static_cast<int>(now_s));
}

TEST(ClockWatch, TellsOnceThatADeviceIsAhead) {
  ClockWatch watch(1);
  const Lags ahead{.sample_s = [](double now_s) { return held_up(now_s) - 3.0; }};
  EXPECT_THAT(run(watch, ahead, 0.0, 9.0), IsEmpty()) << "it may be a line that stalls";
  const Differences found = run(watch, ahead, 9.0, 60.0);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found.front().device, 0U);
  EXPECT_NEAR(found.front().ahead_s, 3.0, 0.1);
  // Again when it agreed meanwhile.
  EXPECT_THAT(run(watch, {}, 60.0, 80.0), IsEmpty());
  EXPECT_THAT(run(watch, ahead, 80.0, 100.0), SizeIs(1));
}

TEST(ClockWatch, TellsOfSecondsBehindAndOfSlowNavigation) {
  ClockWatch watch(1);
  const Differences found = run(watch, {.sample_s = [](double) { return 0.72; }, .samples_per_s = 1.0}, 0.0, 30.0);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_NEAR(found.front().ahead_s, -0.67, 0.01);
}

// A vehicle whose clock nobody has set is no news where all of it has this clock.
TEST(ClockWatch, ClocksThatAreWrongTogetherAgree) {
  ClockWatch watch(1);
  const Lags lags{.beam_s = [](double) { return -19.9; }, .sample_s = [](double) { return -20.0; }};
  EXPECT_THAT(run(watch, lags, 0.0, 60.0), IsEmpty());
}

// Kills warnings of what the way of messages does to them.
TEST(ClockWatch, MessagesThatAreHeldUpAreNoWrongClocks) {
  ClockWatch watch(1);
  // Bundles of a second and a half, as transforms come.
  EXPECT_THAT(run(watch, {.sample_s = held_up}, 0.0, 30.0), IsEmpty());
  EXPECT_THAT(run(watch, {.beam_s = held_up}, 30.0, 60.0), IsEmpty());
  // All of the sonar for six seconds, then one wrong stamp.
  const Lags stall{.beam_s = [](double now_s) { return now_s >= 63.0 && now_s < 69.0 ? 2.0 : 0.05; }};
  EXPECT_THAT(run(watch, stall, 60.0, 100.0), IsEmpty());
  const Lags glitch{.sample_s = [](double now_s) { return now_s == 103.0 ? -50.0 : 0.02; }};
  EXPECT_THAT(run(watch, glitch, 100.0, 130.0), IsEmpty());
}

TEST(ClockWatch, ASilentDeviceTellsNothing) {
  ClockWatch watch(2);
  EXPECT_THAT(run(watch, {}, 0.0, 60.0), IsEmpty()) << "of the second one";
  for (int now_s = 60; now_s < 120; ++now_s) {
    watch.add_sample(0, -3.0);
    EXPECT_THAT(watch.update(now_s), IsEmpty()) << "without beams";
  }
}

}  // namespace
}  // namespace pingvox::test
