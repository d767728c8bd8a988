#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "nav/internal/upright.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/nav/nav_log.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

/// Once round a circle of 5 m in 15 s.
double turned_at(double time_s) {
  return 2.0 * std::numbers::pi * time_s / 15.0;
}
double wrapped(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}
/// Looks ahead on the circle, to the left of east.
Vector3d attitude_at(double time_s) {
  return {0.0, 0.0, wrapped(turned_at(time_s))};
}
Vector3d compass_at(double time_s) {
  return {0.0, 0.0, wrapped(std::numbers::pi / 2.0 - turned_at(time_s))};
}
Vector3d place_at(double time_s) {
  return {5.0 * std::sin(turned_at(time_s)), 5.0 - 5.0 * std::cos(turned_at(time_s)), -2.0};
}

NavSource at_10_hz(std::string name, NavQuantity quantity, const std::function<Vector3d(double)>& at) {
  NavSource source{std::move(name), quantity, {}};
  for (int i = 0; i < 300; ++i) source.samples.push_back({.time_s = 0.1 * i, .value = at(0.1 * i)});
  return source;
}

/// The doubts of a log, "" for a source without.
std::vector<std::string> doubts_of(std::vector<NavSource> sources) {
  const auto log = NavLog::make(std::move(sources), NavClock::kUnix);
  std::vector<std::string> doubts;
  for (const NavSource& source : log->sources()) doubts.push_back(source.doubt + source.fault);
  return doubts;
}

constexpr auto kPosition = NavQuantity::kPosition, kAttitude = NavQuantity::kAttitude;

// A compass counts clockwise: the map was mirrored, without a word.
TEST(TurnChecks, AYawAgainstThePathIsDoubtful) {
  const NavSource path = at_10_hz("P", kPosition, place_at);
  EXPECT_THAT(doubts_of({path, at_10_hz("A", kAttitude, compass_at)}),
              testing::ElementsAre("", HasSubstr("its yaw turns against the path of P: is it clockwise")));
  EXPECT_THAT(doubts_of({path, at_10_hz("A", kAttitude, attitude_at)}), testing::ElementsAre("", ""));
  const auto fixes = at_10_hz("GPS", NavQuantity::kFix, [](double time_s) {
    const Vector3d at = place_at(time_s);
    return Vector3d(0.9 + at.y() / 6.37e6, 0.2 + at.x() / (6.38e6 * std::cos(0.9)), 0.0);
  });
  EXPECT_THAT(doubts_of({fixes, at_10_hz("A", kAttitude, compass_at)})[1], HasSubstr("against the path of GPS"));
  EXPECT_THAT(doubts_of({fixes, at_10_hz("A", kAttitude, attitude_at)})[1], "");
}

TEST(TurnChecks, AVehicleMayMoveToAnySide) {
  const NavSource path = at_10_hz("P", kPosition, place_at);
  for (const double turned_rad : {1.0, std::numbers::pi}) {
    EXPECT_THAT(doubts_of({path, at_10_hz("A", kAttitude,
                                          [&](double time_s) -> Vector3d {
                                            return {0.0, 0.0, wrapped(turned_at(time_s) + turned_rad)};
                                          })}),
                testing::ElementsAre("", ""));
  }
  // It looks to and fro while it goes round.
  EXPECT_THAT(doubts_of({path, at_10_hz("A", kAttitude,
                                        [](double time_s) -> Vector3d { return {0.0, 0.0, std::sin(time_s)}; })}),
              testing::ElementsAre("", ""));
}

TEST(TurnChecks, AYawAgainstAnotherHeadingOrTheTurnRateIsDoubtful) {
  const auto heading =
      at_10_hz("C", NavQuantity::kHeading, [](double time_s) { return Vector3d(attitude_at(time_s).z(), 0.0, 0.0); });
  EXPECT_THAT(doubts_of({at_10_hz("A", kAttitude, compass_at), heading}),
              testing::ElementsAre(HasSubstr("its yaw turns against the heading of C"),
                                   HasSubstr("its yaw turns against the attitude of A")));
  const auto rates = [](double sign) {
    return at_10_hz("imu", NavQuantity::kTurnRate,
                    [=](double) { return Vector3d(0.0, 0.0, sign * 2.0 * std::numbers::pi / 15.0); });
  };
  EXPECT_THAT(doubts_of({heading, rates(-1.0)}),
              testing::ElementsAre(HasSubstr("its yaw turns against the turn rate of imu"), ""));
  EXPECT_THAT(doubts_of({heading, rates(1.0)}), testing::ElementsAre("", ""));
  NavSource other = rates(-1.0);
  other.subject = NavSubject::kOther;
  EXPECT_THAT(doubts_of({heading, other}), testing::ElementsAre("", "")) << "of something else";
}

TEST(TurnChecks, AnAttitudeThatNeverTurnsOnATurningPathIsDoubtful) {
  const auto zero = at_10_hz("A", kAttitude, [](double) { return Vector3d(0.0, 0.0, 0.0); });
  EXPECT_THAT(doubts_of({at_10_hz("P", kPosition, place_at), zero}),
              testing::ElementsAre("", HasSubstr("it never turns, while the path of P does")));
  const auto straight = at_10_hz("P", kPosition, [](double time_s) { return Vector3d(0.3 * time_s, 0.0, -2.0); });
  EXPECT_THAT(doubts_of({straight, zero}), testing::ElementsAre("", ""));
  // It stays where it is, and its position is no more than noise.
  const auto noise = at_10_hz("P", kPosition, [](double time_s) {
    return Vector3d(0.1 * std::sin(1e3 * time_s * time_s), 0.1 * std::cos(2e3 * time_s * time_s), -2.0);
  });
  EXPECT_THAT(doubts_of({noise, zero}), testing::ElementsAre("", ""));
}

TEST(TurnChecks, PosesOfAFileAreComparedAsWell) {
  std::vector<StampedPose> poses, inverted;
  for (int i = 0; i < 300; ++i) {
    const double time_s = 0.1 * i, yaw_rad = turned_at(time_s);
    poses.push_back({time_s, pose_from_rpy(place_at(time_s), 0.0, 0.0, yaw_rad)});
    inverted.push_back({time_s, pose_from_rpy(place_at(time_s), 0.0, 0.0, -yaw_rad)});
  }
  const auto doubt_of = [](std::vector<StampedPose> all) {
    return sources_of_poses(*Trajectory::make(std::move(all))).back().doubt;
  };
  EXPECT_EQ(doubt_of(poses), "");
  EXPECT_THAT(doubt_of(inverted), AllOf(HasSubstr("its yaw turns against the path"), HasSubstr("inverted")));
}

}  // namespace
}  // namespace pingvox
