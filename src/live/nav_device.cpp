#include "live/nav_device.hpp"

#include <string_view>
#include <vector>

namespace pingvox {
namespace {

LiveNavStatus status_of(const A50Receiver& dvl) {
  const A50Receiver::Status& said = dvl.status();
  LiveNavStatus status;
  status.kind = LiveNav::Kind::kA50;
  status.messages = said.reports;
  status.damaged = said.damaged;
  status.is_connected = said.is_connected;
  status.connections = said.connections;
  status.problem = said.problem;
  status.recording_error = said.recording_error;
  return status;
}

LiveNavStatus status_of(const MavlinkReceiver& autopilot) {
  const MavlinkReceiver::Status& said = autopilot.status();
  LiveNavStatus status;
  status.kind = LiveNav::Kind::kMavlink;
  status.messages = said.frames;
  status.damaged = said.damaged;
  status.vehicle = said.vehicle;
  status.vehicles = said.vehicles;
  status.ignored = said.ignored;
  status.others = said.others;
  status.recording_error = said.recording_error;
  return status;
}

LiveNavStatus status_of(const Ros2NavReceiver& topic) {
  const Ros2NavReceiver::Status& said = topic.status();
  LiveNavStatus status;
  status.kind = LiveNav::Kind::kRos2;
  status.messages = said.messages;
  status.damaged = said.damaged;
  status.refused = said.refused;
  status.no_attitude = said.no_attitude;
  status.publishers = said.publishers;
  status.is_connected = said.is_connected;
  status.connections = said.connections;
  status.problem = said.problem;
  return status;
}

constexpr std::string_view kA50Suffix = ".jsonl", kMavlinkSuffix = ".tlog";

/// @param record  name without its suffix; nullopt: nothing is recorded
template <class Recorder>
Result<std::optional<Recorder>> create_recorder(std::optional<std::filesystem::path> record, std::string_view suffix,
                                                Recordings& recordings) {
  if (record) *record += suffix;
  return recordings.create<Recorder>(record);
}

}  // namespace

Result<NavDevice> NavDevice::open(const LiveNav& from, std::optional<std::filesystem::path> record,
                                  Recordings& recordings, double since_1970_s, const std::optional<Ros2Node>& node) {
  if (from.kind == LiveNav::Kind::kA50) {
    Result<std::optional<RecordFile>> recorder = create_recorder<RecordFile>(std::move(record), kA50Suffix, recordings);
    if (!recorder) return tl::unexpected(recorder.error());
    return A50Receiver::make(from.address, *std::move(recorder), since_1970_s).map([](A50Receiver receiver) {
      return NavDevice(std::move(receiver));
    });
  }
  if (from.kind == LiveNav::Kind::kRos2 && node) {
    return Ros2NavReceiver::make(*node, from.address, since_1970_s).map([](Ros2NavReceiver receiver) {
      return NavDevice(std::move(receiver));
    });
  }
  Result<std::optional<TlogRecorder>> recorder =
      create_recorder<TlogRecorder>(std::move(record), kMavlinkSuffix, recordings);
  if (!recorder) return tl::unexpected(recorder.error());
  return MavlinkReceiver::listen(from.address, *std::move(recorder), since_1970_s).map([](MavlinkReceiver receiver) {
    return NavDevice(std::move(receiver));
  });
}

Result<void> NavDevice::record(std::optional<std::filesystem::path> record, Recordings& recordings) {
  if (auto* const dvl = std::get_if<A50Receiver>(&receiver_)) {
    return create_recorder<RecordFile>(std::move(record), kA50Suffix, recordings)
        .map([&](std::optional<RecordFile> recorder) { dvl->record_to(std::move(recorder)); });
  }
  auto* const autopilot = std::get_if<MavlinkReceiver>(&receiver_);
  // Topics of ROS 2 are not recorded.
  if (autopilot == nullptr) return {};
  return create_recorder<TlogRecorder>(std::move(record), kMavlinkSuffix, recordings)
      .map([&](std::optional<TlogRecorder> recorder) { autopilot->record_to(std::move(recorder)); });
}

LiveNav::Kind NavDevice::kind() const {
  if (std::holds_alternative<MavlinkReceiver>(receiver_)) return LiveNav::Kind::kMavlink;
  return std::holds_alternative<A50Receiver>(receiver_) ? LiveNav::Kind::kA50 : LiveNav::Kind::kRos2;
}

std::string NavDevice::name() const {
  const std::string_view prefix = kind() == LiveNav::Kind::kMavlink ? "mavlink:"
                                  : kind() == LiveNav::Kind::kA50   ? "a50:"
                                                                    : "ros2:";
  return std::string(prefix) + std::visit([](const auto& receiver) { return receiver.address(); }, receiver_);
}

int NavDevice::descriptor() const {
  return std::visit([](const auto& receiver) { return receiver.descriptor(); }, receiver_);
}

bool NavDevice::reads_tf() const {
  const auto* const topic = std::get_if<Ros2NavReceiver>(&receiver_);
  return topic != nullptr && topic->reads_tf();
}

LiveNavStatus NavDevice::status() const {
  LiveNavStatus status = std::visit([](const auto& receiver) { return status_of(receiver); }, receiver_);
  status.name = name();
  return status;
}

Result<void> NavDevice::read(double now_s, const Take& take) {
  const auto take_all = [&](const std::vector<NavSource>& sources) {
    for (const NavSource& said : sources) {
      for (const NavSample& sample : said.samples) take(said.name, said.quantity, sample);
    }
  };
  if (auto* const dvl = std::get_if<A50Receiver>(&receiver_)) {
    take_all(dvl->read(now_s));
    return {};
  }
  if (auto* const topic = std::get_if<Ros2NavReceiver>(&receiver_)) {
    take_all(topic->read(now_s));
    return {};
  }
  const auto reports = std::get<MavlinkReceiver>(receiver_).read(now_s);
  if (!reports) return tl::unexpected(reports.error());
  for (const MavlinkNav::Report& report : *reports) {
    note_start(report);
    take(report.source, report.quantity, report.sample);
  }
  return {};
}

void NavDevice::note_start(const MavlinkNav::Report& report) {
  if (report.quantity != NavQuantity::kPosition || !report.sample.valid || !report.made) return;
  const DeviceTime& now = report.made->time;
  Positions& positions = positions_.try_emplace(report.source, Positions{now}).first->second;
  positions.has_other_origin = positions.has_other_origin || was_restarted(positions.last, now);
  positions.last = now;
}

bool NavDevice::has_other_origin(const std::string& position) const {
  const auto positions = positions_.find(position);
  return positions != positions_.end() && positions->second.has_other_origin;
}

}  // namespace pingvox
