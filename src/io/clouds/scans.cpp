#include "io/clouds/scans.hpp"

#include <cmath>

namespace pingvox {
namespace {

Eigen::Vector3d to_double(const Point3f& p) {
  return Eigen::Vector3f(p[0], p[1], p[2]).cast<double>();
}

}  // namespace

bool is_rotation(const std::array<float, 4>& quaternion) {
  double squares = 0.0;
  for (const float c : quaternion) squares += static_cast<double>(c) * static_cast<double>(c);
  return std::fabs(std::sqrt(squares) - 1.0) <= 1e-3;  // false for NaN
}

ScanBuilder::ScanBuilder(const OctomapPose& pose, std::size_t number) : pose_(pose) {
  scan_.origin_m = to_double(pose_.ray_origin());
  const auto& [w, x, y, z] = pose_.rotation;
  scan_.rotation = Eigen::Quaternionf(w, x, y, z).cast<double>();
  scan_.number = number;
}

bool ScanBuilder::add(const Point3f& point) {
  const Eigen::Vector3d moved = to_double(pose_.transform(point));
  if (!moved.allFinite()) return false;
  scan_.points_m.push_back(moved);
  return true;
}

}  // namespace pingvox
