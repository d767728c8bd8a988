// Receivers of navigation and their emulators.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "device/internal/a50_receiver.hpp"
#include "device/internal/link.hpp"
#include "device/internal/live_source.hpp"
#include "device/internal/mavlink_receiver.hpp"
#include "device/internal/nav_emulator.hpp"
#include "nav/internal/live_poses.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/nav.hpp"
#include "support/folder.hpp"

namespace {

int syncs = 0, folder_syncs = 0;

}  // namespace

/// In place of the system's, so that its calls can be counted.
extern "C" int sync_file_range(int /*file*/, off64_t /*from*/, off64_t /*bytes*/, unsigned /*flags*/) {
  ++syncs;
  return 0;
}

/// The same of folders.
extern "C" int fsync(int file) {
  struct stat status = {};
  if (::fstat(file, &status) == 0 && S_ISDIR(status.st_mode)) ++folder_syncs;
  return 0;
}

namespace pingvox {
namespace {

using testing::HasSubstr;

/// Heads south-west of the origin, below it, rolled and pitched, and moves.
Pose pose_at(double time_s) {
  return pose_from_rpy({-3.0 + 0.2 * time_s, -2.0, -1.0 - 0.1 * time_s}, 0.1, -0.2, -2.5 + 0.05 * time_s);
}

void expect_near(const Pose& a, const Pose& b, double tolerance) {
  EXPECT_LT((a.matrix() - b.matrix()).cwiseAbs().maxCoeff(), tolerance) << a.matrix() << "\n\n" << b.matrix();
}

/// Reads until a sample came; lines take a moment.
std::vector<NavSource> read_some(A50Receiver& receiver, double now_s) {
  for (int i = 0; i < 2000; ++i) {
    std::vector<NavSource> samples = receiver.read(now_s);
    if (!samples.empty()) return samples;
    pollfd file = {receiver.descriptor(), POLLIN, 0};
    ::poll(&file, 1, 5);
  }
  return {};
}

/// Lets a host that connects in.
void let_in(Link& line, A50Receiver& receiver, double now_s) {
  std::array<std::uint8_t, 256> bytes;
  for (int i = 0; i < 2000; ++i) {
    receiver.read(now_s);
    ASSERT_TRUE(line.read(bytes));
    const int before = line.descriptor();
    pollfd file = {before, POLLIN, 0};
    ::poll(&file, 1, 1);
    ASSERT_TRUE(line.read(bytes));
    if (line.descriptor() != before || i > 20) return;
  }
}

// Kills a wrong sign or order of the angles, and axes that are not converted, in either direction.
TEST(NavEmulator, MavlinkSaysWhereTheVehicleIs) {
  NavEmulator vehicle({.reports_per_s = 20.0}, NavEmulator::mavlink(pose_at));
  MavlinkNav nav;
  LivePoses poses;
  std::size_t frames = 0;
  for (int i = 0; i < 60; ++i) {
    const double now_s = i / 16.0;  // a little slower than it could
    for (const NavEmulator::Message& message : vehicle.send(now_s)) {
      const MavlinkRead read = read_mavlink(message);
      ASSERT_TRUE(read.frame);
      ASSERT_EQ(read.frame->check, MavlinkFrame::Check::kRight);
      ASSERT_EQ(read.length, message.size());
      EXPECT_EQ(read.frame->sequence, frames++ % 256);
      for (const MavlinkNav::Report& report : nav.add(*read.frame, now_s)) {
        poses.add(report.source, report.quantity, report.sample);
        if (report.quantity != NavQuantity::kPressure) continue;
        EXPECT_NEAR(report.sample.value.x(), 101'325.0 + 1025.0 * 9.80665 * (1.0 + 0.1 * now_s), 10.0);
      }
    }
  }
  EXPECT_EQ(frames, 4U * 60U);
  const auto pose = poses.at(2.0);
  ASSERT_TRUE(pose);
  expect_near(*pose, pose_at(2.0), 1e-3);
}

// Kills an emulator whose position at the origin, where it is by default, is taken for none.
TEST(NavEmulator, AVehicleThatStandsAtTheOriginHasAPose) {
  NavEmulator vehicle({.reports_per_s = 10.0}, NavEmulator::mavlink([](double) { return Pose(Pose::Identity()); }));
  MavlinkNav nav;
  LivePoses poses;
  for (int i = 0; i < 30; ++i) {
    const double now_s = 0.1 * i;
    for (const NavEmulator::Message& message : vehicle.send(now_s)) {
      const MavlinkRead read = read_mavlink(message);
      ASSERT_TRUE(read.frame);
      for (const auto& report : nav.add(*read.frame, now_s)) poses.add(report.source, report.quantity, report.sample);
    }
  }
  const std::optional<Pose> pose = poses.at(1.5);
  ASSERT_TRUE(pose);
  expect_near(*pose, Pose::Identity(), 0.0011);
}

TEST(NavEmulator, FaultsAreThoseThatWereAskedFor) {
  NavEmulator vehicle({.reports_per_s = 1000.0, .lost = 0.1, .doubled = 0.2, .damaged = 0.3},
                      NavEmulator::mavlink(pose_at));
  std::size_t right = 0, wrong = 0;
  for (double now_s = 0.0; right + wrong < 8000; now_s += 1e-3) {
    for (const NavEmulator::Message& message : vehicle.send(now_s)) {
      const MavlinkRead read = read_mavlink(message);
      (read.frame && read.frame->check == MavlinkFrame::Check::kRight ? right : wrong)++;
    }
  }
  // A bit in the address of a message makes it another one, which is damage that nothing tells.
  EXPECT_NEAR(static_cast<double>(wrong) / static_cast<double>(right + wrong), 0.3, 0.03);
  EXPECT_FALSE(NavEmulatorOptions{.lost = 0.6}.validate());
  EXPECT_FALSE(NavEmulatorOptions{.reports_per_s = std::nan("")}.validate());
}

TEST(NavEmulator, DoesNotMakeUpForReportsThatAreOverdue) {
  constexpr double kReports_per_s = 10.0;
  NavEmulator vehicle({.reports_per_s = kReports_per_s}, NavEmulator::a50(pose_at));
  std::size_t reports = 0;
  const auto run = [&](double from_s, double to_s) {
    reports = 0;
    for (double now_s = from_s; now_s < to_s; now_s += 0.01) reports += vehicle.send(now_s).empty() ? 0 : 1;
  };
  run(0.0, 5.0);
  EXPECT_NEAR(static_cast<double>(reports), 5.0 * kReports_per_s, 6.0);
  run(60.0, 65.0);
  EXPECT_NEAR(static_cast<double>(reports), 5.0 * kReports_per_s, 6.0) << "after a pause of 55 s";
}

// The recording is what `map --nav` reads: the same samples, on the clock of the host.
TEST(A50Receiver, ConnectsAgainAndRecordsWhatItReads) {
  const test::Folder folder;
  const std::string path = folder.path("dive.jsonl");
  Result<Link> line = Link::listen("tcp://127.0.0.1:0");
  ASSERT_TRUE(line) << line.error().message;
  const std::string address = line->address();
  Result<RecordFile> recorder = RecordFile::create(path);
  ASSERT_TRUE(recorder);
  constexpr double kStart_s = 1'764'000'000.0;
  Result<A50Receiver> receiver = A50Receiver::make(address, *std::move(recorder), kStart_s);
  ASSERT_TRUE(receiver);

  LivePoses poses;
  std::size_t samples = 0;
  double now_s = 0.0;
  constexpr std::size_t kRounds = 100;
  NavEmulator dvl({.reports_per_s = 10.0}, NavEmulator::a50(pose_at));
  for (std::size_t round = 1; round <= kRounds; ++round) {
    SCOPED_TRACE(round);
    let_in(*line, *receiver, now_s);
    for (const NavEmulator::Message& message : dvl.send(now_s)) ASSERT_TRUE(line->write(message));
    for (int i = 0; i < 2000 && receiver->status().reports < 2 * round; ++i) {
      for (const NavSource& said : read_some(*receiver, now_s)) {
        samples += said.samples.size();
        for (const NavSample& sample : said.samples) poses.add(said.name, said.quantity, sample);
      }
    }
    ASSERT_EQ(receiver->status().reports, 2 * round);
    EXPECT_EQ(receiver->status().connections, round);
    line = Link::listen("tcp://127.0.0.1:0");  // the DVL is gone
    for (int i = 0; i < 2000 && receiver->status().is_connected; ++i) receiver->read(now_s);
    EXPECT_FALSE(receiver->status().is_connected);
    line = Link::listen(address);
    ASSERT_TRUE(line) << line.error().message;
    now_s += 1.0;
  }
  EXPECT_EQ(receiver->status().damaged, 0U);
  const auto pose = poses.at(50.0);
  ASSERT_TRUE(pose);
  expect_near(*pose, pose_at(50.0), 1e-3);

  const Result<FileBytes> bytes = read_file(path);
  ASSERT_TRUE(bytes);
  const auto recorded = read_nav(*bytes);
  ASSERT_TRUE(recorded) << recorded.error().message;
  EXPECT_EQ(recorded->log.clock(), NavClock::kUnix);
  EXPECT_EQ(recorded->records, 2 * kRounds);
  EXPECT_TRUE(recorded->damage.empty());
  const NavSource* const positions = recorded->log.best(NavQuantity::kPosition);
  ASSERT_TRUE(positions);
  EXPECT_NEAR(positions->samples.at(50).time_s, kStart_s + 50.0, 1e-3);
  EXPECT_EQ(samples, 4 * kRounds) << "velocity, range, position, attitude";
}

// A DVL that is unplugged closes nothing.
TEST(A50Receiver, GivesUpALineThatIsSilentAndOneThatIsNotThere) {
  Result<Link> line = Link::listen("tcp://127.0.0.1:0");
  ASSERT_TRUE(line);
  const std::string address = line->address();
  Result<A50Receiver> receiver = A50Receiver::make(address, std::nullopt, 0.0);
  ASSERT_TRUE(receiver);
  let_in(*line, *receiver, 0.0);
  ASSERT_TRUE(line->write(std::vector<std::uint8_t>{'{', '}', '\n', '{', '"'}));
  for (int i = 0; i < 2000 && receiver->status().reports == 0; ++i) {
    receiver->read(0.0);
    ::usleep(1000);
  }
  EXPECT_TRUE(receiver->status().is_connected);
  receiver->read(4.9);
  EXPECT_TRUE(receiver->status().is_connected);
  receiver->read(5.1);
  EXPECT_FALSE(receiver->status().is_connected);
  EXPECT_THAT(receiver->status().problem, HasSubstr("silent"));
  EXPECT_EQ(receiver->status().damaged, 1U) << "the line that never ended";
  line = Link::listen("tcp://127.0.0.1:0");
  for (int i = 0; i < 2000 && receiver->status().problem.find("refused") == std::string::npos; ++i) {
    receiver->read(6.0 + i);
  }
  EXPECT_THAT(receiver->status().problem, HasSubstr("Connection refused"));
  EXPECT_FALSE(A50Receiver::make("udp://127.0.0.1:1", std::nullopt, 0.0));
}

// Without it, what was recorded of a dive could be lost with the power for as long as the system keeps it in memory.
TEST(Recording, OfEachDeviceIsFlushedToTheDiskOnceASecond) {
  const test::Folder folder;
  const int folder_syncs_before = folder_syncs;
  Result<TlogRecorder> tlog = TlogRecorder::create(folder.path("dive.tlog"));
  ASSERT_TRUE(tlog);
  Result<MavlinkReceiver> autopilot = MavlinkReceiver::listen("udp://127.0.0.1:0", *std::move(tlog), 0.0);
  ASSERT_TRUE(autopilot);
  Result<RecordFile> lines = RecordFile::create(folder.path("dive.jsonl"));
  ASSERT_TRUE(lines);
  Result<A50Receiver> dvl = A50Receiver::make("tcp://127.0.0.1:1", *std::move(lines), 0.0);
  ASSERT_TRUE(dvl);
  Result<PingViewerRecorder> log = PingViewerRecorder::create(folder.path("dive.bin"));
  ASSERT_TRUE(log);
  const std::unique_ptr<LiveSource> head = ping360_source("udp://127.0.0.1:1", {}, *std::move(log), 0.0);
  // After a power cut in the first seconds there was no file.
  EXPECT_EQ(folder_syncs - folder_syncs_before, 3);
  const auto syncs_of = [](const auto& read) {
    const int before = syncs;
    for (double now_s = 0.0; now_s < 9.75; now_s += 0.25) read(now_s);
    return syncs - before;
  };
  EXPECT_EQ(syncs_of([&](double now_s) { EXPECT_TRUE(autopilot->read(now_s)); }), 10);
  EXPECT_EQ(syncs_of([&](double now_s) { dvl->read(now_s); }), 10);
  std::vector<Beam> beams;
  EXPECT_EQ(syncs_of([&](double now_s) {
              EXPECT_TRUE(head->step(now_s, beams));
              EXPECT_LE(head->due_s(), now_s + 1.0);
            }),
            10);
  // Kills a recording that is lost without a word.
  EXPECT_FALSE(autopilot->status().recording_error);
  std::filesystem::remove_all(folder.path());
  EXPECT_TRUE(autopilot->read(20.0));
  ASSERT_TRUE(autopilot->status().recording_error);
  EXPECT_THAT(autopilot->status().recording_error->message, HasSubstr("dive.tlog: was removed"));
  dvl->read(20.0);
  EXPECT_TRUE(dvl->status().recording_error);
  EXPECT_TRUE(head->step(20.0, beams));
  EXPECT_TRUE(head->status().recording_error);
}

}  // namespace
}  // namespace pingvox
