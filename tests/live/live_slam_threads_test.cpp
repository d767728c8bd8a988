// SLAM while beams and navigation of a simulated harbour come. Maps are corrected in a thread.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "live/live_slam.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/mapping/beam_mapper.hpp"
#include "pingvox/nav/trajectory_score.hpp"
#include "pingvox/sim/nav_sensors.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sim/sonar.hpp"
#include "pingvox/slam/causal_replay.hpp"

namespace pingvox::test {
namespace {

std::string file_of(const OccupancyMap& map) {
  std::ostringstream out;
  EXPECT_TRUE(write_map(map, Format::kPvx, "", out));
  return std::move(out).str();
}

/// What is recorded of a drive.
struct SimulatedDrive {
  Trajectory truth = Trajectory::still(Pose::Identity());
  std::vector<Beam> beams;
  std::vector<NavSource> sources;
};

/// Through the harbour, once round and a bit more.
SimulatedDrive harbour_drive() {
  constexpr double kDuration_s = 110.0;
  const Scene scene = harbour_scene({});
  SonarOptions sonar;
  sonar.beams_per_turn = 60;
  sonar.bins = 100;
  sonar.bin_length_m = 0.1;
  SimulatedDrive drive;
  drive.truth = follow_route(scene.loop, kDuration_s, {.speed_m_s = 0.7});
  SonarSimulator simulator(scene.world, drive.truth, sonar, 40);
  while (const auto beam = *simulator.next()) drive.beams.push_back(*beam);
  NavSensorOptions sensors;
  sensors.delay_s = 0.0;
  sensors.dvl_yaw_rad = 0.1;
  drive.sources = simulate_nav(drive.truth, 0.0, kDuration_s, sensors).log.sources();
  return drive;
}

/// A slow one through a tank, without navigation.
SimulatedDrive tank_drive() {
  const Scene scene = tank_scene({});
  SimulatedDrive drive;
  drive.truth = follow_route(scene.loop, 200.0, {.speed_m_s = 0.05});
  SonarOptions sonar;
  sonar.beams_per_turn = 100;
  sonar.bins = 200;
  sonar.bin_length_m = 0.025;
  SonarSimulator simulator(scene.world, drive.truth, sonar, 15);
  while (const auto beam = *simulator.next()) drive.beams.push_back(*beam);
  return drive;
}

/// Options of the map: cells of 0.2 m.
MapOptions cells() {
  return {.resolution_m = 0.2};
}

/// Gives all of a drive, each sample of the navigation when it is made.
void run(const SimulatedDrive& drive, LiveSlam& slam) {
  std::vector<std::size_t> next(drive.sources.size(), 0);
  std::size_t given = 0;
  for (double now_s = 0.0; given < drive.beams.size(); now_s += 0.02) {
    for (std::size_t s = 0; s < drive.sources.size(); ++s) {
      const NavSource& source = drive.sources[s];
      for (; next[s] < source.samples.size() && source.samples[next[s]].time_s <= now_s; ++next[s]) {
        slam.add(0, source.name, source.quantity, source.samples[next[s]]);
      }
    }
    for (; given < drive.beams.size() && drive.beams[given].time_s <= now_s; ++given) {
      if (slam.may_come(drive.beams[given].time_s, now_s)) break;
      const auto added = slam.add(drive.beams[given], now_s);
      ASSERT_TRUE(added) << added.error().message;
    }
    ASSERT_TRUE(slam.update(now_s));
  }
  // The recording ends a bit later.
  for (std::size_t s = 0; s < drive.sources.size(); ++s) {
    const NavSource& source = drive.sources[s];
    for (; next[s] < source.samples.size(); ++next[s]) {
      slam.add(0, source.name, source.quantity, source.samples[next[s]]);
    }
  }
}

/// What `slam --causal` says of the recording.
SlamSolution replay(const SimulatedDrive& drive) {
  CausalReplay recording{SlamOptions{}};
  for (const NavSource& source : drive.sources) {
    for (const NavSample& sample : source.samples) {
      EXPECT_TRUE(recording.add(source.name, source.quantity, sample));
    }
  }
  for (const Beam& beam : drive.beams) recording.add(beam);
  Result<SlamSolution> solved = recording.solve();
  EXPECT_TRUE(solved) << solved.error().message;
  return *std::move(solved);
}

void expect_equal(const Trajectory& told, const Trajectory& replayed) {
  ASSERT_EQ(told.poses().size(), replayed.poses().size());
  for (std::size_t i = 0; i < told.poses().size(); ++i) {
    ASSERT_EQ(told.poses()[i].map_from_body.matrix(), replayed.poses()[i].map_from_body.matrix()) << i;
  }
}

std::string map_along(const Trajectory& path, const std::vector<Beam>& beams) {
  OccupancyMap map(cells());
  Result<BeamMapper> mapper = BeamMapper::make({}, map);
  EXPECT_TRUE(mapper);
  for (const Beam& beam : beams) EXPECT_TRUE(mapper->add(beam, path.at(beam.time_s)));
  EXPECT_TRUE(mapper->finish());
  return file_of(map);
}

LiveSlam slam_with(LiveSlam::Navigation navigation) {
  Result<LiveSlam> slam = LiveSlam::make({}, navigation, {}, cells());
  EXPECT_TRUE(slam) << slam.error().message;
  return *std::move(slam);
}

template <class Event>
std::vector<Event> only(const std::vector<LiveEvent>& events) {
  std::vector<Event> found;
  for (const LiveEvent& event : events) {
    if (const auto* const one = std::get_if<Event>(&event)) found.push_back(*one);
  }
  return found;
}

// Kills samples that come too late for their sweep, a map along other poses than those of the path, and a path that is
// not corrected.
TEST(LiveSlam, IsWhatSlamSaysOfTheRecording) {
  const SimulatedDrive drive = harbour_drive();
  LiveSlam slam = slam_with(LiveSlam::Navigation::kSome);
  run(drive, slam);
  const LiveSlamStatus status = slam.status();
  EXPECT_GE(status.corrections, 1U) << "the first sweeps have no pose before that";
  EXPECT_LT(slam.report().no_pose.count, drive.beams.size() / 4);
  ASSERT_TRUE(slam.finish());
  EXPECT_EQ(slam.status().motion, LiveMotion::kVelocity);
  ASSERT_TRUE(slam.status().by);
  EXPECT_EQ(slam.status().by->velocity, "DVL");
  EXPECT_EQ(slam.status().by->heading, "IMU");
  const auto chosen = only<live_event::MotionChosen>(slam.take_events());
  ASSERT_EQ(chosen.size(), 1U);
  EXPECT_EQ(chosen.front().velocity, "DVL");
  EXPECT_EQ(chosen.front().heading, "IMU");
  EXPECT_GT(chosen.front().deviation_m_sqrt_s.value_or(0.0), 0.0);

  ASSERT_TRUE(slam.solution());
  expect_equal(slam.solution()->trajectory, replay(drive).trajectory);
  const auto path = slam.path();
  ASSERT_TRUE(path);
  EXPECT_TRUE(file_of(slam.map()) == map_along(*path, drive.beams));
  EXPECT_EQ(slam.report().beams + slam.report().skipped, drive.beams.size());
  const auto told = score_trajectory(slam.solution()->trajectory, drive.truth);
  const auto corrected = score_trajectory(*path, drive.truth);
  ASSERT_TRUE(told && corrected);
  EXPECT_LT(corrected->se2.rmse_m, told->se2.rmse_m);
  EXPECT_LT(corrected->se2.rmse_m, 0.2);
}

/// Without the sources of these quantities.
SimulatedDrive without(SimulatedDrive drive, std::vector<NavQuantity> quantities) {
  std::erase_if(drive.sources, [&](const NavSource& source) {
    return std::ranges::find(quantities, source.quantity) != quantities.end();
  });
  return drive;
}

TEST(LiveSlam, FindsTheMotionByTheSonarWhereThereIsNoVelocity) {
  const SimulatedDrive drive = without(harbour_drive(), {NavQuantity::kVelocity});
  LiveSlam slam = slam_with(LiveSlam::Navigation::kSome);
  run(drive, slam);
  ASSERT_TRUE(slam.finish());
  const auto chosen = only<live_event::MotionChosen>(slam.take_events());
  ASSERT_EQ(chosen.size(), 1U);
  EXPECT_EQ(chosen.front().motion, LiveMotion::kSonarAndHeading);
  EXPECT_EQ(chosen.front().heading, "IMU");
  EXPECT_FALSE(chosen.front().deviation_m_sqrt_s);
  ASSERT_TRUE(slam.solution() && slam.path());
  EXPECT_TRUE(slam.status().by->by_sonar);
  expect_equal(slam.solution()->trajectory, replay(drive).trajectory);
  EXPECT_TRUE(file_of(slam.map()) == map_along(*slam.path(), drive.beams));
}

TEST(LiveSlam, FindsTheMotionByTheGyroAndTheSonar) {
  const SimulatedDrive drive = without(harbour_drive(), {NavQuantity::kVelocity, NavQuantity::kAttitude});
  LiveSlam slam = slam_with(LiveSlam::Navigation::kSome);
  run(drive, slam);
  ASSERT_TRUE(slam.finish());
  EXPECT_EQ(slam.status().motion, LiveMotion::kSonarAndHeading);
  ASSERT_TRUE(slam.solution());
  expect_equal(slam.solution()->trajectory, replay(drive).trajectory);
}

TEST(LiveSlam, FindsTheMotionByTheSonarAlone) {
  const SimulatedDrive drive = tank_drive();
  LiveSlam slam = slam_with(LiveSlam::Navigation::kNone);
  run(drive, slam);
  ASSERT_TRUE(slam.finish());
  EXPECT_EQ(slam.status().motion, LiveMotion::kSonar);
  ASSERT_TRUE(slam.solution() && slam.path());
  expect_equal(slam.solution()->trajectory, replay(drive).trajectory);
  EXPECT_TRUE(file_of(slam.map()) == map_along(*slam.path(), drive.beams));
}

// Kills a drive without a word where nothing tells how the vehicle moves.
TEST(LiveSlam, SaysThatNothingTellsTheMotion) {
  SimulatedDrive drive = harbour_drive();
  drive.sources.clear();
  drive.beams.resize(400);
  for (Beam& beam : drive.beams) std::ranges::fill(beam.intensities, 0);
  LiveSlam slam = slam_with(LiveSlam::Navigation::kNone);
  run(drive, slam);
  const auto finished = slam.finish();
  ASSERT_FALSE(finished);
  EXPECT_EQ(finished.error().code, Error::Code::kUnsupported);
  EXPECT_TRUE(slam.map().empty());
  EXPECT_EQ(slam.report().no_pose.count, drive.beams.size());
  EXPECT_FALSE(slam.path());
}

}  // namespace
}  // namespace pingvox::test
