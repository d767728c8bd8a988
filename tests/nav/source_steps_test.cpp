// Steps of positions, depths and headings that no vehicle makes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kStep_s = 0.1;

/// Samples from 100 s on, ten a second.
NavSource source_of(NavQuantity quantity, int count, const std::function<Eigen::Vector3d(int)>& value_of,
                    double step_s = kStep_s) {
  NavSource source{"device", quantity, {}};
  for (int i = 0; i < count; ++i) {
    NavSample sample;
    sample.time_s = 100.0 + step_s * i;
    sample.value = value_of(i);
    source.samples.push_back(sample);
  }
  return source;
}

/// Of a vehicle that goes ahead at 0.5 m/s, but for what is added to a sample.
NavSource positions(int count, const std::function<double(int)>& added_m, double step_s = kStep_s) {
  return source_of(
      NavQuantity::kPosition, count,
      [&](int i) { return Eigen::Vector3d(5.0 + 0.5 * step_s * i + added_m(i), 2.0, -1.0); }, step_s);
}

NavSource made(NavSource source) {
  const auto log = NavLog::make({std::move(source)}, NavClock::kUnknown);
  return log.value().sources().front();
}

/// The samples that are not valid, as [first, last].
std::vector<std::pair<int, int>> left_out_of(const NavSource& source) {
  std::vector<std::pair<int, int>> runs;
  for (int i = 0; i < static_cast<int>(source.samples.size()); ++i) {
    if (source.samples[static_cast<std::size_t>(i)].valid) continue;
    if (runs.empty() || runs.back().second != i - 1) runs.emplace_back(i, i);
    runs.back().second = i;
  }
  return runs;
}

// One position 20 m aside and no later beam had a pose (DVLs), or the path went there and back (all others).
TEST(SourceSteps, AnOutlierIsLeftOutAndNothingElse) {
  const NavSource source = made(positions(300, [](int i) { return i == 150 ? 20.0 : 0.0; }));
  EXPECT_THAT(left_out_of(source), ElementsAre(std::pair(150, 150)));
  ASSERT_EQ(source.steps.size(), 1U);
  const SourceStep& step = source.steps.front();
  EXPECT_NEAR(step.from_s, 114.9, 1e-9);
  EXPECT_NEAR(step.to_s, 115.0, 1e-9);
  EXPECT_NEAR(step.moved_m, 20.05, 1e-9);
  EXPECT_EQ(step.left_out, 1U);
  EXPECT_EQ(step.left_from_s, step.to_s);
  EXPECT_EQ(step.left_to_s, step.to_s);
  EXPECT_FALSE(step.is_new_start);
}

TEST(SourceSteps, OutliersInDifferentPlacesAreLeftOutTogether) {
  const NavSource source = made(positions(300, [](int i) { return i == 150 ? 20.0 : i == 151 ? -35.0 : 0.0; }));
  EXPECT_THAT(left_out_of(source), ElementsAre(std::pair(150, 151)));
  EXPECT_EQ(source.steps.size(), 1U);
}

TEST(SourceSteps, OutliersAtBothEndsAreLeftOut) {
  const NavSource source = made(positions(300, [](int i) { return i == 0 || i == 299 ? 20.0 : 0.0; }));
  EXPECT_THAT(left_out_of(source), ElementsAre(std::pair(0, 0), std::pair(299, 299)));
  ASSERT_EQ(source.steps.size(), 2U);
  EXPECT_NEAR(source.steps.front().to_s, 100.1, 1e-9);
  EXPECT_NEAR(source.steps.back().to_s, 129.9, 1e-9);
}

// Kills a path through two frames, and one that always keeps the first.
TEST(SourceSteps, TheFrameOfMostSamplesIsKept) {
  const auto step_at = [](int at) {
    return left_out_of(made(positions(300, [at](int i) { return i >= at ? 40.0 : 0.0; })));
  };
  EXPECT_THAT(step_at(200), ElementsAre(std::pair(200, 299)));
  EXPECT_THAT(step_at(100), ElementsAre(std::pair(0, 99)));
  EXPECT_THAT(step_at(150), ElementsAre(std::pair(150, 299))) << "the first of two that are as long";
  const NavSource back = made(positions(300, [](int i) { return i >= 80 && i < 180 ? 40.0 : 0.0; }));
  EXPECT_THAT(left_out_of(back), ElementsAre(std::pair(80, 179))) << "a step back into the first frame";
  const NavSource third = made(positions(300, [](int i) { return i < 80 ? 0.0 : i < 140 ? 40.0 : 70.0; }));
  EXPECT_THAT(left_out_of(third), ElementsAre(std::pair(0, 139)));
  ASSERT_EQ(third.steps.size(), 1U);
  EXPECT_NEAR(third.steps.front().moved_m, 30.05, 1e-9) << "the step into what is kept";
}

// The vehicle may be anywhere by then, but the sum of both steps tells that it is not the old frame.
TEST(SourceSteps, AFrameIsKnownAgainAfterAnyTime) {
  const NavSource source = made(positions(3000, [](int i) {
    return i < 1300 ? 0.0 : i < 2500 ? 40.0 : i < 2900 ? 0.0 : -15.0;
  }));
  EXPECT_THAT(left_out_of(source), ElementsAre(std::pair(1300, 2499), std::pair(2900, 2999)));
}

TEST(SourceSteps, EachQuantityHasItsLimit) {
  const std::vector<std::tuple<NavQuantity, Eigen::Vector3d, Eigen::Vector3d>> steps = {
      {NavQuantity::kPosition, {5.0, 2.0, -1.0}, {0.0, 1.2, 0.0}},
      {NavQuantity::kFix, {0.9, 0.1, 10.0}, {40.0 / 6.4e6, 0.0, 0.0}},
      {NavQuantity::kFix, {0.9, 0.1, 10.0}, {0.0, 0.0, 12.5}},
      {NavQuantity::kDepth, {3.0, 0.0, 0.0}, {-12.5, 0.0, 0.0}},
      {NavQuantity::kPressure, {130'000.0, 0.0, 0.0}, {125'000.0, 0.0, 0.0}},
      {NavQuantity::kHeading, {3.0, 0.0, 0.0}, {1.5, 0.0, 0.0}},
      {NavQuantity::kAttitude, {0.1, 0.1, 3.0}, {0.0, 0.0, 1.5}},
      {NavQuantity::kAttitude, {0.1, 0.1, 3.0}, {1.5, 0.0, 0.0}},
  };
  for (const auto& [quantity, value, step] : steps) {
    SCOPED_TRACE(std::string(name_of(quantity)));
    const auto source = [&, quantity = quantity](double share) {
      return made(
          source_of(quantity, 300, [&](int i) -> Eigen::Vector3d { return value + (i >= 200 ? share : 0.0) * step; }));
    };
    EXPECT_THAT(left_out_of(source(1.0)), ElementsAre(std::pair(200, 299)));
    EXPECT_THAT(left_out_of(source(0.05)), IsEmpty());
  }
  for (const NavQuantity quantity : {NavQuantity::kVelocity, NavQuantity::kTurnRate, NavQuantity::kRange}) {
    const NavSource free =
        made(source_of(quantity, 300, [](int i) { return Eigen::Vector3d(i >= 200 ? 14.0 : 0.0, 0.0, 0.0); }));
    EXPECT_THAT(left_out_of(free), IsEmpty()) << name_of(quantity);
  }
}

// Kills false alarms.
TEST(SourceSteps, WhatAVehicleCanDoIsNoStep) {
  std::mt19937 random(3);
  const auto noise = [&random] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  const std::vector<std::pair<const char*, NavSource>> sources = {
      {"a boat", source_of(NavQuantity::kFix, 500, [&](int i) { return Eigen::Vector3d(0.9 + 1.5e-7 * i, 0.1, 0.0); })},
      {"a noisy receiver",
       source_of(NavQuantity::kFix, 500,
                 [&](int) { return Eigen::Vector3d(0.9 + 5e-7 * noise(), 0.1 + 5e-7 * noise(), 5.0 * noise()); })},
      {"a noisy position",
       source_of(NavQuantity::kPosition, 500,
                 [&](int) { return Eigen::Vector3d(5.0 + 0.4 * noise(), 0.4 * noise(), 0.4 * noise()); })},
      {"a slow log", positions(
                         100, [](int i) { return 30.0 * i; }, 5.0)},
      {"a quick log", positions(
                          500, [](int i) { return 0.02 * i; }, 0.005)},
      {"a vehicle that speeds up beyond the limit", positions(500, [](int i) { return 0.002 * i * i; })},
      {"a turn",
       source_of(NavQuantity::kHeading, 500,
                 [](int i) { return Eigen::Vector3d(std::remainder(0.5 * i, 2.0 * std::numbers::pi), 0, 0); })},
      {"a turn over", source_of(NavQuantity::kAttitude, 500,
                                [](int i) { return rpy_of(pose_from_rpy({0, 0, 0}, 0.0, 0.4 * i, 1.0).linear()); })},
  };
  for (const auto& [name, source] : sources) {
    const NavSource kept = made(source);
    EXPECT_THAT(left_out_of(kept), IsEmpty()) << name;
    EXPECT_THAT(kept.steps, IsEmpty()) << name;
  }
  NavSource gap = positions(300, [](int i) { return i >= 150 ? 100.0 : 0.0; });
  for (std::size_t i = 150; i < 300; ++i) gap.samples[i].time_s += 60.0;
  EXPECT_THAT(left_out_of(made(gap)), IsEmpty()) << "a way in a gap";
}

// The heading alone of a vehicle that goes through the vertical turns by half a turn at once, and is right.
TEST(SourceSteps, AHeadingMayFlipWhereTheVehicleNosesUp) {
  const NavSource heading =
      source_of(NavQuantity::kHeading, 300, [](int i) { return Eigen::Vector3d(i >= 200 ? 3.0 : 0.0, 0.0, 0.0); });
  const auto flips = [&](double pitch_rad) {
    const NavSource attitude = source_of(NavQuantity::kAttitude, 300, [&](int i) {
      return Eigen::Vector3d(0.0, std::clamp(0.05 * (i - 180), 0.0, pitch_rad), 0.0);
    });
    const auto log = NavLog::make({heading, attitude}, NavClock::kUnknown);
    return left_out_of(log.value().sources().front());
  };
  EXPECT_THAT(flips(1.5), IsEmpty());
  EXPECT_THAT(flips(0.3), ElementsAre(std::pair(200, 299)));
}

// A device that was switched off and on in mid-dive made two maps in one.
TEST(SourceSteps, ADeviceThatStartsAnewIsInAnotherFrame) {
  const auto log_with = [](double origin_m, double pause_s) {
    NavSource position = source_of(NavQuantity::kPosition, 300, [&](int i) {
      return i >= 200 ? Eigen::Vector3d(origin_m + 0.01 * (i - 200), 0.0, 0.02) : Eigen::Vector3d(0.02 * i, 2.0, 0.5);
    });
    NavSource attitude = source_of(NavQuantity::kAttitude, 300, [](int) { return Eigen::Vector3d(0.0, 0.0, 1.0); });
    NavSource other = attitude;
    other.name = "autopilot";
    for (std::size_t i = 200; i < 300; ++i) {
      position.samples[i].time_s += pause_s;
      attitude.samples[i].time_s += pause_s;
    }
    const auto log = NavLog::make({attitude, position, other}, NavClock::kUnknown);
    std::vector<std::size_t> invalid;
    for (const NavSource& source : log.value().sources()) invalid.push_back(summary_of(source).invalid);
    for (const SourceStep& step : log->sources()[1].steps) EXPECT_TRUE(step.is_new_start);
    return invalid;
  };
  EXPECT_THAT(log_with(0.01, 3.0), ElementsAre(100, 100, 0)) << "with the attitude of the same device";
  EXPECT_THAT(log_with(0.5, 3.0), ElementsAre(0, 0, 0)) << "a pause, but elsewhere";
  EXPECT_THAT(log_with(0.01, 0.5), ElementsAre(0, 0, 0)) << "too short for a start";
}

// One outlier of the filter's attitude, and poses were turned by another one that never had any.
TEST(SourceSteps, AnOutlierIsNoReasonToTakeAnotherSource) {
  const auto best_with = [](int left_out) {
    NavSource first = positions(300, [&](int i) { return i < left_out ? 40.0 : 0.0; });
    NavSource second = positions(300, [](int) { return 0.0; });
    second.name = "other";
    return NavLog::make({first, second}, NavClock::kUnknown).value().best(NavQuantity::kPosition)->name;
  };
  EXPECT_EQ(best_with(1), "device");
  EXPECT_EQ(best_with(15), "device");
  EXPECT_EQ(best_with(16), "other");
}

TEST(SourceSteps, AreNotedOnce) {
  const NavSource once = made(positions(300, [](int i) { return i >= 200 ? 40.0 : 0.0; }));
  const NavSource twice = made(once);
  EXPECT_EQ(twice.steps.size(), 1U);
  EXPECT_EQ(left_out_of(twice), left_out_of(once));
}

// Kills a log of which each file keeps another frame.
TEST(SourceSteps, AreFoundAgainWhereLogsAreJoined) {
  const NavSource whole = positions(600, [](int i) { return i >= 200 ? 40.0 : 0.0; });
  NavSource first = whole, second = whole;
  first.samples.resize(300);
  second.samples.erase(second.samples.begin(), second.samples.begin() + 300);
  NavSource joined = made(first);
  EXPECT_THAT(left_out_of(joined), ElementsAre(std::pair(200, 299)));
  add_samples(made(second), joined);
  joined = made(joined);
  EXPECT_THAT(left_out_of(joined), ElementsAre(std::pair(0, 199)));
  EXPECT_EQ(joined.steps.size(), 1U);
}

TEST(SourceSteps, MoveWithTheTimesOfTheirSource) {
  NavSource source = made(positions(300, [](int i) { return i >= 200 ? 40.0 : 0.0; }));
  shift_times(source, 1000.0);
  EXPECT_NEAR(source.samples.front().time_s, 1100.0, 1e-9);
  EXPECT_NEAR(source.steps.front().to_s, 1120.0, 1e-9);
  EXPECT_NEAR(source.steps.front().left_to_s, 1129.9, 1e-9);
}

// A depth that was set anew moved the path by as much; one left out is a gap.
TEST(SourceSteps, APathHasAGapAndNoStepWhereSamplesAreLeftOut) {
  const NavSource attitude = source_of(NavQuantity::kAttitude, 300, [](int) { return Eigen::Vector3d(0.0, 0.0, 1.0); });
  const NavSource position = positions(300, [](int i) { return i >= 80 && i < 120 ? 40.0 : i == 200 ? -20.0 : 0.0; });
  const auto log = NavLog::make({attitude, position}, NavClock::kUnknown);
  const auto path = nav_trajectory(log.value());
  ASSERT_TRUE(path) << path.error().message;
  EXPECT_EQ(path->trajectory.gaps(), 1U);
  EXPECT_FALSE(path->trajectory.at(110.0));
  for (const double time_s : {105.05, 115.0, 120.0, 125.0}) {
    const auto pose = path->trajectory.at(time_s);
    ASSERT_TRUE(pose) << time_s;
    EXPECT_NEAR(pose->translation().x(), 5.0 + 0.5 * (time_s - 100.0), 1e-9);
  }
}

/// A vehicle that wanders about, by a source that changes its frame at random.
struct WanderingVehicle {
  NavSource source;
  std::vector<bool> is_kept;  ///< whether the sample is in the frame of most
};

WanderingVehicle wander(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto number = [&random](double least, double most) {
    return least + (most - least) * static_cast<double>(random() % 100'001) / 1e5;
  };
  constexpr std::size_t kFrames = 5;
  std::vector<Eigen::Vector3d> offsets = {Eigen::Vector3d::Zero()};
  for (std::size_t i = 1; i < kFrames; ++i) {
    // Far from each other, as beyond what a vehicle does.
    const double angle = number(0.0, 6.28);
    offsets.emplace_back(20.0 * static_cast<double>(i) * std::cos(angle),
                         20.0 * static_cast<double>(i) * std::sin(angle), number(-3.0, 3.0));
  }
  WanderingVehicle vehicle{{"device", NavQuantity::kPosition, {}}, {}};
  std::vector<std::size_t> frames;
  Eigen::Vector3d at(200.0, 50.0, -3.0);
  double time_s = 1000.0;
  for (int piece = 0; piece < 12; ++piece) {
    const std::size_t frame = piece == 0 ? 0 : random() % kFrames;
    const std::size_t count = random() % 3 == 0 ? 1 + random() % 3 : 10 + random() % 100;
    for (std::size_t i = 0; i < count; ++i) {
      const double step_s = number(0.05, 0.15);
      time_s += step_s;
      at += step_s * Eigen::Vector3d(number(-2.0, 2.0), number(-2.0, 2.0), number(-0.5, 0.5));
      NavSample sample;
      sample.time_s = time_s;
      sample.value = at + offsets[frame];
      vehicle.source.samples.push_back(sample);
      frames.push_back(frame);
    }
  }
  std::map<std::size_t, std::size_t> samples;
  for (const std::size_t frame : frames) ++samples[frame];
  std::size_t most = frames.front();
  for (const std::size_t frame : frames) {  // in order, so the first of equals
    if (samples[frame] > samples[most]) most = frame;
  }
  for (const std::size_t frame : frames) vehicle.is_kept.push_back(frame == most);
  return vehicle;
}

TEST(SourceSteps, FindTheFramesOfRandomWalks) {
  std::size_t checked = 0, left_out = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    const WanderingVehicle vehicle = wander(seed);
    NavSource shifted = vehicle.source, turned = vehicle.source;
    shift_times(shifted, 1.7e9);
    const Eigen::Matrix3d rotation = pose_from_rpy({0, 0, 0}, 0.3, -1.0, 2.0).linear();
    for (NavSample& sample : turned.samples) sample.value = rotation * sample.value;
    for (const NavSource& source : {made(vehicle.source), made(shifted), made(turned)}) {
      for (std::size_t i = 0; i < source.samples.size(); ++i) {
        ASSERT_EQ(source.samples[i].valid, vehicle.is_kept[i]) << i;
        left_out += source.samples[i].valid ? 0 : 1;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 100'000U);
  EXPECT_GT(left_out, 20'000U);
}

// A source of nothing but jumps must not take a time that grows with the square of its samples.
TEST(SourceSteps, ASourceOfJumpsIsTrackedInTime) {
  std::mt19937 random(5);
  const NavSource source = made(source_of(NavQuantity::kPosition, 100'000, [&](int) {
    const auto place = [&random] { return static_cast<double>(random() % 10'000); };
    return Eigen::Vector3d(place(), place(), place());
  }));
  EXPECT_GE(summary_of(source).samples - summary_of(source).invalid, 1U);
}

}  // namespace
}  // namespace pingvox::test
