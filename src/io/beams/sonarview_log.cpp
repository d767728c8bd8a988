#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "io/beams/frame_log.hpp"
#include "io/internal/ping_frame.hpp"
#include "io/readers.hpp"

// Logs of SonarView, and captures of the line of a Ping360: frames of the Ping protocol and nothing else
// (docs/formats.md).
namespace pingvox {

namespace {

/// Whether a description of the session begins, which may be longer than the bytes at hand.
bool begins_with_session(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kJsonWrapper = 10;
  return bytes.size() > 8 && bytes[0] == 'B' && bytes[1] == 'R' && bytes[4] == kJsonWrapper && bytes[5] == 0 &&
         bytes[8] == '{';
}

}  // namespace

bool looks_like_sonarview(std::span<const std::uint8_t> beginning) {
  if (beginning.empty()) return false;
  if (begins_with_session(beginning)) return true;
  if (check_sonarview_frame({beginning}).verdict == FrameCheck::Verdict::kFrame) return true;
  // It may begin within a frame, or with a damaged one. A ping is certain by its checksum and both of its lengths.
  constexpr std::size_t kSearched = 16384;
  FrameFinder finder(check_sonarview_frame);
  finder.push(beginning.first(std::min(beginning.size(), kSearched)));
  finder.end();
  while (const auto frame = finder.next()) {
    if (ping360_ping(frame->bytes)) return true;
  }
  return false;
}

Result<std::unique_ptr<BeamSource>> open_sonarview(ByteStream stream, Damage damage) {
  const std::string name = stream.name();
  std::unique_ptr<BeamSource> beams = beams_of(raw_capture(std::move(stream)), sonarview_protocol(), damage);
  if (beams->device() != nullptr) return beams;
  // Nothing was a ping up to the end, or to an error.
  if (const Result<std::optional<Beam>> first = beams->next(); !first) return tl::unexpected(first.error());
  return fail(
      Error::Code::kUnsupported,
      fmt::format("{}: is a log of SonarView without pings of a Ping360: those of other sonars are not read", name));
}

}  // namespace pingvox
