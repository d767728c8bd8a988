#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "fuzz/bodies/beams.hpp"
#include "fuzz/bodies/nav.hpp"
#include "fuzz/bodies/require.hpp"
#include "pingvox/io/bag.hpp"

namespace pingvox::fuzz {

/// The scans of a topic.
/// @return their points
inline std::size_t scans_of(const std::string& topic, std::span<const std::uint8_t> bytes) {
  const auto log = open_bag_log({FileBytes{"fuzzed", {bytes.begin(), bytes.end()}}}, Damage::kSkip, {.name = topic});
  if (!log) return 0;
  const auto* scans = std::get_if<std::unique_ptr<ScanSource>>(&*log);
  if (scans == nullptr) return 0;
  std::size_t points = 0;
  for (;;) {
    const auto scan = (*scans)->next();
    if (!scan || !*scan) return points;
    require((*scan)->time_s && std::isfinite(*(*scan)->time_s), "each scan of a bag has a time");
    for (const auto& point_m : (*scan)->points_m) require(point_m.allFinite(), "each point is finite");
    points += (*scan)->points_m.size();
  }
}

/// Any bytes as a ROS bag: its beams, its navigation, and the scans of each topic that has some.
/// @return beams, samples and points
inline std::size_t bag(std::span<const std::uint8_t> bytes) {
  std::size_t points = 0;
  const auto contents = read_bag({FileBytes{"fuzzed", {bytes.begin(), bytes.end()}}});
  if (contents) {
    for (const BagTopicSummary& topic : contents->topics) {
      if (topic.use == BagTopicSummary::Use::kScans) points += scans_of(topic.name, bytes);
    }
  }
  return beams(bytes) + nav(bytes) + points;
}

}  // namespace pingvox::fuzz
