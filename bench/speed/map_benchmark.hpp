#pragma once

#include <octomap/OcTree.h>

#include <functional>
#include <string>

#include "bench/report.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/result.hpp"
#include "same_map.hpp"

namespace pingvox::bench {

/// A comparison of two libraries that build the same map.
struct MapBenchmark {
  std::string name;
  double resolution_m = 0.05;
  /// Fills an empty map. The scan is reused buffer space, empty before and after.
  std::function<void(OccupancyMap&, ScanUpdate&)> ours;
  std::function<void(octomap::OcTree&)> peer;
  /// Checks one run of each before anything is measured.
  std::function<Result<void>(const OccupancyMap&, const octomap::OcTree&)> check = &check_identical;
};

/// Checks the maps, then measures the peak memory of each side in a child process, and the times.
/// @return the row of speed_row, to which the caller may add; the error of `check`
Result<Row> measure(const MapBenchmark& benchmark);

}  // namespace pingvox::bench
