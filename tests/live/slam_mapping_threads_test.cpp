// `pingvox live --slam` against emulated devices in a simulated harbour, in virtual time.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "device/internal/link.hpp"
#include "device/internal/nav_emulator.hpp"
#include "device/internal/ping360_emulator.hpp"
#include "device/recording.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sim/sonar.hpp"

namespace pingvox::test {
namespace {

/// A vehicle that goes round the harbour with a head, a DVL and an autopilot.
class HarbourRun {
 public:
  /// @param options  of the head, the map, SLAM and navigation are filled in
  explicit HarbourRun(LiveOptions options, NavEmulator::HasBottom has_bottom = nullptr)
      : scene_(harbour_scene({})),
        way_(follow_route(scene_.loop, 200.0, {.speed_m_s = 0.4})),
        dvl_({.reports_per_s = 10.0},
             NavEmulator::a50([this](double now_s) { return pose_at(now_s); }, std::move(has_bottom))) {
    options.head.address = head_line_->address();
    options.head.ping360 = {.range_m = 8.0, .step_grad = 10, .timeout_s = 1.0};
    options.map.resolution_m = 0.2;
    options.slam.emplace();
    options.obstacles = pilot_->address();
    options.nav = {{.kind = LiveNav::Kind::kA50, .address = dvl_line_->address()},
                   {.kind = LiveNav::Kind::kMavlink, .address = "udp://127.0.0.1:0"}};
    Result<LiveMapping> live = LiveMapping::open(options, [this] { return now_s_; });
    if (!live) {
      ADD_FAILURE() << live.error().message;
      return;
    }
    live_.emplace(*std::move(live));
    constexpr std::string_view kMavlink = "mavlink:";
    autopilot_line_.emplace(Link::open(live_->status().nav.back().name.substr(kMavlink.size())));
  }
  HarbourRun(const HarbourRun&) = delete;
  HarbourRun& operator=(const HarbourRun&) = delete;

  LiveMapping& live() { return *live_; }
  const std::vector<LiveEvent>& events() const { return events_; }
  static constexpr double kStart_s = 100.0;
  Pose pose_at(double now_s) const {
    const std::vector<StampedPose>& poses = way_.poses();
    return *way_.at(std::clamp(now_s - kStart_s, poses.front().time_s, poses.back().time_s));
  }

  /// By the first pose of a path.
  Pose map_from_truth(const Trajectory& path) const {
    const StampedPose& first = path.poses().front();
    return first.map_from_body * pose_at(kStart_s + first.time_s).inverse();
  }

  void run_for(double seconds) {
    for (const double end_s = now_s_ + seconds; now_s_ < end_s;) {
      const Result<bool> goes_on = live_->step();
      ASSERT_TRUE(goes_on && *goes_on);
      const LiveStatus status = live_->status();
      ASSERT_EQ(status.mapped + status.not_mapped + status.waiting, status.beams);
      for (LiveEvent& event : live_->take_events()) events_.push_back(std::move(event));
      say(dvl_, *dvl_line_);
      say(autopilot_, **autopilot_line_);
      if (!turn_head()) pass_time();
    }
  }

  /// Messages about obstacles that came so far.
  std::size_t obstacles_told() {
    std::array<std::uint8_t, 300> bytes = {};
    std::size_t messages = 0;
    while (pilot_->read(bytes).value_or(0) > 0) ++messages;
    return messages;
  }

 private:
  std::vector<std::uint8_t> hear(int angle_grad, std::size_t bins, double bin_length_m) {
    SonarOptions sonar;
    sonar.seed = ++pings_;
    sonar.bins = bins;
    sonar.bin_length_m = bin_length_m;
    const double bearing_rad = (200 - angle_grad) * (std::numbers::pi / 200.0);
    sonar.body_from_sensor = pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, bearing_rad);
    SonarSimulator simulator(scene_.world, Trajectory::still(pose_at(now_s_)), sonar, 1);
    return (*simulator.next())->intensities;
  }

  void say(NavEmulator& device, Link& line) {
    std::array<std::uint8_t, 4096> ignored = {};
    static_cast<void>(line.read(ignored));
    if (now_s_ < device.due_s()) return;
    for (const NavEmulator::Message& message : device.send(now_s_)) static_cast<void>(line.write(message));
  }

  bool turn_head() {
    std::array<std::uint8_t, 65536> bytes = {};
    const Result<std::size_t> got = head_line_->read(bytes);
    head_.take(std::span(bytes).first(got.value_or(0)), now_s_);
    const std::vector<std::uint8_t> sent = head_.send(now_s_);
    EXPECT_TRUE(head_line_->write(sent));
    return got.value_or(0) > 0 || !sent.empty();
  }

  void pass_time() {
    constexpr double kTurn_s = 0.01;
    pollfd file = {head_line_->descriptor(), POLLIN, 0};
    if (::poll(&file, 1, 1) == 0) now_s_ += kTurn_s;
  }

  double now_s_ = kStart_s;
  Scene scene_;
  Trajectory way_;
  std::uint64_t pings_ = 0;
  Result<Link> head_line_ = Link::listen("udp://127.0.0.1:0");
  Result<Link> dvl_line_ = Link::listen("tcp://127.0.0.1:0");
  Result<Link> pilot_ = Link::listen("udp://127.0.0.1:0");
  std::optional<Result<Link>> autopilot_line_;
  Ping360Emulator head_{{.pings_per_s = 20.0}, [this](int angle_grad, std::size_t bins, double bin_length_m) {
                          return hear(angle_grad, bins, bin_length_m);
                        }};
  NavEmulator dvl_;
  NavEmulator autopilot_{{.reports_per_s = 20.0},
                         NavEmulator::mavlink([this](double now_s) { return pose_at(now_s); })};
  std::optional<LiveMapping> live_;
  std::vector<LiveEvent> events_;
};

/// What `slam --causal` says of the files.
Result<RecordingSlam> slam_of(const std::vector<std::filesystem::path>& files) {
  RecordingOptions options;
  std::vector<InputFile> logs;
  for (const std::filesystem::path& file : files) {
    (file.extension() == ".bin" ? logs : options.nav).emplace_back(file.string());
  }
  const Result<Recording> recording = Recording::open(std::move(logs), std::move(options));
  if (!recording) return tl::unexpected(recording.error());
  return slam(*recording, {}, Estimation::kCausal);
}

/// A recording has its times in whole milliseconds, and delays of messages that are known from all of it: pairs of
/// echoes differ, too. Its path begins where the positions of the navigation are.
void expect_near(const Trajectory& told, const Trajectory& replayed, double since_1970_s) {
  const auto &a = told.poses(), &b = replayed.poses();
  ASSERT_EQ(a.size(), b.size());
  const Eigen::Vector3d moved = b.front().map_from_body.translation() - a.front().map_from_body.translation();
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i].time_s, b[i].time_s - since_1970_s, 0.0011) << i;
    const Eigen::Vector3d apart = b[i].map_from_body.translation() - a[i].map_from_body.translation() - moved;
    ASSERT_LT(apart.norm(), 0.01) << i;
    const Eigen::AngleAxisd turned(a[i].map_from_body.linear().transpose() * b[i].map_from_body.linear());
    ASSERT_LT(turned.angle(), 0.005) << i;
  }
}

template <class Event>
std::vector<Event> kind_of_events(const std::vector<LiveEvent>& events) {
  std::vector<Event> found;
  for (const LiveEvent& event : events) {
    if (const auto* const one = std::get_if<Event>(&event)) found.push_back(*one);
  }
  return found;
}

void expect_near_truth(const Trajectory& path, const Pose& map_from_truth, const HarbourRun& run, double limit_m) {
  for (const StampedPose& pose : path.poses()) {
    const Pose there = map_from_truth * run.pose_at(HarbourRun::kStart_s + pose.time_s);
    ASSERT_LT((there.translation() - pose.map_from_body.translation()).head<2>().norm(), limit_m) << pose.time_s;
  }
}

TEST(SlamMapping, TellsWhatSlamSaysOfItsRecordings) {
  const Folder folder;
  LiveOptions options;
  options.record = folder.path("dive.bin");
  HarbourRun run(options);
  run.run_for(60.0);
  EXPECT_GE(run.obstacles_told(), 50U);
  const LiveStatus before = run.live().status();
  ASSERT_TRUE(before.slam);
  EXPECT_GT(before.mapped, before.beams / 2);
  EXPECT_TRUE(before.attitude.empty()) << "poses are by SLAM";
  const auto finished = run.live().finish();
  ASSERT_TRUE(finished) << finished.error().message;
  const auto chosen = kind_of_events<live_event::MotionChosen>(run.events());
  ASSERT_EQ(chosen.size(), 1U);
  EXPECT_EQ(chosen.front().motion, LiveMotion::kVelocity);
  EXPECT_EQ(chosen.front().velocity, "A50");
  EXPECT_TRUE(kind_of_events<live_event::NoSourceYet>(run.events()).empty());
  EXPECT_TRUE(kind_of_events<live_event::SourcesChosen>(run.events()).empty());
  ASSERT_NE(run.live().slam_solution(), nullptr);
  const auto replayed = slam_of(run.live().recordings());
  ASSERT_TRUE(replayed) << replayed.error().message;
  expect_near(run.live().slam_solution()->trajectory, replayed->solution.trajectory, run.live().since_1970_s());

  const LiveStatus status = run.live().status();
  EXPECT_EQ(status.waiting, 0U);
  EXPECT_GT(status.mapped, status.beams * 9 / 10);
  const std::optional<Trajectory> path = run.live().path();
  ASSERT_TRUE(path);
  expect_near_truth(*path, run.map_from_truth(*path), run, 0.3);
}

// Kills poses that stop without a velocity.
TEST(SlamMapping, GoesOnWhereTheDvlHasNoBottom) {
  constexpr double kFrom_s = HarbourRun::kStart_s + 24.0, kTo_s = kFrom_s + 9.0;
  HarbourRun run({}, [](double now_s) { return now_s < kFrom_s || now_s >= kTo_s; });
  run.run_for(24.0);
  EXPECT_LT(run.live().status().slam->without_velocity_s, 1.0);
  static_cast<void>(run.obstacles_told());
  double deviation_m = 0.0;
  for (int n = 0; n < 17; ++n) {
    run.run_for(0.5);
    deviation_m = std::max(deviation_m, run.live().status().slam->deviation_m);
  }
  EXPECT_GT(run.live().status().slam->without_velocity_s, 6.0);
  EXPECT_GT(deviation_m, 0.5) << "grows";
  EXPECT_GE(run.obstacles_told(), 30U) << "around where it is taken to be";
  run.run_for(15.0);
  EXPECT_LT(run.live().status().slam->without_velocity_s, 1.0);
  ASSERT_TRUE(run.live().finish());
  EXPECT_EQ(kind_of_events<live_event::VelocityEnded>(run.events()).size(), 1U);
  EXPECT_EQ(kind_of_events<live_event::VelocityResumed>(run.events()).size(), 1U);
  const std::optional<Trajectory> path = run.live().path();
  ASSERT_TRUE(path);
  expect_near_truth(*path, run.map_from_truth(*path), run, 0.4);
}

// That the vehicle is located in it is tested with LiveSlam.
TEST(SlamMapping, BeginsWithTheMapOfAnEarlierDive) {
  const Folder folder;
  HarbourRun first({});
  first.run_for(14.0);
  ASSERT_TRUE(first.live().finish());
  LiveOptions options;
  options.known_map = LiveKnownMap{folder.path("harbour.ot")};
  ASSERT_TRUE(write_map(first.live().map(), options.known_map->file));
  HarbourRun second(options);
  second.run_for(1.0);
  const MapCounts counts = second.live().map().counts();
  EXPECT_GT(counts.occupied_cells, 0U);
  EXPECT_EQ(counts.occupied_cells, first.live().map().counts().occupied_cells);
  EXPECT_EQ(counts.free_cells, first.live().map().counts().free_cells);
  EXPECT_FALSE(second.live().status().slam->located);
}

TEST(SlamMapping, AKnownMapNeedsSlamAndAFile) {
  LiveOptions options;
  options.head.address = "udp://127.0.0.1:1";
  options.known_map = LiveKnownMap{"", StartPose{.deviation_m = -1.0}};
  const Result<void> valid = options.validate();
  ASSERT_FALSE(valid);
  for (const char* word : {"only with slam", "a file", "deviation_m"}) {
    EXPECT_NE(valid.error().message.find(word), std::string::npos) << valid.error().message;
  }
  options.slam.emplace();
  options.known_map = LiveKnownMap{"/nowhere/harbour.ot"};
  EXPECT_TRUE(options.validate());
  const Result<LiveMapping> live = LiveMapping::open(options);
  ASSERT_FALSE(live);
  EXPECT_EQ(live.error().code, Error::Code::kIo);
}

}  // namespace
}  // namespace pingvox::test
