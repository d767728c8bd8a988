#include "pingvox/cloud/insert_points.hpp"

#include <new>

namespace pingvox {
namespace {

template <class Point>
Result<InsertReport> insert(OccupancyMap& map, const Eigen::Vector3d& origin_m, std::span<const Point> points_m,
                            const InsertOptions& options) {
  if (const auto fits = check_rays(origin_m, points_m, options.scan, map.lattice()); !fits) {
    return tl::unexpected(fits.error());
  }
  try {
    ScanUpdate scan(map.lattice(), options.miss);
    const std::size_t outside = PointTracer(options.scan).trace(origin_m, points_m, scan);
    const Result<ApplyReport> applied = map.apply(scan);
    if (!applied) return tl::unexpected(applied.error());
    return InsertReport{*applied, outside};
  } catch (const std::bad_alloc&) {
    return fail(Error::Code::kNoMemory, "out of memory");
  }
}

}  // namespace

Result<InsertReport> insert_points(OccupancyMap& map, const Eigen::Vector3d& origin_m,
                                   std::span<const Eigen::Vector3d> points_m, const InsertOptions& options) {
  return insert(map, origin_m, points_m, options);
}

Result<InsertReport> insert_points(OccupancyMap& map, const Eigen::Vector3d& origin_m,
                                   std::span<const Eigen::Vector3f> points_m, const InsertOptions& options) {
  return insert(map, origin_m, points_m, options);
}

}  // namespace pingvox
