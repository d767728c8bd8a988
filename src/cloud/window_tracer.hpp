#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cloud/ray_kernels.hpp"
#include "cloud/scan_window.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/map/trace_ray.hpp"

namespace pingvox::detail {

/// Walks rays side by side in a ScanWindow and hands what they marked to a ScanUpdate. It keeps its memory.
class WindowTracer {
 public:
  /// Rays that are prepared together, so that what is known of them stays in the cache.
  static constexpr std::size_t kBlock = 1024;

  /// Opens a window for so many rays that stay within `reach_m` of `middle_m` along each axis; rays that do not are
  /// not traced in it.
  /// @return whether there is one. There is none for few rays, for those that need a larger one than there may be, for
  ///         those that are not walked by DDA and for lattices of few levels: walking them one by one is as quick.
  bool open(const Lattice& lattice, RayAlgorithm ray, std::size_t rays, const Eigen::Vector3d& middle_m,
            double reach_m);

  const RayGrid& grid() const { return grid_; }
  ScanWindow& window() { return window_; }

  /// Marks the cells of rays as missed. Calls on_end(i, place of the last cell) for each; kNoPlace: the ray is not
  /// traced. REQUIRES an open window, and as many beginnings as ends or one for all.
  template <class Point, class F>
  void trace(std::span<const Eigen::Vector3d> from_m, std::span<const Point> to_m, F&& on_end) {
    if (from_m.size() == 1) same_from_m_.assign(std::min(kBlock, to_m.size()), from_m.front());
    for (std::size_t first = 0; first < to_m.size(); first += kBlock) {
      const std::size_t count = std::min(kBlock, to_m.size() - first);
      const auto beginnings = from_m.size() == 1 ? std::span<const Eigen::Vector3d>(same_from_m_).first(count)
                                                 : from_m.subspan(first, count);
      prepare_rays(grid_, beginnings, to_m.subspan(first, count), rays_);
      for (std::size_t i = 0; i < count; ++i) on_end(first + i, rays_.end[i]);
      mark_rays(rays_, window_);
    }
  }

  /// Marks in `scan` what is marked in the window, hits with this evidence, and empties the window.
  void hand_over(LogOdds hit, ScanUpdate& scan);

  /// Forgets all marks, after an exception: they would become those of the next scan, at another place.
  void drop() { window_.drop(); }

 private:
  ScanWindow window_;
  RayGrid grid_;
  PreparedRays rays_;
  std::vector<Eigen::Vector3d> same_from_m_;
};

}  // namespace pingvox::detail
