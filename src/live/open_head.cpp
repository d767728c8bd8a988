#include "live/open_head.hpp"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <ctime>
#include <string>
#include <system_error>
#include <utility>

#include "pingvox/io/beams.hpp"

namespace pingvox {
namespace {

/// Ping Viewer's name for a log, "20261123-175346123", in local time.
std::string name_by_time(std::uint64_t since_1970_ms) {
  const auto seconds = static_cast<std::time_t>(since_1970_ms / 1000);
  std::tm local = {};
  ::localtime_r(&seconds, &local);
  return fmt::format("{:%Y%m%d-%H%M%S}{:03}", local, since_1970_ms % 1000);
}

template <class Recorder>
Result<std::optional<HeadRecorder>> recorder_of(Recordings& recordings, std::uint64_t since_1970_ms) {
  Result<std::optional<Recorder>> recorder = recordings.create<Recorder>(recordings.sonar(), since_1970_ms);
  if (!recorder) return tl::unexpected(recorder.error());
  if (!*recorder) return std::nullopt;
  return HeadRecorder(std::move(**recorder));
}

}  // namespace

Result<std::optional<std::filesystem::path>> record_path(const LiveOptions& options, std::uint64_t since_1970_ms) {
  if (!options.record) return std::nullopt;
  std::filesystem::path path = *options.record;
  std::error_code error;
  if (path.extension().empty() && !std::filesystem::exists(path, error)) {
    std::filesystem::create_directories(path, error);
    if (error) return fail(Error::Code::kIo, fmt::format("{}: {}", *options.record, error.message()));
  }
  if (std::filesystem::is_directory(path, error)) {
    path /= name_by_time(since_1970_ms) + (options.head.kind == LiveHead::Kind::kMicron ? ".csv" : ".bin");
  }
  return path;
}

Result<std::optional<HeadRecorder>> head_recorder(const LiveHead& head, Recordings& recordings,
                                                  std::uint64_t since_1970_ms) {
  return head.kind == LiveHead::Kind::kMicron ? recorder_of<SeanetRecorder>(recordings, since_1970_ms)
                                              : recorder_of<PingViewerRecorder>(recordings, since_1970_ms);
}

Result<std::unique_ptr<LiveSource>> open_head(const LiveHead& head, Recordings& recordings, std::uint64_t since_1970_ms,
                                              const std::optional<Ros2Node>& node) {
  constexpr double kStart_s = 0.0, kMs_per_s = 1000.0;
  if (head.kind == LiveHead::Kind::kRos2 && node) {
    return ros2_source(*node, head.address, static_cast<double>(since_1970_ms) / kMs_per_s);
  }
  if (head.kind == LiveHead::Kind::kReplay) {
    return ByteStream::open(head.address)
        .and_then([](ByteStream stream) { return open_beams(std::move(stream)); })
        .map([&](std::unique_ptr<BeamSource> log) { return replay_source(std::move(log), head.speed); });
  }
  if (head.kind == LiveHead::Kind::kMicron) {
    return recordings.create<SeanetRecorder>(recordings.sonar(), since_1970_ms)
        .map([&](std::optional<SeanetRecorder> recorder) {
          return micron_source(head.address, head.micron, std::move(recorder), kStart_s);
        });
  }
  return recordings.create<PingViewerRecorder>(recordings.sonar(), since_1970_ms)
      .map([&](std::optional<PingViewerRecorder> recorder) {
        if (head.kind == LiveHead::Kind::kSharedPing360) {
          return shared_ping360_source(head.address, std::move(recorder), kStart_s);
        }
        if (head.kind == LiveHead::Kind::kPingViewer2) {
          return ping_viewer_2_source(head.address, head.device, std::move(recorder), kStart_s);
        }
        return ping360_source(head.address, head.ping360, std::move(recorder), kStart_s);
      });
}

}  // namespace pingvox
