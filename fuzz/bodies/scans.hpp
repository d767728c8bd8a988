#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fuzz/bodies/require.hpp"
#include "pingvox/io/beams.hpp"

namespace pingvox::fuzz {

inline std::vector<PointScan> scans_in(std::span<const std::uint8_t> bytes, Damage damage) {
  std::vector<PointScan> scans;
  const auto source = open_scans({"fuzzed", {bytes.begin(), bytes.end()}}, damage);
  if (!source) {
    require(!source.error().message.empty(), "an error says something");
    return scans;
  }
  std::size_t points = 0;
  for (;;) {
    auto scan = (*source)->next();
    require(scan.has_value() || damage == Damage::kFail, "damage that is not fatal at the start is stepped over");
    require(scan.has_value() || (*source)->skipped() >= 1, "damage ends a strict read");
    if (!scan || !*scan) break;
    require((*scan)->origin_m.allFinite(), "origins are finite");
    for (const Eigen::Vector3d& point : (*scan)->points_m) require(point.allFinite(), "points are finite");
    points += (*scan)->points_m.size();
    scans.push_back(std::move(**scan));
  }
  // But compressed ones: LZF makes at most 88 bytes of one, and a point has three.
  require(points <= 30 * bytes.size(), "points take bytes");
  require((*source)->skipped() <= 30 * bytes.size(), "no more is skipped than there is");
  return scans;
}

/// Any bytes as a log of scans or as a cloud: what is read is finite, and a strict read is the start of a lenient one.
/// @return scans read
inline std::size_t scans(std::span<const std::uint8_t> bytes) {
  const std::vector<PointScan> lenient = scans_in(bytes, Damage::kSkip);
  const std::vector<PointScan> strict = scans_in(bytes, Damage::kFail);
  require(strict.size() <= lenient.size(), "a strict read gives no more");
  for (std::size_t i = 0; i < strict.size(); ++i) {
    require(strict[i].origin_m == lenient[i].origin_m && strict[i].points_m == lenient[i].points_m,
            "a strict read gives the same");
  }
  return lenient.size();
}

}  // namespace pingvox::fuzz
