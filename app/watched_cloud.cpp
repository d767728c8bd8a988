#include "watched_cloud.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

#include "pingvox/cloud/trace_points.hpp"

namespace pingvox::app {

Result<std::optional<PointScan>> WatchedCloud::next() {
  Result<std::optional<PointScan>> scan = source_->next();
  if (!scan || !*scan || (*scan)->points_m.empty()) return scan;
  const std::span<const Eigen::Vector3d> points_m = (*scan)->points_m;
  origin_m_ = (*scan)->origin_m;
  points_ = points_m.size();
  nearest_m_ = std::numeric_limits<double>::infinity();
  Eigen::Vector3d low_m = points_m.front(), high_m = low_m;
  for (const Eigen::Vector3d& point_m : points_m) {
    nearest_m_ = std::min(nearest_m_, (point_m - origin_m_).norm());
    low_m = low_m.cwiseMin(point_m);
    high_m = high_m.cwiseMax(point_m);
  }
  extent_m_ = (high_m - low_m).norm();
  const PointScanOptions options{.max_range_m = max_range_m_};
  if (const auto fits = check_rays(origin_m_, points_m, options, lattice_); !fits) {
    return fail(fits.error().code, fmt::format("its points are {} ({})", origin_text(), fits.error().message));
  }
  return scan;
}

std::string WatchedCloud::origin_text() const {
  constexpr double kKilometres_m = 10'000.0;
  const std::string distance =
      nearest_m_ < kKilometres_m ? fmt::format("{:.4g} m", nearest_m_) : fmt::format("{:.0f} km", nearest_m_ / 1000.0);
  return fmt::format("seen from {:.6g}, {:.6g}, {:.6g}, {} away: --origin is where a cloud was seen from",
                     origin_m_.x(), origin_m_.y(), origin_m_.z(), distance);
}

bool WatchedCloud::is_far() const {
  constexpr std::size_t kMany = 10;
  constexpr double kTooFar = 100.0;
  return points_ >= kMany && extent_m_ > 0.0 && nearest_m_ > kTooFar * extent_m_;
}

}  // namespace pingvox::app
