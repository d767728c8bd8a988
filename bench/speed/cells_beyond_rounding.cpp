#include "cells_beyond_rounding.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace pingvox::bench {
namespace {

/// [cells]. After hundreds of sums in single precision, liboctomap's rays are a thousandth off.
constexpr double kMargin = 0.01;

/// A ray in units of cells.
struct Ray {
  Eigen::Vector3d from, to, direction;
};

std::vector<Ray> rays_of(const Lattice& lattice, const RayCloud& scan) {
  std::vector<Ray> rays;
  rays.reserve(scan.ends_m.size());
  const Eigen::Vector3d from = scan.origin_m.cast<double>() / lattice.resolution_m();
  for (const Eigen::Vector3f& end_m : scan.ends_m) {
    const Eigen::Vector3d to = end_m.cast<double>() / lattice.resolution_m();
    rays.push_back({from, to, (to - from).normalized()});
  }
  return rays;
}

/// Whether a ray without motion along this axis is in the cell's layer (lower face included, upper excluded).
bool is_in_layer(double at, double middle) {
  return at >= middle - 0.5 && at < middle + 0.5;
}

/// Whether a ray enters the cube of this half edge.
bool meets(const Ray& ray, const Eigen::Vector3d& middle, double half) {
  double in = 0.0, out = 1.0;  // interval of the ray between the faces of all axes so far
  for (int axis = 0; axis < 3; ++axis) {
    const double along = ray.to[axis] - ray.from[axis], before = middle[axis] - ray.from[axis];
    if (along == 0.0) {
      if (!is_in_layer(ray.from[axis], middle[axis])) return false;
      continue;
    }
    const double one = (before - half) / along, other = (before + half) / along;
    in = std::max(in, std::min(one, other));
    out = std::min(out, std::max(one, other));
  }
  return in <= out;
}

bool ends_in(const Ray& ray, const Eigen::Vector3d& middle, double half) {
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_in = ray.to[axis] == ray.from[axis] ? is_in_layer(ray.to[axis], middle[axis])
                                                      : std::abs(ray.to[axis] - middle[axis]) <= half;
    if (!is_in) return false;
  }
  return true;
}

bool is_within_rounding(std::span<const Ray> rays, const Eigen::Vector3d& middle) {
  constexpr double kSmaller = 0.5 - kMargin, kLarger = 0.5 + kMargin, kReach = 0.9;  // to the corners, and more
  bool may_hit = false, surely_missed = false, may_miss = false;
  for (const Ray& ray : rays) {
    const Eigen::Vector3d way = middle - ray.from;
    const double along = way.dot(ray.direction);
    if (way.squaredNorm() - along * along > kReach * kReach) continue;
    if (ends_in(ray, middle, kSmaller)) return false;  // a hit, whatever passes
    const bool may_end = ends_in(ray, middle, kLarger);
    may_hit |= may_end;
    if (!meets(ray, middle, kLarger)) continue;
    may_miss = true;
    surely_missed |= !may_end && meets(ray, middle, kSmaller);
  }
  return may_hit || (may_miss && !surely_missed);
}

}  // namespace

std::vector<Key> cells_beyond_rounding(const Lattice& lattice, std::span<const RayCloud> scans,
                                       std::span<const Key> cells) {
  std::vector<Key> beyond(cells.begin(), cells.end());
  for (const RayCloud& scan : scans) {
    if (beyond.empty()) break;
    const std::vector<Ray> rays = rays_of(lattice, scan);
    std::erase_if(beyond, [&](const Key& cell) {
      return is_within_rounding(rays, lattice.centre_of(cell) / lattice.resolution_m());
    });
  }
  return beyond;
}

}  // namespace pingvox::bench
