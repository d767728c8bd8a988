#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>

#include "pingvox/map/log_odds.hpp"
#include "pingvox/map/point_scan.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/map/trace_ray.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Where the rays of a point scan end.
enum class EndPoints {
  kExact,  ///< in each point
  kCells,  ///< in the middle of each cell with a point, once: fewer rays, a little less exact (OctoMap's `discretize`)
};

struct PointScanOptions {
  RayAlgorithm ray = RayAlgorithm::kDda;
  LogOdds hit = LogOdds::from_probability(0.7);
  double max_range_m = std::numeric_limits<double>::infinity();  ///< longer rays free cells up to here and hit nothing
  EndPoints ends = EndPoints::kExact;
};

/// Checks before tracing that the rays of a scan are no longer than kMaxCellsInRay. Those that leave the lattice do not
/// count: they are not traced.
/// @return kLimit naming the length of a ray that is too long
Result<void> check_rays(const Eigen::Vector3d& origin_m, std::span<const Eigen::Vector3d> points_m,
                        const PointScanOptions& options, const Lattice& lattice);
Result<void> check_rays(const Eigen::Vector3d& origin_m, std::span<const Eigen::Vector3f> points_m,
                        const PointScanOptions& options, const Lattice& lattice);

/// Traces point scans into scan updates. It reuses its memory from scan to scan, which saves a quarter of the time of a
/// small one. Not thread-safe: each thread needs its own.
class PointTracer {
 public:
  explicit PointTracer(const PointScanOptions& options = {});
  PointTracer(PointTracer&& other) noexcept;
  PointTracer& operator=(PointTracer&& other) noexcept;
  ~PointTracer();

  /// Marks each point [m, map frame] as hit and the cells before it, seen from `origin_m`, as missed: the sets of
  /// liboctomap's insertPointCloud. Throws std::bad_alloc; what it marked before stays.
  /// @return points that lie outside of the lattice, or whose ray does because the origin is; a point inside is hit
  /// also then
  std::size_t trace(const Eigen::Vector3d& origin_m, std::span<const Eigen::Vector3d> points_m, ScanUpdate& scan);
  /// The same for points in single precision, as ROS, PCL and OctoMap hold them.
  std::size_t trace(const Eigen::Vector3d& origin_m, std::span<const Eigen::Vector3f> points_m, ScanUpdate& scan);

 private:
  class Tracer;
  std::unique_ptr<Tracer> tracer_;
};

/// The same for a single scan.
std::size_t trace_points(const PointScan& points, const PointScanOptions& options, ScanUpdate& scan);

}  // namespace pingvox
