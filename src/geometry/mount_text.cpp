#include "geometry/internal/mount_text.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/option_text.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox {

Result<Pose> mount_from(std::string_view text) {
  const auto n = numbers_from<6>(text);
  if (!n) {
    return fail(Error::Code::kBadOption, n.error().message + ": x,y,z in metres and roll,pitch,yaw in degrees");
  }
  if (!std::ranges::all_of(*n, [](double v) { return std::isfinite(v); })) {
    return fail(Error::Code::kBadOption, fmt::format("'{}': must be finite", text));
  }
  const auto& [x, y, z, roll, pitch, yaw] = *n;
  return pose_from_rpy({x, y, z}, roll * kDegree_rad, pitch * kDegree_rad, yaw * kDegree_rad);
}

std::string mount_text(const Pose& pose) {
  const Eigen::Vector3d rpy_deg = rpy_of(pose.rotation()) / kDegree_rad;
  const Eigen::Vector3d at = pose.translation();
  return fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}", at.x(), at.y(), at.z(), rpy_deg.x(), rpy_deg.y(),
                     rpy_deg.z());
}

}  // namespace pingvox
