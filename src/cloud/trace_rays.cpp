#include "cloud/internal/trace_rays.hpp"

#include <Eigen/Geometry>
#include <cassert>

#include "cloud/window_tracer.hpp"

namespace pingvox {

RayTracer::RayTracer(RayAlgorithm ray) : ray_(ray), window_(std::make_unique<detail::WindowTracer>()) {}
RayTracer::RayTracer(RayTracer&& other) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&& other) noexcept = default;
RayTracer::~RayTracer() = default;

std::vector<std::size_t> RayTracer::trace(std::span<const Eigen::Vector3d> from_m,
                                          std::span<const Eigen::Vector3d> to_m, ScanUpdate& scan) {
  assert(from_m.size() == to_m.size());
  std::vector<std::size_t> left_out;
  const auto trace_one = [&](std::size_t i) {
    if (!trace_ray(from_m[i], to_m[i], ray_, scan)) left_out.push_back(i);
  };
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point_m : from_m) box.extend(point_m);
  for (const Eigen::Vector3d& point_m : to_m) box.extend(point_m);
  if (to_m.empty() || !window_->open(scan.lattice(), ray_, to_m.size(), box.center(), 0.5 * box.sizes().maxCoeff())) {
    for (std::size_t i = 0; i < to_m.size(); ++i) trace_one(i);
    return left_out;
  }
  try {
    window_->trace(from_m, to_m, [&](std::size_t i, std::uint64_t end) {
      if (end == detail::kNoPlace) trace_one(i);
    });
    window_->hand_over(LogOdds(), scan);
  } catch (...) {
    window_->drop();
    throw;
  }
  return left_out;
}

}  // namespace pingvox
