#include "pingvox/nav/receiver_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pingvox {
namespace {

constexpr double kDate_s = 1'684'351'479.0, kUp_s = 100.0;

/// Every tenth of a second for a minute; every third message has no time of the device.
/// @param clock_s   of the recorder, by the true time since the start
/// @param device_s  of the device
template <class Clock, class Device>
std::vector<ReceivedMessage> messages(const Clock& clock_s, const Device& device_s, int count = 600) {
  std::vector<ReceivedMessage> made;
  for (int i = 0; i < count; ++i) {
    const double true_s = 0.1 * i;
    made.push_back({clock_s(true_s), i % 3 == 0 ? std::nullopt : std::optional(device_s(true_s))});
  }
  return made;
}

constexpr auto kUp = [](double true_s) { return kUp_s + true_s; };

/// The clock of a recorder that is set at 15 s.
auto set_at_15_s(double before_s, double after_s) {
  return [=](double true_s) { return (true_s < 14.95 ? before_s : after_s) + true_s; };
}

void expect_even(const ReceiverTimes& found, double from_s) {
  for (std::size_t i = 0; i < found.times_s.size(); ++i) {
    ASSERT_NEAR(found.times_s[i], from_s + 0.1 * static_cast<double>(i), 1e-5) << i;
  }
}

// Kills a log of two dates, 53 years apart, one on the clock that was not set, and one on the clock that was set wrong.
TEST(ReceiverClock, TimesBeforeAndAfterASettingAreOnTheClockWithDates) {
  const struct {
    double before_s, after_s, right_s;
  } cases[] = {{100.0, kDate_s, kDate_s},
               {kDate_s, 100.0, kDate_s},
               {315'532'800.0, kDate_s, kDate_s},
               {kDate_s - 7200.0, kDate_s, kDate_s},
               {kDate_s, kDate_s - 3.5, kDate_s - 3.5},
               {kDate_s, kDate_s + 5.0, kDate_s + 5.0},
               {100.0, 315'532'800.0, 315'532'800.0}};
  for (const auto& [before_s, after_s, right_s] : cases) {
    SCOPED_TRACE(after_s - before_s);
    const ReceiverTimes found = receiver_times(messages(set_at_15_s(before_s, after_s), kUp));
    ASSERT_EQ(found.settings.size(), 1U);
    ASSERT_TRUE(found.settings[0].by_s);
    EXPECT_NEAR(*found.settings[0].by_s, after_s - before_s, 1e-5);
    EXPECT_NEAR(found.settings[0].at_s, right_s + 15.0, 1e-5);
    expect_even(found, right_s);
  }
}

// Kills a second setting that counts from the first one's clock, and one that is left out.
TEST(ReceiverClock, MayBeSetTwice) {
  const auto clock_s = [](double true_s) {
    return true_s + (true_s < 9.95 ? 100.0 : true_s < 29.95 ? kDate_s : kDate_s - 100.0);
  };
  const ReceiverTimes found = receiver_times(messages(clock_s, kUp));
  EXPECT_EQ(found.settings.size(), 2U);
  expect_even(found, kDate_s - 100.0);
}

// Kills a setting that is told of messages that waited, of a pause, and of a device that restarted or set.
TEST(ReceiverClock, IsNotSetByDelaysAndPauses) {
  const auto waits = [](double true_s) { return kDate_s + (true_s > 20.0 && true_s < 30.0 ? 30.0 : true_s); };
  const auto waits_at_the_end = [](double true_s) { return kDate_s + true_s + (true_s > 58.0 ? 4.0 : 0.0); };
  const auto pauses = [](double true_s) { return kDate_s + true_s + (true_s > 30.0 ? 3600.0 : 0.0); };
  const auto on = [](double true_s) { return kDate_s + true_s; };
  const auto up_pauses = [](double true_s) { return kUp_s + true_s + (true_s > 30.0 ? 3600.0 : 0.0); };
  const auto started_anew = [](double true_s) { return true_s < 30.0 ? kUp_s + true_s : true_s - 29.0; };
  const auto set_ahead = [](double true_s) { return true_s + (true_s < 30.0 ? kUp_s : 61'000.0); };
  for (const auto& recorded : {messages(waits, kUp), messages(waits_at_the_end, kUp), messages(pauses, up_pauses),
                               messages(on, started_anew), messages(on, set_ahead)}) {
    const ReceiverTimes found = receiver_times(recorded);
    EXPECT_TRUE(found.settings.empty());
    for (std::size_t i = 0; i < recorded.size(); ++i) ASSERT_EQ(found.times_s[i], recorded[i].received_s);
  }
  EXPECT_TRUE(receiver_times({}).times_s.empty());
}

// Kills a size that is made up where the device does not tell it.
TEST(ReceiverClock, TimesStayWhereNoDeviceTellsBySoMuch) {
  const auto started_anew = [](double true_s) { return true_s < 14.95 ? kUp_s + true_s : true_s - 14.0; };
  auto silent = messages(set_at_15_s(kDate_s, 100.0), kUp);
  for (ReceivedMessage& message : silent) message.made_s.reset();
  for (const auto& recorded : {silent, messages(set_at_15_s(100.0, kDate_s), started_anew)}) {
    const ReceiverTimes found = receiver_times(recorded);
    ASSERT_EQ(found.settings.size(), 1U);
    EXPECT_FALSE(found.settings[0].by_s);
    for (std::size_t i = 0; i < recorded.size(); ++i) ASSERT_EQ(found.times_s[i], recorded[i].received_s);
  }
}

}  // namespace
}  // namespace pingvox
