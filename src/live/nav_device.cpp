#include "live/nav_device.hpp"

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

}  // namespace

Result<NavDevice> NavDevice::open(const LiveNav& from, std::optional<std::filesystem::path> record,
                                  Recordings& recordings, double since_1970_s) {
  if (from.kind == LiveNav::Kind::kA50) {
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
  return (std::holds_alternative<MavlinkReceiver>(receiver_) ? "mavlink:" : "a50:") +
         std::visit([](const auto& receiver) { return receiver.address(); }, receiver_);
}

int NavDevice::descriptor() const {
  return std::visit([](const auto& receiver) { return receiver.descriptor(); }, receiver_);
}

LiveNavStatus NavDevice::status() const {
  LiveNavStatus status = std::visit([](const auto& receiver) { return status_of(receiver); }, receiver_);
  status.name = name();
  return status;
}

Result<void> NavDevice::read(double now_s, const Take& take) {
  if (auto* const dvl = std::get_if<A50Receiver>(&receiver_)) {
    for (const NavSource& said : dvl->read(now_s)) {
      for (const NavSample& sample : said.samples) take(said.name, said.quantity, sample);
    }
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
  positions.has_other_origin = positions.has_other_origin || was_started_anew(positions.last, now);
  positions.last = now;
}

bool NavDevice::has_other_origin(const std::string& position) const {
  const auto positions = positions_.find(position);
  return positions != positions_.end() && positions->second.has_other_origin;
}

}  // namespace pingvox
