#include <fmt/core.h>

#include <algorithm>

#include "pingvox/cloud/trace_points.hpp"

namespace pingvox {
namespace {

template <class Point>
Result<void> check_length(const Eigen::Vector3d& origin_m, std::span<const Point> points_m,
                          const PointScanOptions& options, const Lattice& lattice) {
  const double most_m = kMaxCellsInRay * lattice.resolution_m();
  if (options.max_range_m <= most_m || !lattice.key_of<WideWord>(origin_m)) return {};
  for (const Point& point : points_m) {
    const Eigen::Vector3d way_m = point.template cast<double>() - origin_m;
    const double range_m = way_m.norm();
    if (!(range_m > most_m)) continue;  // NaN, too
    const double traced_m = std::min(range_m, options.max_range_m);
    if (!lattice.key_of<WideWord>(origin_m + way_m * (traced_m / range_m))) continue;
    return fail(Error::Code::kLimit,
                fmt::format("a ray of {:.6g} m has {:.1e} cells of {} m, and {:.0e} are the most", traced_m,
                            traced_m * lattice.cells_per_m(), lattice.resolution_m(), kMaxCellsInRay));
  }
  return {};
}

}  // namespace

Result<void> check_rays(const Eigen::Vector3d& origin_m, std::span<const Eigen::Vector3d> points_m,
                        const PointScanOptions& options, const Lattice& lattice) {
  return check_length(origin_m, points_m, options, lattice);
}

Result<void> check_rays(const Eigen::Vector3d& origin_m, std::span<const Eigen::Vector3f> points_m,
                        const PointScanOptions& options, const Lattice& lattice) {
  return check_length(origin_m, points_m, options, lattice);
}

}  // namespace pingvox
