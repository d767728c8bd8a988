#pragma once

#include <Eigen/Core>
#include <span>

#include "bench/speed/tank_echoes.hpp"
#include "pingvox/cloud/trace_points.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/scan_update.hpp"

namespace pingvox::bench {

/// Traces and applies each scan. `scan` is reused buffer space, empty before and after.
inline void insert(OccupancyMap& map, ScanUpdate& scan, std::span<const RayCloud> scans,
                   const PointScanOptions& options = {}) {
  PointTracer tracer(options);
  for (const RayCloud& cloud : scans) {
    tracer.trace(cloud.origin_m.cast<double>(), cloud.ends_m, scan);
    (void)map.apply(scan);
    scan.clear();
  }
}

}  // namespace pingvox::bench
