#include <fmt/core.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

#include "commands.hpp"
#include "device/internal/link.hpp"
#include "device/internal/micron_emulator.hpp"
#include "device/internal/ping360_emulator.hpp"
#include "option_values.hpp"
#include "pingvox/sonar/device_profile.hpp"
#include "stop_signals.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

Scene scene_of(const std::string& world) {
  if (world == "harbour") return harbour_scene({});
  if (world == "seabed") return seabed_scene({});
  if (world == "cave") return cave_scene({});
  return tank_scene({});
}

/// Where the vehicle is at a time of the system's clock: emulators of one world that run side by side agree.
class Vehicle {
 public:
  Vehicle(const Scene& scene, const EmulateCommand& command) : way_(Trajectory::still(Pose::Identity())) {
    const Route* const route = scene.route(command.motion);
    if (route == nullptr) return;
    lap_s_ = length_m(*route) / command.speed_m_s;
    way_ = follow_route(*route, lap_s_, {.speed_m_s = command.speed_m_s});
  }

  Pose at(double since_1970_s) const {
    const double time_s = std::fmod(since_1970_s, lap_s_);
    return way_.at(std::clamp(time_s, way_.poses().front().time_s, way_.poses().back().time_s))
        .value_or(way_.poses().back().map_from_body);
  }

 private:
  Trajectory way_;
  double lap_s_ = 1.0;
};

/// map_from_body, by seconds since the start of this program.
using PoseAt = NavEmulator::PoseAt;

PoseAt pose_from_now(const Scene& scene, const EmulateCommand& command) {
  const double since_1970_s =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  return [vehicle = Vehicle(scene, command), since_1970_s](double now_s) { return vehicle.at(since_1970_s + now_s); };
}

/// Intensities that a head hears at a bearing: of the simulator's first beam of a turn, with the head mounted so that
/// it looks there.
using Hear = std::function<std::vector<std::uint8_t>(double bearing_rad, std::size_t bins, double bin_length_m)>;

Hear hear_in(Scene scene, PoseAt pose_at, const Stopwatch& watch, std::uint64_t seed, const DeviceProfile& device) {
  return [scene = std::move(scene), pose_at = std::move(pose_at), &watch, seed, &device](
             double bearing_rad, std::size_t bins, double bin_length_m) mutable {
    SonarOptions sonar;
    sonar.seed = seed++;  // new noise for each ping
    sonar.bins = bins;
    sonar.bin_length_m = bin_length_m;
    sonar.beam_width_rad = device.beam_width_rad;
    sonar.beam_height_rad = device.beam_height_rad;
    sonar.body_from_sensor = pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, bearing_rad);
    SonarSimulator simulator(scene.world, Trajectory::still(pose_at(watch.seconds())), sonar, 1);
    const Result<std::optional<Beam>> beam = simulator.next();
    return beam && *beam ? (*beam)->intensities : std::vector<std::uint8_t>(bins);
  };
}

/// Waits until bytes or a signal come, at most until a time [s].
void wait(const StopSignals& signals, const Link& link, double seconds) {
  constexpr double kMaxWait_s = 1.0;
  std::array<pollfd, 2> files = {pollfd{signals.descriptor(), POLLIN, 0}, pollfd{link.descriptor(), POLLIN, 0}};
  ::poll(files.data(), files.size(), static_cast<int>(std::ceil(std::clamp(seconds, 0.0, kMaxWait_s) * 1000.0)));
}

/// @param turn  angles of a turn, clockwise; half of them is ahead
template <class Head>
Result<int> emulate_head(const EmulateCommand& command, const char* device, int turn, StopSignals& signals,
                         Link& link) {
  const Stopwatch watch;
  Scene scene = scene_of(command.world);
  PoseAt pose_at = pose_from_now(scene, command);
  Hear hear = hear_in(std::move(scene), std::move(pose_at), watch, command.head.seed, *find_device(device));
  Head head(command.head, [&](int angle, std::size_t bins, double bin_length_m) {
    return hear((0.5 * turn - angle) * (2.0 * std::numbers::pi / turn), bins, bin_length_m);
  });
  std::array<std::uint8_t, 65536> bytes;
  while (!signals.has_arrived() && (command.max_pings == 0 || head.pings() < command.max_pings)) {
    wait(signals, link, head.due_s() - watch.seconds());
    const Result<std::size_t> got = link.read(bytes);
    if (!got) return tl::unexpected(got.error());
    head.take(std::span(bytes).first(*got), watch.seconds());
    if (const auto sent = link.write(head.send(watch.seconds())); !sent) return tl::unexpected(sent.error());
  }
  return 0;
}

Result<int> emulate_navigation(const EmulateCommand& command, StopSignals& signals, Link& link) {
  const Stopwatch watch;
  PoseAt pose_at = pose_from_now(scene_of(command.world), command);
  const bool is_dvl = command.device == EmulateCommand::Device::kA50;
  const auto has_bottom = [no_bottom_s = command.no_bottom_s](double now_s) {
    constexpr double kMinute_s = 60.0;
    return std::fmod(now_s, kMinute_s) < kMinute_s - no_bottom_s;
  };
  NavEmulator device(command.nav, is_dvl ? NavEmulator::a50(std::move(pose_at), has_bottom)
                                         : NavEmulator::mavlink(std::move(pose_at)));
  std::array<std::uint8_t, 65536> bytes;
  while (!signals.has_arrived()) {
    wait(signals, link, device.due_s() - watch.seconds());
    // A vehicle sends whether or not anybody listens, and ignores messages from hosts.
    static_cast<void>(link.read(bytes));
    for (const NavEmulator::Message& message : device.send(watch.seconds())) static_cast<void>(link.write(message));
  }
  return 0;
}

}  // namespace

Result<int> run(const EmulateCommand& command, Console& console) {
  Result<StopSignals> signals = StopSignals::make();
  if (!signals) return tl::unexpected(signals.error());
  const bool sends = command.device == EmulateCommand::Device::kMavlink;
  Result<Link> link = sends ? Link::open(command.line) : Link::listen(command.line);
  if (!link) return fail(link.error().code, fmt::format("{}: {}", sends ? "--to" : "--listen", link.error().message));
  if (const auto printed = console.print(link->address() + "\n"); !printed) return tl::unexpected(printed.error());
  switch (command.device) {
    case EmulateCommand::Device::kPing360:
      return emulate_head<Ping360Emulator>(command, "ping360", 400, *signals, *link);
    case EmulateCommand::Device::kMicron:
      return emulate_head<MicronEmulator>(command, "micron", 6400, *signals, *link);
    default:
      return emulate_navigation(command, *signals, *link);
  }
}

}  // namespace pingvox::app
