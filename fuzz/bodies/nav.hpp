#pragma once

#include <cstdint>
#include <span>
#include <sstream>
#include <string>

#include "fuzz/bodies/require.hpp"
#include "io/internal/mavlink.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox::fuzz {

/// Any bytes as a navigation log, and as MAVLink frames.
/// @return samples and frames
inline std::size_t nav(std::span<const std::uint8_t> bytes) {
  std::size_t whole = 0;
  for (auto rest = bytes; !rest.empty();) {
    const MavlinkRead frame = read_mavlink(rest);
    require(!frame.frame || (!frame.is_cut && frame.length <= rest.size()), "a whole frame is in the bytes");
    const bool is_right = frame.frame && (frame.frame->check == MavlinkFrame::Check::kRight ||
                                          frame.frame->check == MavlinkFrame::Check::kRightPadded);
    whole += is_right ? 1 : 0;
    require(!is_right || read_mavlink(rest.first(frame.length - 1)).is_cut, "less than a whole frame is cut");
    rest = rest.subspan(is_right ? frame.length : 1);
  }

  const auto read = read_nav({"fuzzed", {bytes.begin(), bytes.end()}});
  if (!read) {
    require(read.error().message.starts_with("fuzzed"), "an error names the file");
    return whole;
  }
  std::size_t samples = 0;
  for (const NavSource& source : read->log.sources()) {
    double before_s = source.samples.front().time_s;
    for (const NavSample& sample : source.samples) {
      require(sample.time_s >= before_s && sample.value.allFinite(), "samples are finite, in order of time");
      before_s = sample.time_s;
      ++samples;
    }
    const NavSummary summary = summary_of(source);
    require(summary.samples == source.samples.size() && summary.rate_hz >= 0.0, "a summary makes sense");
  }
  for (const DamageKind& damage : read->damage) {
    require(damage.count > 0 && damage.first_byte < bytes.size(), "damage is in the file");
  }
  if (const auto path = nav_trajectory(read->log)) {
    require(path->trajectory.poses().size() <= samples, "poses come from samples");
  }
  std::stringstream text;
  require(write_nav_csv(read->log, text).value_or(bytes.size() * 3) == samples, "what is read is written");
  const std::string written = text.str();
  const auto back = read_nav({"written", {written.begin(), written.end()}});
  std::size_t samples_back = 0;
  if (back) {
    for (const NavSource& source : back->log.sources()) samples_back += source.samples.size();
  }
  require(back && back->damage.empty() && samples_back == samples, "what is written is read");
  require(samples <= 2 * bytes.size(), "samples come from bytes");
  return samples + whole;
}

}  // namespace pingvox::fuzz
