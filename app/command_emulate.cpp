#include <fmt/core.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "commands.hpp"
#include "option_values.hpp"
#include "pingvox/device/link.hpp"
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

/// Beams of the simulator, one at a time: its first one of a turn, with the head mounted so that it looks there.
Ping360Emulator::Hear hear_in(Scene scene, std::uint64_t seed) {
  return [scene = std::move(scene), seed](int angle_grad, std::size_t bins, double bin_length_m) mutable {
    constexpr double kAhead_grad = 200.0, kGradian_rad = std::numbers::pi / 200.0;
    SonarOptions sonar;
    sonar.seed = seed++;  // new noise for each ping
    sonar.bins = bins;
    sonar.bin_length_m = bin_length_m;
    sonar.beam_width_rad = 2.0 * kDegree_rad;
    sonar.beam_height_rad = 25.0 * kDegree_rad;
    sonar.body_from_sensor =
        pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, (kAhead_grad - angle_grad) * kGradian_rad);
    SonarSimulator simulator(scene.world, Trajectory::still(Pose::Identity()), sonar, 1);
    const Result<std::optional<Beam>> beam = simulator.next();
    return beam && *beam ? (*beam)->intensities : std::vector<std::uint8_t>(bins);
  };
}

}  // namespace

Result<int> run(const EmulateCommand& command, Console& console) {
  Result<StopSignals> signals = StopSignals::make();
  if (!signals) return tl::unexpected(signals.error());
  Result<Link> link = Link::listen(command.listen);
  if (!link) return tl::unexpected(link.error());
  if (const auto printed = console.print(link->address() + "\n"); !printed) return tl::unexpected(printed.error());

  Ping360Emulator head(command.head, hear_in(scene_of(command.world), command.head.seed));
  const Stopwatch watch;
  std::array<std::uint8_t, 65536> bytes;
  while (!signals->arrived() && (command.max_pings == 0 || head.pings() < command.max_pings)) {
    constexpr double kMaxWait_s = 1.0;
    const double wait_s = std::clamp(head.due_s() - watch.seconds(), 0.0, kMaxWait_s);
    std::array<pollfd, 2> files = {pollfd{signals->descriptor(), POLLIN, 0}, pollfd{link->descriptor(), POLLIN, 0}};
    ::poll(files.data(), files.size(), static_cast<int>(std::ceil(wait_s * 1000.0)));
    const Result<std::size_t> got = link->read(bytes);
    if (!got) return tl::unexpected(got.error());
    head.take(std::span(bytes).first(*got), watch.seconds());
    if (const auto sent = link->write(head.send(watch.seconds())); !sent) return tl::unexpected(sent.error());
  }
  return 0;
}

}  // namespace pingvox::app
