#include "live/live_navigation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <span>

namespace pingvox {

namespace {

/// Files of devices are named as the sonar's, without a suffix; later ones of a kind by their number.
std::optional<std::filesystem::path> name_of_recording(const Recordings& recordings, std::size_t of_kind) {
  std::optional<std::filesystem::path> name = recordings.sonar();
  if (name) name->replace_extension();
  if (name && of_kind > 0) *name += fmt::format("-{}", of_kind + 1);
  return name;
}

}  // namespace

Result<LiveNavigation> LiveNavigation::open(const std::vector<LiveNav>& from, Recordings& recordings,
                                            double since_1970_s, const std::optional<Ros2Node>& node) {
  std::vector<NavDevice> devices;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto of_kind = std::ranges::count(std::span(from).first(i), from[i].kind, &LiveNav::kind);
    Result<NavDevice> device = NavDevice::open(
        from[i], name_of_recording(recordings, static_cast<std::size_t>(of_kind)), recordings, since_1970_s, node);
    if (!device) return tl::unexpected(device.error());
    devices.push_back(*std::move(device));
  }
  return LiveNavigation(std::move(devices));
}

Result<void> LiveNavigation::record(Recordings& recordings) {
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    const auto of_kind = std::ranges::count(std::span(devices_).first(i), devices_[i].kind(), &NavDevice::kind);
    const Result<void> recorded =
        devices_[i].record(name_of_recording(recordings, static_cast<std::size_t>(of_kind)), recordings);
    if (!recorded) return recorded;
  }
  return {};
}

std::size_t LiveNavigation::messages() const {
  std::size_t sum = 0;
  for (const NavDevice& device : devices_) sum += device.status().messages;
  return sum;
}

Result<void> LiveNavigation::step(double now_s) {
  const std::optional<double> until_s = poses_.known_until_s();
  Result<void> all =
      read(now_s, [this](std::size_t device, const std::string& source, NavQuantity quantity, const NavSample& sample) {
        poses_.add(source, quantity, sample);
        if (source == poses_.attitude() || source == poses_.position()) note_sample(device, sample);
      });
  if (poses_.known_until_s() != until_s) pose_came_s_ = now_s;
  return all;
}

Result<void> LiveNavigation::step(double now_s, const Take& take) {
  return read(now_s, [&](std::size_t device, const std::string& source, NavQuantity quantity, const NavSample& sample) {
    take(device, source, quantity, sample);
    note_sample(device, sample);
  });
}

Result<void> LiveNavigation::read(double now_s, const Take& take) {
  now_s_ = now_s;
  Result<void> all;
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    auto read = devices_[i].read(now_s_, [&](const std::string& source, NavQuantity quantity, const NavSample& sample) {
      take(i, source, quantity, sample);
    });
    if (!read && all) all = std::move(read);
  }
  return all;
}

/// Only messages of ROS 2 have stamps of another clock: the others are stamped here on arrival.
void LiveNavigation::note_sample(std::size_t device, const NavSample& sample) {
  const bool has_stamps = devices_[device].kind() == LiveNav::Kind::kRos2;
  clocks_.add_sample(device, has_stamps ? now_s_ - sample.time_s : 0.0);
}

bool LiveNavigation::may_come(double beam_s, double arrived_s) const {
  const std::optional<double> until_s = poses_.known_until_s();
  return now_s_ < arrived_s + kPatience_s && !(until_s && *until_s >= beam_s);
}

double LiveNavigation::pose_age_s() const {
  const std::optional<double> until_s = poses_.known_until_s();
  return until_s ? now_s_ - *until_s : std::numeric_limits<double>::infinity();
}

}  // namespace pingvox
