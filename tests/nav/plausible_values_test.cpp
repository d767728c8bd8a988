#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nav/internal/live_poses.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;

/// Five samples a second.
NavSource source_of(std::string name, NavQuantity quantity, int samples, const std::function<Vector3d(double)>& at) {
  NavSource source{std::move(name), quantity, {}};
  for (int i = 0; i < samples; ++i) {
    NavSample sample;
    sample.time_s = 0.2 * i;
    sample.value = at(sample.time_s);
    source.samples.push_back(sample);
  }
  return source;
}

NavLog log_of(std::vector<NavSource> sources) {
  return *NavLog::make(std::move(sources), NavClock::kUnix);
}

std::string fault_of(const NavSource& source) {
  return log_of({source}).sources().front().fault;
}

/// A yaw that turns to and fro by half a radian, with a full turn every 20 s.
double yaw_at(double time_s) {
  return 0.5 * std::sin(0.1 * std::numbers::pi * time_s);
}
double yaw_rate_at(double time_s) {
  return 0.05 * std::numbers::pi * std::cos(0.1 * std::numbers::pi * time_s);
}

TEST(PlausibleValues, ValuesInAnotherUnitAreAFault) {
  const auto all = [](const Vector3d& value) {
    return [value](double time_s) -> Vector3d { return value + Vector3d::Constant(1e-3 * time_s); };
  };
  EXPECT_EQ(fault_of(source_of("gps", NavQuantity::kFix, 50, all({54.25, 10.0, 0.0}))),
            "latitude of 54.25 rad is beyond pi/2: is it in degrees?");
  // Of a log in degrees that has another number than is right.
  const auto in_degrees = [](double latitude_deg) {
    return [latitude_deg](double) -> Vector3d { return {latitude_deg * std::numbers::pi / 180.0, 0.1, 0.0}; };
  };
  EXPECT_EQ(fault_of(source_of("gps", NavQuantity::kFix, 50, in_degrees(5418.0))),
            "latitude of 5418 degrees is beyond pi/2: is it in another unit?");
  EXPECT_EQ(fault_of(source_of("gps", NavQuantity::kFix, 50, in_degrees(-122.3))),
            "latitude of -122.3 degrees is beyond pi/2: is it the longitude, or in another unit?");
  EXPECT_THAT(fault_of(source_of("odom", NavQuantity::kPosition, 50, all({3'657'000.0, 651'000.0, 5'158'000.0}))),
              HasSubstr("Earth-centred"));
  EXPECT_EQ(fault_of(source_of("odom", NavQuantity::kPosition, 50, all({500'000.0, 6'010'000.0, -5.0}))), "") << "UTM";
  EXPECT_THAT(fault_of(source_of("gps", NavQuantity::kFix, 50, all({0.5, 103.8, 0.0}))),
              HasSubstr("longitude of 103.8 rad"));
  EXPECT_THAT(fault_of(source_of("gps", NavQuantity::kFix, 50, all({9.4e6, 1.8e6, 0.0}))),
              HasSubstr("is it in another unit?"));
  EXPECT_THAT(fault_of(source_of("ahrs", NavQuantity::kAttitude, 50, all({0.0, 0.0, 90.0}))),
              HasSubstr("yaw of 90 rad is beyond 2 pi: is it in degrees, or does it count turns?"));
  EXPECT_THAT(fault_of(source_of("ahrs", NavQuantity::kAttitude, 50, all({12.0, 0.0, 1.0}))),
              HasSubstr("roll of 12 rad"));
  EXPECT_THAT(fault_of(source_of("compass", NavQuantity::kHeading, 50, all({200.0, 0.0, 0.0}))),
              HasSubstr("yaw of 200 rad"));
  EXPECT_THAT(fault_of(source_of("imu", NavQuantity::kTurnRate, 50, all({0.0, 0.0, 21.0}))),
              HasSubstr("turn rate of 21 rad/s"));
  EXPECT_THAT(fault_of(source_of("dvl", NavQuantity::kVelocity, 50, all({400.0, 0.0, 0.0}))),
              HasSubstr("velocity of 400 m/s"));
  EXPECT_THAT(fault_of(source_of("bar", NavQuantity::kDepth, 50, all({50'000.0, 0.0, 0.0}))),
              HasSubstr("depth of 50000 m"));
  EXPECT_THAT(fault_of(source_of("bar", NavQuantity::kTemperature, 50, all({283.0, 0.0, 0.0}))),
              HasSubstr("is it in kelvins?"));
  EXPECT_THAT(fault_of(source_of("usbl", NavQuantity::kPosition, 50, all({5e9, 0.0, 0.0}))),
              HasSubstr("position of 5e+09 m"));
  for (const Vector3d& good : {Vector3d(0.9, 3.1, 40.0), Vector3d(-1.5, -3.1, 0.0)}) {
    EXPECT_EQ(fault_of(source_of("gps", NavQuantity::kFix, 50, [&](double) { return good; })), "");
  }
  EXPECT_EQ(fault_of(source_of("ahrs", NavQuantity::kAttitude, 50, all({-3.1, 1.5, 6.27}))), "");
}

// The limits are those that the messages name. Kills a limit that is another number than it says.
TEST(PlausibleValues, ALimitIsAsItSays) {
  using enum NavQuantity;
  const Vector3d x(1.0, 0.0, 0.0), y(0.0, 1.0, 0.0), z(0.0, 0.0, 1.0);
  struct Case {
    NavQuantity quantity;
    Vector3d value;  ///< at the limit
    std::string_view limit;
  };
  for (const Case& one : {Case{kTurnRate, 15.0 * z, "15 rad/s"}, Case{kTurnRate, -15.0 * y, "15 rad/s"},
                          Case{kVelocity, 100.0 * x, "100 m/s"}, Case{kVelocity, -100.0 * y, "100 m/s"},
                          Case{kPosition, 1e5 * z, "100 km"}, Case{kPosition, 2.0e7 * x, "half a turn of the Earth"},
                          Case{kDepth, 12e3 * x, "12 km"}, Case{kPressure, 1.3e8 * x, "that of the deepest sea"},
                          Case{kTemperature, 150.0 * x, "-100 to 150 degrees C"},
                          Case{kTemperature, -100.0 * x, "-100 to 150 degrees C"}}) {
    SCOPED_TRACE(one.limit);
    const auto fault_at = [&](double share) {
      return fault_of(source_of("sensor", one.quantity, 50, [&](double) { return Vector3d(share * one.value); }));
    };
    EXPECT_THAT(fault_at(0.999), testing::Not(HasSubstr("is beyond")));
    EXPECT_THAT(fault_at(1.001), HasSubstr("is beyond " + std::string(one.limit)));
  }
}

// A heading in degrees is small for some time. Kills a verdict by the median or by the first samples.
TEST(PlausibleValues, DegreesThatBeginAtZeroAreAFault) {
  EXPECT_NE(fault_of(source_of("compass", NavQuantity::kHeading, 100,
                               [](double time_s) { return Vector3d(0.5 * time_s, 0, 0); })),
            "");
}

// In radians this is 3 turns, in degrees 18 degrees: nothing tells them apart. Kills a guess.
TEST(PlausibleValues, AYawThatCountsTurnsIsRefusedByName) {
  EXPECT_THAT(fault_of(source_of("ahrs", NavQuantity::kAttitude, 300,
                                 [](double time_s) { return Vector3d(0, 0, 0.3 * time_s); })),
              HasSubstr("or does it count turns?"));
}

// Kills a dive that ends by one damaged number, or by a device's word for "not known".
TEST(PlausibleValues, SingleOnesAreInvalidSamples) {
  NavSource yaw =
      source_of("ahrs", NavQuantity::kAttitude, 100, [](double time_s) { return Vector3d(0, 0, yaw_at(time_s)); });
  yaw.samples[40].value.z() = 90.0;
  yaw.samples[41].value.z() = -3e20;
  NavSource fix = source_of("gps", NavQuantity::kFix, 100, [](double) { return Vector3d(0.9, 0.2, 0.0); });
  for (std::size_t i = 0; i < 30; ++i) fix.samples[i].value = {91.0 * kDegree, 181.0 * kDegree, 0.0};
  const NavLog log = log_of({yaw, fix});
  for (const NavSource& source : log.sources()) EXPECT_EQ(source.fault, "") << source.name;
  EXPECT_EQ(summary_of(log.sources()[0]).invalid, 2U);
  EXPECT_FALSE(log.sources()[0].samples[40].valid);
  EXPECT_EQ(summary_of(log.sources()[1]).invalid, 30U);
}

TEST(PlausibleValues, NothingIsComputedFromAFault) {
  const auto position =
      source_of("dvl", NavQuantity::kPosition, 100, [](double time_s) { return Vector3d(time_s, 0, 0); });
  const auto good =
      source_of("imu", NavQuantity::kAttitude, 50, [](double time_s) { return Vector3d(0, 0, yaw_at(time_s)); });
  const auto bad =
      source_of("ahrs", NavQuantity::kAttitude, 100, [](double time_s) { return Vector3d(0, 0, 90.0 + time_s); });
  const auto path = nav_trajectory(log_of({position, bad, good}));
  ASSERT_TRUE(path) << path.error().message;
  EXPECT_EQ(path->attitude, "imu") << "though it has less samples";
  EXPECT_EQ(log_of({bad, good}).best(NavQuantity::kAttitude)->name, "imu");
  EXPECT_EQ(log_of({bad}).best(NavQuantity::kAttitude), nullptr);

  const auto none = nav_trajectory(log_of({position, bad}));
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message,
            "the attitude of ahrs cannot be used: yaw of 90 rad is beyond 2 pi: is it in degrees, or does it "
            "count turns?");
  const auto fixes = source_of("gps", NavQuantity::kFix, 100, [](double) { return Vector3d(54.3, 10.0, 0.0); });
  const auto nowhere = nav_positions(log_of({fixes}));
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().message, HasSubstr("the fix of gps cannot be used: latitude of 54.3 rad"));

  EXPECT_TRUE(check_sources(log_of({bad, good}), kHeadingQuantities));
  EXPECT_FALSE(check_sources(log_of({bad}), kHeadingQuantities));
  EXPECT_THAT(faults_text(log_of({bad, good, fixes})), HasSubstr("; the fix of gps cannot be used"));

  NavSource joined = good;
  add_samples(log_of({bad}).sources().front(), joined);
  EXPECT_NE(log_of({joined}).sources().front().fault, "") << "a part of it is in degrees";
}

// Most rates of a slow vehicle are below any limit, in degrees per second as well.
TEST(PlausibleValues, TurnRatesInDegreesAreAFault) {
  const auto in_degrees = source_of("imu", NavQuantity::kTurnRate, 500, [](double time_s) {
    return Vector3d(0.1, 0, yaw_rate_at(time_s) / kDegree / 1.2);
  });
  EXPECT_THAT(fault_of(in_degrees), HasSubstr("rad/s on average"));

  const auto rate = [](std::string name, double scale) {
    return source_of(std::move(name), NavQuantity::kTurnRate, 500,
                     [scale](double time_s) { return Vector3d(0, 0, scale * yaw_rate_at(time_s)); });
  };
  const auto yaw = [](std::string name, double scale) {
    return source_of(std::move(name), NavQuantity::kHeading, 500,
                     [scale](double time_s) { return Vector3d(scale * yaw_at(time_s), 0, 0); });
  };
  constexpr double kSlow = 0.1;  // 0.9 degrees per second at most
  NavLog log = log_of({yaw("compass", kSlow), rate("imu", kSlow / kDegree)});
  EXPECT_EQ(log.sources()[0].fault, "");
  EXPECT_EQ(log.sources()[1].fault,
            "it turns 57.3 times as far as the heading of compass: is it in degrees per second?");
  log = log_of({yaw("compass", kSlow / kDegree), rate("imu", kSlow)});
  EXPECT_EQ(log.sources()[0].fault, "it turns 57.3 times as far as the turn rate of imu: is it in degrees?");
  EXPECT_EQ(log.sources()[1].fault, "");
  log = log_of({yaw("one", kSlow), yaw("other", kSlow / kDegree)});
  EXPECT_EQ(log.sources()[0].fault, "");
  EXPECT_EQ(log.sources()[1].fault, "it turns 57.3 times as far as the heading of one: is it in degrees?");
  for (const double scale : {1.0, -1.0, 2.0}) {
    log = log_of({yaw("compass", 1.0), rate("imu", scale)});
    EXPECT_EQ(faults_text(log), "") << scale;
  }
}

// Kills a yaw that is wrapped into the turn before anybody sees it.
TEST(PlausibleValues, AHeadingInDegreesStaysVisible) {
  NavSource source{"ahrs", NavQuantity::kAttitude, {}};
  for (int i = 0; i < 20; ++i) {
    NavSample sample;
    sample.time_s = i;
    sample.value = from_ned::attitude({0.0, 0.0, 100.0 + i});
    source.samples.push_back(sample);
  }
  EXPECT_THAT(fault_of(source), HasSubstr("is it in degrees"));
}

TEST(LivePoses, LeavesOutWhatIsNotPossible) {
  LivePoses poses;
  NavSample sample;
  for (int i = 0; i < 30; ++i) {
    sample.time_s = 0.1 * i;
    sample.value = i == 0 ? Vector3d(54.0, 10.0, 0.0) : Vector3d(0.9, 0.2, 0.0);
    poses.add("gps", NavQuantity::kFix, sample);
    sample.value = {0.0, 0.0, 1.0};
    poses.add("imu", NavQuantity::kAttitude, sample);
  }
  const auto pose = poses.at(2.0);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation().norm(), 0.0, 1e-6) << "the first fix was none";
}

std::string doubt_of(const NavSource& source) {
  return log_of({source}).sources().front().doubt;
}

// Quaternions in the order w x y z: read as x y z w they lay a level vehicle on its back, or roll it as it turns.
TEST(PlausibleValues, AVehicleOnItsBackAllTheTimeIsDoubtful) {
  const auto on_its_back = source_of("odom", NavQuantity::kAttitude, 100, [](double time_s) {
    return Vector3d(std::numbers::pi - 0.01 * time_s, 0.01, 0.3);
  });
  EXPECT_THAT(doubt_of(on_its_back), HasSubstr("upside down all the time"));
  EXPECT_THAT(doubt_of(on_its_back), HasSubstr("w x y z"));
  EXPECT_THAT(doubt_texts(log_of({on_its_back})), testing::ElementsAre(HasSubstr("attitude of odom: the vehicle is")));
  EXPECT_THAT(doubt_of(source_of("odom", NavQuantity::kAttitude, 150,
                                 [](double time_s) { return Vector3d(3.1 - 0.1 * time_s, 0.02, -0.02); })),
              HasSubstr("rolls over"));
  // The same with a heading of 90 degrees or so.
  EXPECT_THAT(doubt_of(source_of("odom", NavQuantity::kAttitude, 100,
                                 [](double time_s) { return Vector3d(1.9 - 0.04 * time_s, 0.01, 0.02); })),
              HasSubstr("lies on its side"));
  // Roll and yaw are swapped.
  EXPECT_THAT(doubt_of(source_of("odom", NavQuantity::kAttitude, 100,
                                 [](double time_s) { return Vector3d(0.08 * time_s - 0.6, 0.01, 0.02); })),
              HasSubstr("roll and yaw swapped"));
  // It rolls in waves while it turns a little, or dives steeply.
  EXPECT_EQ(doubt_of(source_of(
                "odom", NavQuantity::kAttitude, 100,
                [](double time_s) { return Vector3d(0.7 * std::sin(time_s), 0.0, 0.1 * std::sin(0.2 * time_s)); })),
            "");
  EXPECT_EQ(doubt_of(source_of("odom", NavQuantity::kAttitude, 100,
                               [](double time_s) { return Vector3d(0.0, 0.7, 0.05 * time_s); })),
            "");
  // It dives head down, loops, or turns over once.
  EXPECT_EQ(doubt_of(source_of("odom", NavQuantity::kAttitude, 100,
                               [](double time_s) { return Vector3d(0.05, 0.02, 0.3 * time_s - 3.0); })),
            "");
  EXPECT_EQ(doubt_of(source_of("odom", NavQuantity::kAttitude, 100,
                               [](double time_s) { return Vector3d(time_s < 8.0 ? 3.1 : 0.0, 0.0, yaw_at(time_s)); })),
            "");
}

// Kills a DVL's word for "not known" that is taken for 33 m/s, however often it says so.
TEST(PlausibleValues, TheLowestNumberOfADvlIsNotKnown) {
  auto dvl = source_of("dvl", NavQuantity::kVelocity, 100, [](double) { return Vector3d(0.2, 0.1, 0.0); });
  for (std::size_t i = 20; i < 60; ++i) dvl.samples[i].value = {-32.768, 32.768, 32.768};
  const NavLog log = log_of({dvl});
  EXPECT_EQ(log.sources()[0].fault, "");
  EXPECT_EQ(summary_of(log.sources()[0]).invalid, 40U);
}

TEST(PlausibleValues, ASpeedOfNoBoatIsAnotherUnit) {
  EXPECT_EQ(fault_of(source_of("dvl", NavQuantity::kVelocity, 100, [](double) { return Vector3d(20.0, 1.0, 0.0); })),
            "velocity of 20 m/s most of the time: is it in cm/s or mm/s?");
  EXPECT_EQ(fault_of(source_of("dvl", NavQuantity::kVelocity, 100,
                               [](double time_s) { return Vector3d(time_s < 5.0 ? 20.0 : 1.0, 0.0, 0.0); })),
            "");
}

// Radians that are read as degrees: kills a map that is turned by nothing.
TEST(PlausibleValues, AYawThatBeginsAnewWithinSixDegreesIsInRadians) {
  const auto yaw_of = [](double unit) {
    return [unit](double time_s) {
      return Vector3d(0.0, 0.0, 1.5 - std::remainder(0.5 * time_s, 2.0 * std::numbers::pi) * unit);
    };
  };
  EXPECT_THAT(fault_of(source_of("A50", NavQuantity::kAttitude, 150, yaw_of(kDegree))), HasSubstr("is it in radians?"));
  EXPECT_EQ(fault_of(source_of("A50", NavQuantity::kAttitude, 150, yaw_of(1.0))), "");
  EXPECT_EQ(fault_of(source_of("A50", NavQuantity::kAttitude, 30, yaw_of(kDegree))), "") << "it never begins anew";
}

// Kills the advice that times do not fit where next to nothing is left of the positions.
TEST(PlausibleValues, PositionsThatOnlyJumpAreInAnotherUnit) {
  EXPECT_THAT(fault_of(source_of("odom", NavQuantity::kPosition, 100,
                                 [](double time_s) { return Vector3d(100.0 * time_s, 0.0, -5.0); })),
              HasSubstr("it moves by 20 m every 0.2 s: is it in cm or mm?"));
  EXPECT_EQ(fault_of(source_of("odom", NavQuantity::kPosition, 100,
                               [](double time_s) { return Vector3d(0.1 * time_s, 0.0, -5.0); })),
            "");
}

}  // namespace
}  // namespace pingvox
