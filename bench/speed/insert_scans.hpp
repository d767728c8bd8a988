#pragma once

#include <span>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/map/trace_ray.hpp"

namespace pingvox::bench {

/// Each scan traced and applied. `scan` is room that is used for all of them, empty before and after.
inline void insert(OccupancyMap& map, ScanUpdate& scan, std::span<const PointScan> scans,
                   const PointScanOptions& options = {}) {
  for (const PointScan& points : scans) {
    trace_points(map.lattice(), points, options, scan);
    (void)map.apply(scan);
    scan.clear();
  }
}

}  // namespace pingvox::bench
