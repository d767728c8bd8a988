#include "pingvox/live/live_mapping.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "device/internal/link.hpp"
#include "device/recording.hpp"
#include "live/dive.hpp"
#include "live/live_navigation.hpp"
#include "live/recordings.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/mapping/build_map.hpp"

namespace pingvox::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

using Power = Dive::Power;

LiveOptions with_autopilot() {
  LiveOptions options;
  options.nav = {{.kind = LiveNav::Kind::kMavlink, .address = "udp://127.0.0.1:0"}};
  return options;
}

/// Stands 3 m east and 2 m north of its origin, 1 m deep, and heads east.
Pose vehicle_at(double) {
  return pose_from_rpy({3.0, 2.0, -1.0}, 0.0, 0.0, 0.0);
}

NavEmulator autopilot() {
  return {{.reports_per_s = 20.0}, NavEmulator::mavlink(vehicle_at)};
}

/// The map of a log, as `pingvox map` makes it.
OccupancyMap map_of_log(const std::string& path) {
  OccupancyMap map({.resolution_m = 0.1});
  Result<std::unique_ptr<BeamSource>> log =
      ByteStream::open(path).and_then([](ByteStream stream) { return open_beams(std::move(stream)); });
  EXPECT_TRUE(log);
  BuildOptions options;
  options.model = HeadOptions().apply_to(options.model, (*log)->device());
  EXPECT_TRUE(build_map(**log, Trajectory::still(Pose::Identity()), options, map));
  return map;
}

TEST(LiveMapping, ItsMapIsThatOfItsRecordingToTheBit) {
  const Folder folder;
  const std::string path = folder.path("dive.bin");
  LiveOptions options;
  options.record = path;
  Dive dive(options);
  dive.run_until_beams(130);
  ASSERT_TRUE(dive.live().finish());
  const LiveStatus status = dive.live().status();
  EXPECT_EQ(status.mapped, status.beams);
  EXPECT_EQ(status.waiting, 0U);
  EXPECT_EQ(dive.live().report().sweeps, 3U);
  const SweepCoverage coverage = dive.live().coverage();
  EXPECT_EQ(coverage.beams, status.mapped);
  EXPECT_EQ(coverage.sweeps, 4U) << "with the one that is not complete";
  EXPECT_GE(coverage.sweeps_per_place, 3.0);
  EXPECT_EQ(coverage.moved_m, 0.0);
  EXPECT_THAT(dive.live().recordings(), ElementsAre(path));
  EXPECT_EQ(dive.live().map().classify(Eigen::Vector3d(kWall_m + 0.05, 0.0, 0.0)), Occupancy::kOccupied);
  EXPECT_EQ(bytes_of(dive.live().map()), bytes_of(map_of_log(path)));

  // So is that of a replay, which ends.
  LiveOptions replay;
  replay.head = {.kind = LiveHead::Kind::kReplay, .address = path, .speed = std::numeric_limits<double>::infinity()};
  replay.map.resolution_m = 0.1;
  Result<LiveMapping> again = LiveMapping::open(replay);
  ASSERT_TRUE(again) << again.error().message;
  std::size_t steps = 0;
  while (again->step().value_or(false)) ++steps;
  EXPECT_GE(steps, status.beams);
  EXPECT_FALSE(again->step().value_or(true)) << "after the end";
  ASSERT_TRUE(again->finish());
  EXPECT_EQ(bytes_of(again->map()), bytes_of(dive.live().map()));
  EXPECT_THAT(again->take_events(), IsEmpty());
  EXPECT_THAT(again->recordings(), IsEmpty());
}

TEST(LiveMapping, GoesOnRecordingWhereTheMapCannotGrow) {
  const Folder folder;
  LiveOptions options;
  options.record = folder.path("dive.bin");
  options.map.memory_limit_bytes = 1;
  Dive dive(options);
  dive.run_until_beams(130);
  EXPECT_TRUE(dive.live().finish()) << "its error was an event";
  const auto failed = events_of<live_event::MappingFailed>(dive.events());
  ASSERT_THAT(failed, SizeIs(1));
  EXPECT_EQ(failed.front().error.code, Error::Code::kLimit);
  EXPECT_NE(error_of(failed.front()), nullptr);
  EXPECT_EQ(error_of(live_event::PosesEnded{}), nullptr);
  const LiveStatus status = dive.live().status();
  EXPECT_GT(status.not_mapped, 50U);
  EXPECT_EQ(status.mapped + status.not_mapped, status.beams);
  EXPECT_THAT(beams_in(*options.record), SizeIs(status.beams));
}

TEST(LiveMapping, CountsBeamsWithoutAPose) {
  Dive dive(with_autopilot());
  dive.run_for(7.0);
  const LiveStatus before = dive.live().status();
  EXPECT_GT(before.without_pose, 100U);
  EXPECT_EQ(before.not_mapped, before.without_pose) << "at once, not when their sweep ends";
  ASSERT_TRUE(dive.live().finish());
  const LiveStatus status = dive.live().status();
  EXPECT_EQ(status.without_pose, status.beams) << "each once";
  EXPECT_EQ(status.not_mapped, status.beams);
  EXPECT_EQ(status.mapped, 0U);
  EXPECT_TRUE(dive.live().map().empty());
  const auto missing = events_of<live_event::NoSourceYet>(dive.events());
  ASSERT_THAT(missing, SizeIs(1));
  EXPECT_EQ(missing.front().messages, 0U);
  EXPECT_THAT(dive.events(), SizeIs(2)) << "and the head is connected";
}

TEST(LiveMapping, MapsWhereTheAutopilotSaysAndTellsEachEventOnce) {
  Dive dive(with_autopilot());
  dive.set_autopilot(autopilot());
  dive.run_until_beams(200);
  const auto connected = events_of<live_event::Connected>(dive.events());
  ASSERT_THAT(connected, SizeIs(1));
  EXPECT_THAT(connected.front().device, HasSubstr("ping360:udp://127.0.0.1:"));
  const auto chosen = events_of<live_event::SourcesChosen>(dive.events());
  ASSERT_THAT(chosen, SizeIs(1));
  EXPECT_EQ(chosen.front().attitude, "ATTITUDE");
  EXPECT_EQ(chosen.front().position, "LOCAL_POSITION_NED");
  EXPECT_THAT(dive.events(), SizeIs(2));

  dive.set_autopilot(std::nullopt);
  dive.run_for(7.0);
  dive.set_autopilot(autopilot());
  dive.run_for(2.0);
  EXPECT_THAT(events_of<live_event::PosesEnded>(dive.events()), SizeIs(1));
  EXPECT_THAT(events_of<live_event::PosesResumed>(dive.events()), SizeIs(1));
  EXPECT_THAT(dive.events(), SizeIs(4));

  ASSERT_TRUE(dive.live().finish());
  const LiveStatus status = dive.live().status();
  ASSERT_THAT(status.nav, SizeIs(1));
  EXPECT_THAT(status.nav.front().vehicle, HasSubstr("(system 1)"));
  EXPECT_GT(status.without_pose, 100U);
  EXPECT_GT(status.mapped, 100U);
  EXPECT_EQ(status.position, "LOCAL_POSITION_NED");
  const OccupancyMap& map = dive.live().map();
  EXPECT_EQ(map.classify(Eigen::Vector3d(3.0 + kWall_m + 0.05, 2.0, -1.0)), Occupancy::kOccupied);
  EXPECT_EQ(map.classify(Eigen::Vector3d(3.0, 2.0 + kWall_m + 0.05, -1.0)), Occupancy::kOccupied);
  EXPECT_EQ(map.classify(Eigen::Vector3d(-1.0, 0.0, 0.0)), Occupancy::kUnknown);
}

/// The same behind a line that keeps each message for some seconds.
NavEmulator late_autopilot(double late_s) {
  return {{.reports_per_s = 20.0},
          [=, say = NavEmulator::mavlink(vehicle_at)](double now_s) { return say(now_s - late_s); }};
}

// Kills losing all beams without a word while poses come.
TEST(LiveMapping, TellsThatPosesAreBehindTheBeams) {
  constexpr double kLate_s = 3.0;
  Dive dive(with_autopilot());
  dive.set_autopilot(autopilot());
  dive.run_for(4.0);
  dive.set_autopilot(std::nullopt);
  dive.run_for(kLate_s);
  dive.set_autopilot(late_autopilot(kLate_s));
  dive.run_for(14.0);
  const auto lost = events_of<live_event::BeamsWithoutPose>(dive.events());
  ASSERT_THAT(lost, SizeIs(1));
  EXPECT_GT(lost.front().without_pose, 100U);
  EXPECT_GE(lost.front().beams, lost.front().without_pose);
  EXPECT_NEAR(lost.front().within_s, 5.0, 0.5);
  ASSERT_TRUE(lost.front().behind_s);
  EXPECT_NEAR(*lost.front().behind_s, kLate_s, 0.2);
  EXPECT_FALSE(lost.front().apart_s) << "the pause of three seconds is not why";
  EXPECT_THAT(events_of<live_event::BeamsWithPose>(dive.events()), IsEmpty());

  dive.set_autopilot(autopilot());
  dive.run_for(11.0);
  EXPECT_THAT(events_of<live_event::BeamsWithPose>(dive.events()), SizeIs(1));
  EXPECT_THAT(events_of<live_event::BeamsWithoutPose>(dive.events()), SizeIs(1));
  EXPECT_THAT(events_of<live_event::PosesEnded>(dive.events()), IsEmpty()) << "they came all the time";
}

// By their times they end at once, and before their sources are chosen.
TEST(LiveMapping, PosesThatAreTenSecondsBehindHaveNotEnded) {
  constexpr double kLate_s = 10.0;
  Dive dive(with_autopilot());
  // Its clock is known before its poses are.
  dive.set_autopilot(
      NavEmulator({.reports_per_s = 20.0}, [say = NavEmulator::mavlink(vehicle_at)](double now_s) mutable {
        std::vector<NavEmulator::Message> messages = say(now_s);
        return std::vector<NavEmulator::Message>{messages.back()};
      }));
  dive.run_for(1.0);
  dive.set_autopilot(std::nullopt);
  dive.run_for(kLate_s);
  dive.set_autopilot(late_autopilot(kLate_s));
  dive.run_for(10.0);
  EXPECT_THAT(events_of<live_event::SourcesChosen>(dive.events()), SizeIs(1));
  EXPECT_THAT(events_of<live_event::PosesEnded>(dive.events()), IsEmpty());
  const auto lost = events_of<live_event::BeamsWithoutPose>(dive.events());
  ASSERT_THAT(lost, SizeIs(1));
  EXPECT_NEAR(lost.front().behind_s.value_or(0.0), kLate_s, 0.2);
}

// Kills the clocks as the reason of beams between poses that come too seldom.
TEST(LiveMapping, TellsThatPosesAreTooFarApart) {
  Dive dive(with_autopilot());
  dive.set_autopilot(NavEmulator({.reports_per_s = 0.4}, NavEmulator::mavlink(vehicle_at)));
  dive.run_for(30.0);
  const auto lost = events_of<live_event::BeamsWithoutPose>(dive.events());
  ASSERT_THAT(lost, SizeIs(1));
  EXPECT_LT(lost.front().without_pose, lost.front().beams);
  EXPECT_GT(2 * lost.front().without_pose, lost.front().beams);
  EXPECT_NEAR(lost.front().apart_s.value_or(0.0), 2.5, 0.1);
  EXPECT_FALSE(lost.front().behind_s);
  EXPECT_THAT(events_of<live_event::BeamsWithPose>(dive.events()), IsEmpty()) << "some have one all the time";
}

// Kills warnings of beams that wait for their pose, and of pauses.
TEST(LiveMapping, SeldomPosesAndPausesAreNoWrongClocks) {
  Dive dive(with_autopilot());
  dive.run_for(6.0);
  dive.set_autopilot(NavEmulator({.reports_per_s = 1.0}, NavEmulator::mavlink(vehicle_at)));
  dive.run_for(12.0);
  dive.set_head(Power::kOff);
  dive.run_for(6.5);
  dive.set_head(Power::kOn);
  dive.run_for(11.0);
  for (const double pause_s : {4.0, 7.0}) {
    dive.set_autopilot(std::nullopt);
    dive.run_for(pause_s);
    dive.set_autopilot(autopilot());
    dive.run_for(11.0);
  }
  ASSERT_TRUE(dive.live().finish());
  EXPECT_GT(dive.live().status().without_pose, 300U);
  EXPECT_THAT(events_of<live_event::PosesEnded>(dive.events()), SizeIs(1)) << "of the second pause";
  EXPECT_THAT(events_of<live_event::BeamsWithoutPose>(dive.events()), IsEmpty());
  EXPECT_THAT(events_of<live_event::BeamsWithPose>(dive.events()), IsEmpty());
  EXPECT_THAT(events_of<live_event::ClocksDiffer>(dive.events()), IsEmpty());
}

// Kills beams that do not wait because the clock of their stamps is behind that of this host.
TEST(LiveNavigation, ABeamWaitsForItsPoseFromWhenItCame) {
  Recordings none(std::nullopt);
  Result<LiveNavigation> nav = LiveNavigation::open({{.kind = LiveNav::Kind::kMavlink, .address = "udp://127.0.0.1:0"}},
                                                    none, 0.0, std::nullopt);
  ASSERT_TRUE(nav) << nav.error().message;
  ASSERT_TRUE(nav->step(13.0));
  for (const double stamp_s : {9.0, 12.5, 30.0}) {
    EXPECT_TRUE(nav->may_come(stamp_s, 12.5)) << stamp_s;
    EXPECT_FALSE(nav->may_come(stamp_s, 11.9)) << stamp_s;
  }
}

// Positions are relative to another origin then.
TEST(LiveMapping, TellsOnceThatTheAutopilotHasRestarted) {
  Dive dive(with_autopilot());
  dive.set_autopilot(autopilot());
  dive.run_for(5.0);
  const double restart_s = dive.now_s();
  dive.set_autopilot(NavEmulator({.reports_per_s = 20.0}, [=, say = NavEmulator::mavlink(vehicle_at)](double now_s) {
    return say(now_s - restart_s);
  }));
  dive.run_for(5.0);
  const auto restarted = events_of<live_event::SenderRestarted>(dive.events());
  ASSERT_THAT(restarted, SizeIs(1));
  EXPECT_EQ(restarted.front().position, "LOCAL_POSITION_NED");
  EXPECT_EQ(restarted.front().device, dive.live().status().nav.front().name);
}

TEST(LiveMapping, TellsThatTheHeadIsLostAndFound) {
  Dive dive;
  dive.run_until_beams(10);
  dive.set_head(Power::kOff);
  dive.run_for(60.0);
  const auto lost = events_of<live_event::NotConnected>(dive.events());
  ASSERT_THAT(lost, SizeIs(1)) << "however often it is tried";
  EXPECT_THAT(lost.front().reason, HasSubstr("no answer"));
  EXPECT_FALSE(dive.live().status().head.is_connected);
  dive.set_head(Power::kOn);
  dive.run_until_beams(30);
  EXPECT_THAT(events_of<live_event::Connected>(dive.events()), SizeIs(2));
  EXPECT_EQ(dive.live().status().head.connections, 2U);
}

/// An autopilot that is sent obstacles.
class Pilot {
 public:
  std::string address() const { return line_->address(); }
  /// Messages since it was asked last.
  std::size_t received() {
    std::array<std::uint8_t, 300> bytes = {};
    std::size_t messages = 0;
    while (line_->read(bytes).value_or(0) > 0) ++messages;
    return messages;
  }

 private:
  Result<Link> line_ = Link::listen("udp://127.0.0.1:0");
};

// Kills sectors that a silent sonar calls free.
TEST(LiveMapping, SendsObstaclesWhileBeamsCome) {
  Pilot pilot;
  LiveOptions options;
  options.obstacles = pilot.address();
  Dive dive(options);
  dive.run_until_beams(130);
  EXPECT_GE(pilot.received(), 5U);
  dive.set_head(Power::kOff);
  dive.run_for(6.0);
  EXPECT_GE(pilot.received(), 5U) << "of the first five seconds";
  dive.run_for(5.0);
  EXPECT_EQ(pilot.received(), 0U);
}

// Kills obstacles around where the vehicle was long ago.
TEST(LiveMapping, SendsObstaclesWhileItsPoseIsKnown) {
  Pilot pilot;
  LiveOptions options = with_autopilot();
  options.obstacles = pilot.address();
  Dive dive(options);
  dive.set_autopilot(autopilot());
  dive.run_until_beams(200);
  EXPECT_GE(pilot.received(), 5U);
  dive.set_autopilot(std::nullopt);
  dive.run_for(3.0);
  EXPECT_GE(pilot.received(), 5U) << "of the first two seconds";
  dive.run_for(3.0);
  EXPECT_EQ(pilot.received(), 0U);
}

// They would be in the way of the next run.
TEST(LiveMapping, ARunThatDoesNotBeginLeavesNoRecordings) {
  const Folder folder;
  const Result<Link> other = Link::listen("udp://127.0.0.1:0");
  ASSERT_TRUE(other);
  LiveOptions options;
  options.head.address = "udp://127.0.0.1:1";
  options.record = folder.path("dive.bin");
  options.nav = {{.kind = LiveNav::Kind::kMavlink, .address = other->address()}};
  const Result<LiveMapping> live = LiveMapping::open(options);
  ASSERT_FALSE(live);
  EXPECT_EQ(live.error().code, Error::Code::kIo);
  EXPECT_FALSE(std::filesystem::exists(*options.record));
}

TEST(LiveOptions, AllBrokenFieldsAreNamed) {
  LiveOptions options;
  options.head.address = "udp://127.0.0.1:1";
  EXPECT_TRUE(options.validate());
  options.head.ping360.range_m = 1000.0;
  options.head.address = "udp://host";
  options.nav = {{.kind = LiveNav::Kind::kA50, .address = "udp://dvl:16171"}, {.address = "tcp://:14550"}};
  options.record = "dive.tlog";
  options.obstacles = "tcp://a:1";
  options.map.resolution_m = 0.0;
  options.build.threads = 0;
  const Result<void> valid = options.validate();
  ASSERT_FALSE(valid);
  EXPECT_EQ(valid.error().code, Error::Code::kBadOption);
  for (const char* field :
       {"range_m", "udp://host", "udp://dvl:16171", "tcp://:14550", ".tlog", "obstacles", "resolution", "threads"}) {
    EXPECT_THAT(valid.error().message, HasSubstr(field));
  }
  EXPECT_THAT(valid.error().message, Not(HasSubstr("--"))) << "words of the command line";

  LiveOptions replay;
  replay.head = {.kind = LiveHead::Kind::kReplay, .address = "dive.bin", .speed = 0.0};
  replay.record = "again.bin";
  replay.nav = {{.address = "udp://:14550"}};
  const Result<void> replayed = replay.validate();
  ASSERT_FALSE(replayed);
  for (const char* field : {"speed", "record", "nav"}) EXPECT_THAT(replayed.error().message, HasSubstr(field));
}

}  // namespace
}  // namespace pingvox::test
