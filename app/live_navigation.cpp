#include "live_navigation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

namespace pingvox::app {

Result<NavDevice> NavDevice::open(const LiveNavigation& from, std::optional<std::filesystem::path> record,
                                  Recordings& recordings, double since_1970_s) {
  if (from.kind == LiveNavigation::Kind::kA50) {
    if (record) *record += ".jsonl";
    Result<std::optional<RecordFile>> recorder = recordings.create<RecordFile>(record);
    if (!recorder) return tl::unexpected(recorder.error());
    return A50Receiver::make(from.address, *std::move(recorder), since_1970_s).map([](A50Receiver receiver) {
      return NavDevice(std::move(receiver));
    });
  }
  if (record) *record += ".tlog";
  Result<std::optional<TlogRecorder>> recorder = recordings.create<TlogRecorder>(record);
  if (!recorder) return tl::unexpected(recorder.error());
  return MavlinkReceiver::listen(from.address, *std::move(recorder), since_1970_s).map([](MavlinkReceiver receiver) {
    return NavDevice(std::move(receiver));
  });
}

std::string NavDevice::name() const {
  return (listens() ? "mavlink:" : "a50:") +
         std::visit([](const auto& receiver) { return receiver.address(); }, receiver_);
}

int NavDevice::descriptor() const {
  return std::visit([](const auto& receiver) { return receiver.descriptor(); }, receiver_);
}

NavDevice::Status NavDevice::status() const {
  Status status;
  if (const auto* const dvl = std::get_if<A50Receiver>(&receiver_)) {
    const A50Receiver::Status& said = dvl->status();
    status.messages = said.reports;
    status.damaged = said.damaged;
    status.is_connected = said.is_connected;
    status.connections = said.connections;
    status.problem = said.problem;
    status.recording_error = said.recording_error;
  } else {
    const MavlinkReceiver::Status& said = std::get<MavlinkReceiver>(receiver_).status();
    status.messages = said.frames;
    status.damaged = said.damaged;
    status.vehicle = said.vehicle;
    status.vehicles = said.vehicles;
    status.ignored = said.ignored;
    status.others = said.others;
    status.recording_error = said.recording_error;
  }
  return status;
}

Result<void> NavDevice::read(double now_s, LivePoses& poses) {
  if (auto* const dvl = std::get_if<A50Receiver>(&receiver_)) {
    for (const NavSource& said : dvl->read(now_s)) {
      for (const NavSample& sample : said.samples) poses.add(said.name, said.quantity, sample);
    }
    return {};
  }
  const auto reports = std::get<MavlinkReceiver>(receiver_).read(now_s);
  if (!reports) return tl::unexpected(reports.error());
  for (const MavlinkNav::Report& report : *reports) {
    note_start(report);
    poses.add(report.source, report.quantity, report.sample);
  }
  return {};
}

void NavDevice::note_start(const MavlinkNav::Report& report) {
  if (report.quantity != NavQuantity::kPosition || !report.sample.valid || !report.made) return;
  const DeviceTime& now = report.made->time;
  Positions& positions = positions_.try_emplace(report.source, Positions{now}).first->second;
  positions.has_other_origin = positions.has_other_origin || was_started_anew(positions.last, now);
  positions.last = now;
}

bool NavDevice::has_other_origin(const std::string& position) const {
  const auto positions = positions_.find(position);
  return positions != positions_.end() && positions->second.has_other_origin;
}

Result<Navigation> Navigation::open(const std::vector<LiveNavigation>& from, Recordings& recordings, double start_s,
                                    double since_1970_s) {
  std::vector<NavDevice> devices;
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::optional<std::filesystem::path> name = recordings.sonar();
    if (name) name->replace_extension();
    const auto before = std::span(from).first(i);
    const auto of_kind = std::ranges::count(before, from[i].kind, &LiveNavigation::kind);
    if (name && of_kind > 0) *name += fmt::format("-{}", of_kind + 1);
    Result<NavDevice> device = NavDevice::open(from[i], std::move(name), recordings, since_1970_s);
    if (!device) return tl::unexpected(device.error());
    devices.push_back(*std::move(device));
  }
  return Navigation(std::move(devices), start_s);
}

std::string Navigation::names() const {
  std::string names;
  for (const NavDevice& device : devices_) names += (names.empty() ? "" : ", ") + device.name();
  return names;
}

std::size_t Navigation::messages() const {
  std::size_t sum = 0;
  for (const NavDevice& device : devices_) sum += device.status().messages;
  return sum;
}

std::size_t Navigation::damaged() const {
  std::size_t sum = 0;
  for (const NavDevice& device : devices_) sum += device.status().damaged;
  return sum;
}

Result<void> Navigation::step(double now_s) {
  now_s_ = now_s - start_s_;
  Result<void> all;
  for (NavDevice& device : devices_) {
    if (auto read = device.read(now_s_, poses_); !read && all) all = std::move(read);
  }
  return all;
}

bool Navigation::may_come(double beam_s) const {
  constexpr double kPatience_s = 1.0;
  const std::optional<double> until_s = poses_.known_until_s();
  return now_s_ < beam_s + kPatience_s && !(until_s && *until_s >= beam_s);
}

}  // namespace pingvox::app
