#include "pingvox/nav/device_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pingvox {
namespace {

constexpr double kHost_s = 1.6e9, kMinDelay_s = 0.02;

/// Received at 10 Hz, with delays of 20 to 40 ms and more as told.
template <class More, class Made>
std::vector<DeviceTime> messages(int count, const More& more_s, const Made& made_s) {
  std::vector<DeviceTime> times;
  for (int i = 0; i < count; ++i) {
    const double true_s = 0.1 * i;
    times.push_back({kHost_s + true_s + kMinDelay_s + 0.01 * (i % 3) + more_s(true_s), made_s(true_s)});
  }
  return times;
}

std::vector<double> as_they_arrive(const std::vector<DeviceTime>& times) {
  DeviceClock clock;
  std::vector<double> times_s;
  for (const DeviceTime& time : times) times_s.push_back(clock.add(time));
  return times_s;
}

constexpr auto kNoMore = [](double) { return 0.0; };

void expect_true_from(std::size_t first, const std::vector<double>& times_s, double tolerance_s) {
  for (std::size_t i = first; i < times_s.size(); ++i) {
    ASSERT_NEAR(times_s[i], kHost_s + 0.1 * static_cast<double>(i) + kMinDelay_s, tolerance_s) << i;
  }
}

// Kills times that run back where messages waited in a queue, and those of a device whose clock was set.
TEST(DeviceClock, OfARecordingKnowsWhatComesLater) {
  // Those of the first 5 s wait for 3 s, less and less, and the clock is set by a year at 100 s.
  constexpr double kDevice_s = 1.5e9, kYear_s = 3.2e7;
  const auto waits = [](double true_s) { return std::max(0.0, 3.0 - 0.6 * true_s); };
  const auto made = [](double true_s) { return kDevice_s + true_s + (true_s < 99.95 ? 0.0 : kYear_s); };
  const std::vector<double> times_s = device_times_s(messages(2000, waits, made));
  ASSERT_EQ(times_s.size(), 2000U);
  expect_true_from(0, times_s, 1e-5);
  EXPECT_TRUE(device_times_s({}).empty());
}

// Kills the smallest difference since the beginning: of a slow clock it is early by all that the clock lost since.
TEST(DeviceClock, FollowsOneThatDrifts) {
  for (const double drift : {-2e-4, 2e-4}) {
    const auto times = messages(200'000, kNoMore, [&](double true_s) { return 100.0 + true_s * (1.0 + drift); });
    constexpr double kLost_s = 120.0 * 2e-4;  // in two minutes
    expect_true_from(2, as_they_arrive(times), kLost_s);
    expect_true_from(0, device_times_s(times), kLost_s);
  }
}

// Kills a new start for a delay, which puts all messages of the queue at the time when it was emptied.
TEST(DeviceClock, IsNotSetByAQueueThatWaited) {
  const auto waits = [](double true_s) { return true_s > 30.0 && true_s < 40.0 ? 40.0 - true_s : 0.0; };
  const auto times = messages(1000, waits, [](double true_s) { return 100.0 + true_s; });
  expect_true_from(2, as_they_arrive(times), 1e-5);
  expect_true_from(0, device_times_s(times), 1e-5);
}

// Kills the old difference after a device restarted: it was 50 s old, and is 3 s away for booting.
TEST(DeviceClock, BeginsAgainWithADeviceThatWasStartedAnew) {
  const auto times =
      messages(1000, kNoMore, [](double true_s) { return true_s < 49.95 ? 10.0 + true_s : true_s - 47.0; });
  const std::vector<double> arriving_s = as_they_arrive(times);
  expect_true_from(502, arriving_s, 1e-5);
  expect_true_from(2, std::vector<double>(arriving_s.begin(), arriving_s.begin() + 500), 1e-5);
  expect_true_from(0, device_times_s(times), 1e-5);
}

// Kills a new start that is told of a queue, of a receiver that was stopped or whose clock was set, and of messages
// that come by two ways.
TEST(DeviceClock, ADeviceWasStartedAnewWhenItIsUpForLessThanThePause) {
  EXPECT_TRUE(was_restarted({1000.0, 600.0}, {1020.0, 5.0}));
  EXPECT_TRUE(was_restarted({1000.0, 600.0}, {1300.0, 280.0}));
  EXPECT_FALSE(was_restarted({1000.0, 600.0}, {1090.1, 600.1})) << "it waited";
  EXPECT_FALSE(was_restarted({1000.0, 600.0}, {1000.1, 690.0})) << "what came before waited";
  EXPECT_FALSE(was_restarted({1000.0, 600.0}, {1075.1, 600.1})) << "the receiver's clock was set";
  EXPECT_FALSE(was_restarted({1000.0, 600.0}, {1.7e9, 600.1})) << "to the date";
  EXPECT_FALSE(was_restarted({1000.0, 600.0}, {1000.1, 598.5})) << "by a slower way";
}

// Kills a clock that any overtaken message sets anew: it and those behind it would get the times of their arrival.
TEST(DeviceClock, IsNotSetByMessagesThatOvertakeEachOther) {
  const std::vector<DeviceTime> times = {{1000.02, 5.0}, {1000.12, 5.1}, {1000.50, 5.4},
                                         {1000.55, 4.9}, {1000.60, 5.5}, {1001.20, 4.7}};
  const std::vector<double> arriving_s = as_they_arrive(times), all_s = device_times_s(times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_NEAR(arriving_s[i], 995.02 + times[i].made_s, 1e-6) << i;
    EXPECT_NEAR(all_s[i], 995.02 + times[i].made_s, 1e-6) << i;
  }
  EXPECT_FALSE(was_restarted({1000.50, 5.4}, {1000.55, 4.9})) << "it has hardly been up for longer than that";
  EXPECT_EQ(device_runs(times).size(), 1U);
}

// Kills a run over a new start, whose zero is that of neither, and one without what its clock drifts.
TEST(DeviceClock, ARunLastsFromOneStartToTheNext) {
  const auto times =
      messages(5000, kNoMore, [](double true_s) { return true_s < 49.95 ? 10.0 + true_s : (true_s - 47.0) * 1.0005; });
  const std::vector<DeviceRun> runs = device_runs(times);
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_NEAR(runs[0].zero_s, kHost_s + kMinDelay_s - 10.0, 1e-5);
  EXPECT_NEAR(runs[0].deviation_s, 0.005, 1e-4);
  EXPECT_NEAR(runs[0].to_s, kHost_s + 49.9 + kMinDelay_s, 1e-4);
  EXPECT_NEAR(runs[1].zero_s, kHost_s + kMinDelay_s + 47.0 - 0.5 * 450.0 * 5e-4, 0.1);
  EXPECT_NEAR(runs[1].from_s, kHost_s + 50.0 + kMinDelay_s, 0.1);
  EXPECT_NEAR(runs[1].deviation_s, 450.0 * 5e-4 / std::sqrt(12.0), 0.02);
  EXPECT_TRUE(device_runs({}).empty());
}

// Kills a difference of long ago that counts after a pause.
TEST(DeviceClock, ForgetsWhatWasBeforeAPause) {
  DeviceClock clock;
  EXPECT_EQ(clock.add({1000.0, 900.0}), 1000.0);
  EXPECT_EQ(clock.add({1070.0, 969.5}), 1069.5);
  EXPECT_EQ(clock.add({1200.0, 1098.0}), 1200.0);
}

}  // namespace
}  // namespace pingvox
