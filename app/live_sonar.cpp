#include "live_sonar.hpp"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <ctime>
#include <string>
#include <system_error>
#include <utility>

#include "pingvox/io/beams.hpp"

namespace pingvox::app {
namespace {

/// Ping Viewer's name for a log, "20261123-175346123", in local time.
std::string name_by_time(const LiveStart& start) {
  const auto seconds = static_cast<std::time_t>(start.since_1970_ms / 1000);
  std::tm local = {};
  ::localtime_r(&seconds, &local);
  return fmt::format("{:%Y%m%d-%H%M%S}{:03}", local, start.since_1970_ms % 1000);
}

}  // namespace

Result<std::optional<std::filesystem::path>> record_path(const LiveCommand& command, const LiveStart& start) {
  if (!command.record) return std::nullopt;
  std::filesystem::path path = *command.record;
  std::error_code error;
  if (path.extension().empty() && !std::filesystem::exists(path, error)) {
    std::filesystem::create_directories(path, error);
    if (error) return fail(Error::Code::kIo, fmt::format("{}: {}", *command.record, error.message()));
  }
  if (std::filesystem::is_directory(path, error)) {
    path /= name_by_time(start) + (command.device.kind == LiveDevice::Kind::kMicron ? ".csv" : ".bin");
  }
  return path;
}

Result<std::unique_ptr<LiveSource>> open_live_sonar(const LiveCommand& command, Recordings& recordings,
                                                    const LiveStart& start) {
  const LiveDevice& device = command.device;
  if (device.kind == LiveDevice::Kind::kReplay) {
    return ByteStream::open(device.address)
        .and_then([](ByteStream stream) { return open_beams(std::move(stream)); })
        .map([&](std::unique_ptr<BeamSource> log) { return replay_source(std::move(log), device.speed); });
  }
  if (device.kind == LiveDevice::Kind::kMicron) {
    return recordings.create<SeanetRecorder>(recordings.sonar(), start.since_1970_ms)
        .map([&](std::optional<SeanetRecorder> recorder) {
          return micron_source(device.address, command.micron, std::move(recorder), start.s);
        });
  }
  return recordings.create<PingViewerRecorder>(recordings.sonar(), start.since_1970_ms)
      .map([&](std::optional<PingViewerRecorder> recorder) {
        return ping360_source(device.address, command.ping360, std::move(recorder), start.s);
      });
}

}  // namespace pingvox::app
