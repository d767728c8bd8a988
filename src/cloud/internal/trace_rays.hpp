#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "pingvox/map/scan_update.hpp"
#include "pingvox/map/trace_ray.hpp"

namespace pingvox {

namespace detail {
class WindowTracer;
}

/// Traces rays that begin in different places, as the beams of a moving sonar: what `trace_ray` does for each, in less
/// time. It keeps its memory from scan to scan. Not for several threads at once: each needs its own.
class RayTracer {
 public:
  explicit RayTracer(RayAlgorithm ray = RayAlgorithm::kDda);
  RayTracer(RayTracer&& other) noexcept;
  RayTracer& operator=(RayTracer&& other) noexcept;
  ~RayTracer();

  /// Marks the cells from `from_m[i]` to `to_m[i]` [m, map frame] as missed, the first one included and the last one
  /// not. Throws std::bad_alloc; what it marked before stays. REQUIRES as many beginnings as ends
  /// @return the numbers of the rays that are left out because an end lies outside of the lattice, rising
  std::vector<std::size_t> trace(std::span<const Eigen::Vector3d> from_m, std::span<const Eigen::Vector3d> to_m,
                                 ScanUpdate& scan);

 private:
  RayAlgorithm ray_;
  std::unique_ptr<detail::WindowTracer> window_;
};

}  // namespace pingvox
