#include "io/maps/octomap_pose.hpp"

#include <algorithm>
#include <cmath>

namespace pingvox {
namespace {

using Quaternionf = std::array<float, 4>;

Quaternionf conjugate(const Quaternionf& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}

/// Hamilton's product, with the terms in OctoMap's order for equal rounding.
Quaternionf product(const Quaternionf& a, const Quaternionf& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],  //
          a[2] * b[3] - b[2] * a[3] + a[0] * b[1] + b[0] * a[1],  //
          a[3] * b[1] - b[3] * a[1] + a[0] * b[2] + b[0] * a[2],  //
          a[1] * b[2] - b[1] * a[2] + a[0] * b[3] + b[0] * a[3]};
}

Point3f rotate(const Quaternionf& rotation, const Point3f& p) {
  const Quaternionf result = product(product(rotation, {0.0F, p[0], p[1], p[2]}), conjugate(rotation));
  return {result[1], result[2], result[3]};
}

Quaternionf normalize(Quaternionf q) {
  // Each square is rounded to float, their sum is not.
  double squares = 0.0;
  for (const float c : q) squares += static_cast<double>(c * c);
  const float norm = static_cast<float>(std::sqrt(squares));
  if (norm > 0.0F) {
    for (float& c : q) c /= norm;
  }
  return q;
}

Point3f sum(const Point3f& a, const Point3f& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

}  // namespace

OctomapPose OctomapPose::from_rpy(const Point3f& translation, float roll_rad, float pitch_rad, float yaw_rad) {
  const double roll = static_cast<double>(roll_rad);
  const double pitch = static_cast<double>(pitch_rad);
  const double yaw = static_cast<double>(yaw_rad);
  const double sr = std::sin(roll), sp = std::sin(pitch), sy = std::sin(yaw);
  const double cr = std::cos(roll), cp = std::cos(pitch), cy = std::cos(yaw);

  // Matrix Rz * Ry * Rx, then its quaternion: magnitudes from the diagonal, signs from the rest.
  const double xx = cy * cp, xy = cy * sp * sr - sy * cr, xz = cy * sp * cr + sy * sr;
  const double yx = sy * cp, yy = sy * sp * sr + cy * cr, yz = sy * sp * cr - cy * sr;
  const double zx = -sp, zy = cp * sr, zz = cp * cr;
  const auto size = [](double four_squares) {
    return static_cast<float>(std::sqrt(std::max(0.0, four_squares)) / 2.0);
  };
  const auto with_sign = [](float value, double sign) { return sign >= 0.0 ? value : -value; };

  OctomapPose pose;
  pose.translation = translation;
  pose.rotation = {size(1 + xx + yy + zz),                      //
                   with_sign(size(1 + xx - yy - zz), zy - yz),  //
                   with_sign(size(1 - xx + yy - zz), xz - zx),  //
                   with_sign(size(1 - xx - yy + zz), yx - xy)};
  return pose;
}

Point3f OctomapPose::transform(const Point3f& point) const {
  return sum(rotate(rotation, point), translation);
}

Point3f OctomapPose::ray_origin() const {
  OctomapPose inverse;
  inverse.rotation = normalize(conjugate(rotation));
  inverse.translation = rotate(inverse.rotation, {-translation[0], -translation[1], -translation[2]});
  return transform(inverse.transform(translation));
}

}  // namespace pingvox
