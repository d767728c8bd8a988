// SLAM while beams and navigation of a simulated harbour come. Maps are corrected in a thread.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "live/live_slam.hpp"
#include "pingvox/geometry/pose2.hpp"
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
SimulatedDrive harbour_drive(std::uint64_t seed = 1) {
  constexpr double kDuration_s = 110.0;
  const Scene scene = harbour_scene({});
  SonarOptions sonar;
  sonar.seed = seed;
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

/// Gives all of a drive, each sample of the navigation when it is made. Each source is a device.
/// @param look  called after each step of time
void run(const SimulatedDrive& drive, LiveSlam& slam, const std::function<void(double)>& look = nullptr) {
  std::vector<std::size_t> next(drive.sources.size(), 0);
  std::size_t given = 0;
  for (double now_s = 0.0; given < drive.beams.size(); now_s += 0.02) {
    for (std::size_t s = 0; s < drive.sources.size(); ++s) {
      const NavSource& source = drive.sources[s];
      for (; next[s] < source.samples.size() && source.samples[next[s]].time_s <= now_s; ++next[s]) {
        slam.add(s, source.name, source.quantity, source.samples[next[s]]);
      }
    }
    for (; given < drive.beams.size() && drive.beams[given].time_s <= now_s; ++given) {
      if (slam.may_come(drive.beams[given].time_s, now_s)) break;
      const auto added = slam.add(drive.beams[given], now_s);
      ASSERT_TRUE(added) << added.error().message;
    }
    ASSERT_TRUE(slam.update(now_s));
    if (look) look(now_s);
  }
  // The recording ends a bit later.
  for (std::size_t s = 0; s < drive.sources.size(); ++s) {
    const NavSource& source = drive.sources[s];
    for (; next[s] < source.samples.size(); ++next[s]) {
      slam.add(s, source.name, source.quantity, source.samples[next[s]]);
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

/// A map with beams along a path.
OccupancyMap extended(OccupancyMap map, const Trajectory& path, const std::vector<Beam>& beams) {
  Result<BeamMapper> mapper = BeamMapper::make({}, map);
  EXPECT_TRUE(mapper);
  for (const Beam& beam : beams) EXPECT_TRUE(mapper->add(beam, path.at(beam.time_s)));
  EXPECT_TRUE(mapper->finish());
  return map;
}

std::string map_along(const Trajectory& path, const std::vector<Beam>& beams) {
  return file_of(extended(OccupancyMap(cells()), path, beams));
}

/// Of the harbour, by an earlier drive along its walls.
OccupancyMap harbour_map() {
  const SimulatedDrive drive = harbour_drive(9);
  return extended(OccupancyMap(cells()), drive.truth, drive.beams);
}

LiveSlam slam_in(OccupancyMap map, std::size_t devices, std::optional<StartPose> start) {
  Result<LiveSlam> slam = LiveSlam::make({}, devices, {}, LiveSlam::KnownMap{std::move(map), "harbour.ot", start});
  EXPECT_TRUE(slam) << slam.error().message;
  return *std::move(slam);
}

LiveSlam slam_with(std::size_t devices) {
  Result<LiveSlam> slam = LiveSlam::make({}, devices, {}, cells());
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
  LiveSlam slam = slam_with(drive.sources.size());
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

/// Greatest distance from where the vehicle was, in the frame of the truth.
double farthest_m(const Trajectory& path, const Trajectory& truth) {
  double farthest_m = 0.0;
  for (const StampedPose& pose : path.poses()) {
    const Eigen::Vector3d place_m = truth.at(pose.time_s).value_or(truth.poses().back().map_from_body).translation();
    farthest_m = std::max(farthest_m, (pose.map_from_body.translation() - place_m).head<2>().norm());
  }
  return farthest_m;
}

void expect_located(const SimulatedDrive& drive, std::optional<StartPose> start) {
  const OccupancyMap known = harbour_map();
  LiveSlam slam = slam_in(known, drive.sources.size(), start);
  EXPECT_TRUE(file_of(slam.map()) == file_of(known));
  double located_s = 0.0;
  run(drive, slam, [&](double now_s) {
    if (!slam.status().located) located_s = now_s;
  });
  testing::Test::RecordProperty("located_s", std::to_string(located_s));
  const LiveSlamStatus status = slam.status();
  ASSERT_TRUE(status.located) << "before the end";
  EXPECT_LT(status.located->deviation_m, 0.3);
  ASSERT_TRUE(slam.finish());
  EXPECT_EQ(only<live_event::Located>(slam.take_events()).size(), 1U);
  const auto path = slam.path();
  ASSERT_TRUE(path);
  EXPECT_GT(path->poses().size(), drive.beams.size() * 9 / 10) << "also before it was located";
  EXPECT_LT(farthest_m(*path, drive.truth), 0.6);
  expect_equal(slam.solution()->trajectory, replay(drive).trajectory);
  EXPECT_TRUE(file_of(slam.map()) == file_of(extended(known, *path, drive.beams)));
}

// Kills poses in the frame of SLAM, a map that is restarted with a correction, and odometry that jumps with solutions.
TEST(LiveSlam, IsLocatedAnywhereInAKnownMap) {
  expect_located(harbour_drive(), std::nullopt);
}

TEST(LiveSlam, IsLocatedNearItsStart) {
  SimulatedDrive drive = harbour_drive();
  drive.beams.resize(1500);
  const Pose& first = drive.truth.poses().front().map_from_body;
  const Pose2 start = pose2_of(first);
  expect_located(drive, StartPose{start.place_m.x() + 0.3, start.place_m.y() - 0.2, start.yaw_rad + 0.1});
}

// Kills a map that gets beams at poses that are not in its frame.
TEST(LiveSlam, ExtendsNoMapThatItIsNotLocatedIn) {
  const SimulatedDrive tank = tank_drive();
  const OccupancyMap known = extended(OccupancyMap(cells()), tank.truth, tank.beams);
  SimulatedDrive drive = harbour_drive();
  drive.beams.resize(1000);
  LiveSlam slam = slam_in(known, drive.sources.size(), std::nullopt);
  run(drive, slam);
  EXPECT_FALSE(slam.status().located);
  EXPECT_FALSE(slam.pose()) << "no obstacles are sent around it";
  const auto finished = slam.finish();
  ASSERT_FALSE(finished);
  EXPECT_EQ(finished.error().code, Error::Code::kUnsupported);
  EXPECT_NE(finished.error().message.find("harbour.ot"), std::string::npos);
  EXPECT_TRUE(file_of(slam.map()) == file_of(known));
  EXPECT_FALSE(slam.path());
  EXPECT_EQ(slam.report().beams, 0U);
  EXPECT_EQ(only<live_event::NotLocated>(slam.take_events()).size(), 1U);
}

TEST(LiveSlam, SaysThatAKnownMapHasNoWallsAtItsDepth) {
  SimulatedDrive drive = harbour_drive();
  drive.beams.resize(300);
  LiveSlam slam = slam_in(OccupancyMap(cells()), drive.sources.size(), std::nullopt);
  run(drive, slam);
  EXPECT_FALSE(slam.finish());
  const auto failed = only<live_event::SlamFailed>(slam.take_events());
  ASSERT_EQ(failed.size(), 1U);
  EXPECT_NE(failed.front().error.message.find("harbour.ot"), std::string::npos);
}

/// Without a valid velocity for some time.
SimulatedDrive without_bottom(SimulatedDrive drive, double from_s, double to_s) {
  for (NavSource& source : drive.sources) {
    if (source.quantity != NavQuantity::kVelocity) continue;
    for (NavSample& sample : source.samples) {
      if (sample.time_s < from_s || sample.time_s >= to_s) continue;
      sample.valid = false;
      sample.value.setZero();
    }
  }
  return drive;
}

// Kills beams without a pose while the bottom is lost, a standard deviation that stays, and other poses than those of
// the recording.
TEST(LiveSlam, GoesOnWhileTheBottomIsLost) {
  constexpr double kFrom_s = 40.0, kTo_s = 58.0;
  const SimulatedDrive drive = without_bottom(harbour_drive(), kFrom_s, kTo_s);
  LiveSlam slam = slam_with(drive.sources.size());
  std::size_t lost = 0, known = 0;
  double deviation_m = 0.0, longest_s = 0.0;
  run(drive, slam, [&](double now_s) {
    const LiveSlamStatus status = slam.status();
    longest_s = std::max(longest_s, status.without_velocity_s);
    if (now_s < kFrom_s + 2.0 || now_s > kTo_s) return;
    ++lost;
    const std::optional<StampedPose> pose = slam.pose();
    known += pose && pose->time_s > now_s - 1.0 ? 1 : 0;
    deviation_m = std::max(deviation_m, status.deviation_m);
  });
  EXPECT_GT(known, lost * 9 / 10);
  EXPECT_GT(deviation_m, 0.5) << "grows";
  EXPECT_GT(longest_s, 17.0);
  EXPECT_LT(slam.status().without_velocity_s, 1.0) << "it came again";
  EXPECT_LT(slam.status().deviation_m, 0.4);
  ASSERT_TRUE(slam.finish());
  const std::vector<LiveEvent> events = slam.take_events();
  EXPECT_EQ(only<live_event::VelocityEnded>(events).size(), 1U);
  const auto resumed = only<live_event::VelocityResumed>(events);
  ASSERT_EQ(resumed.size(), 1U);
  EXPECT_EQ(resumed.front().velocity, "DVL");
  EXPECT_GT(resumed.front().missing_s, kTo_s - kFrom_s - 1.0);
  EXPECT_LT(resumed.front().missing_s, kTo_s - kFrom_s + 1.0);
  expect_equal(slam.solution()->trajectory, replay(drive).trajectory);
  EXPECT_TRUE(file_of(slam.map()) == map_along(*slam.path(), drive.beams));
  const auto score = score_trajectory(*slam.path(), drive.truth);
  ASSERT_TRUE(score);
  EXPECT_LT(score->se2.rmse_m, 0.3);
}

// Kills a position that is lost without a word, and a depth and heading that are lost with it.
TEST(LiveSlam, SaysThatThePositionIsUncertain) {
  constexpr double kFrom_s = 40.0, kTo_s = 70.0;
  SimulatedDrive drive = without_bottom(harbour_drive(), kFrom_s, kTo_s);
  for (Beam& beam : drive.beams) {
    if (beam.time_s > kFrom_s - 5.0 && beam.time_s < kTo_s) std::ranges::fill(beam.intensities, 0);
  }
  LiveSlam slam = slam_with(drive.sources.size());
  std::size_t looks = 0, known = 0;
  run(drive, slam, [&](double now_s) {
    if (now_s < kFrom_s + 15.0 || now_s > kTo_s - 2.0) return;
    const LiveSlamStatus status = slam.status();
    ++looks;
    EXPECT_FALSE(slam.pose()) << now_s;
    EXPECT_GT(status.deviation_m, 3.0) << now_s;
    if (!status.predicted) return;
    const std::optional<Pose> truth = drive.truth.at(std::min(now_s, status.predicted->time_s));
    ASSERT_TRUE(truth);
    const double off_rad =
        Eigen::AngleAxisd(truth->linear().transpose() * status.predicted->map_from_body.linear()).angle();
    known += off_rad < 0.1 ? 1 : 0;
  });
  EXPECT_GT(looks, 100U);
  EXPECT_GT(known, looks * 9 / 10);
  EXPECT_EQ(only<live_event::PositionUncertain>(slam.take_events()).size(), 1U);
}

/// A DVL that is switched on, as the sonar is, and says nothing at first.
SimulatedDrive with_late_velocity(SimulatedDrive drive, double from_s) {
  for (NavSource& source : drive.sources) {
    if (source.quantity != NavQuantity::kVelocity) continue;
    std::erase_if(source.samples, [from_s](const NavSample& sample) { return sample.time_s < from_s; });
  }
  return drive;
}

// Kills a motion that is decided before a device of the navigation has spoken.
TEST(LiveSlam, WaitsForADeviceThatSpeaksLater) {
  const SimulatedDrive drive = with_late_velocity(harbour_drive(), 20.0);
  LiveSlam slam = slam_with(drive.sources.size());
  run(drive, slam);
  ASSERT_TRUE(slam.finish());
  EXPECT_EQ(slam.status().motion, LiveMotion::kVelocity);
  ASSERT_TRUE(slam.solution());
  expect_equal(slam.solution()->trajectory, replay(drive).trajectory);
}

// Kills waiting without end for one that does not speak.
TEST(LiveSlam, GoesOnWithoutADeviceThatIsSilent) {
  const SimulatedDrive drive = with_late_velocity(harbour_drive(), 40.0);
  LiveSlam slam = slam_with(drive.sources.size());
  double decided_s = 0.0;
  run(drive, slam, [&](double now_s) {
    if (decided_s == 0.0 && slam.status().motion != LiveMotion::kUndecided) decided_s = now_s;
  });
  EXPECT_GT(decided_s, 29.0);
  EXPECT_LT(decided_s, 31.0);
  EXPECT_EQ(slam.status().motion, LiveMotion::kSonarAndHeading);
  ASSERT_TRUE(slam.finish());
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
  LiveSlam slam = slam_with(drive.sources.size());
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
  LiveSlam slam = slam_with(drive.sources.size());
  run(drive, slam);
  ASSERT_TRUE(slam.finish());
  EXPECT_EQ(slam.status().motion, LiveMotion::kSonarAndHeading);
  ASSERT_TRUE(slam.solution());
  expect_equal(slam.solution()->trajectory, replay(drive).trajectory);
}

TEST(LiveSlam, FindsTheMotionByTheSonarAlone) {
  const SimulatedDrive drive = tank_drive();
  LiveSlam slam = slam_with(0);
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
  LiveSlam slam = slam_with(0);
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
