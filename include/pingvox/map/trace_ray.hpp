#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "pingvox/geometry/lattice.hpp"
#include "pingvox/map/scan_update.hpp"

namespace pingvox {

enum class RayAlgorithm { kDda, kBresenham };

/// Marks the cells from `from_m` to `to_m` [m, map frame] as missed, the end cell excluded: what `dda` or `bresenham`
/// walk over.
/// @return false, and nothing is marked, when an end lies outside of the lattice
bool trace_ray(const Lattice& lattice, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
               RayAlgorithm algorithm, ScanUpdate& scan);

/// Two ends of a ray [m, map frame].
struct Segment {
  Eigen::Vector3d from_m = Eigen::Vector3d::Zero(), to_m = Eigen::Vector3d::Zero();
};

/// The cells of many rays, one after the other.
class RayKeys {
 public:
  std::size_t size() const { return ends_.size(); }
  /// Cells of ray i: what `dda` walks over; none when an end of it lies outside of the lattice.
  std::span<const Key> operator[](std::size_t i) const { return {keys_.data() + begin_of(i), ends_[i] - begin_of(i)}; }

 private:
  friend void trace_keys(const Lattice& lattice, std::span<const Segment> rays, RayKeys& into);
  std::size_t begin_of(std::size_t i) const { return i == 0 ? 0 : ends_[i - 1] + 1; }

  std::vector<std::size_t> ends_;  ///< behind the last key of each ray; then there is room for one that is none
  std::vector<Key> keys_;
};

/// Walks many rays at once, several side by side: much faster than `dda` for one after the other. A few hundred at a
/// time keep their keys in the cache.
/// @param into  what it held is forgotten, its memory used again
/// REQUIRES lattice.depth() <= 16
void trace_keys(const Lattice& lattice, std::span<const Segment> rays, RayKeys& into);

}  // namespace pingvox
