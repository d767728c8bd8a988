#include "pingvox/sim/triangle_tree.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace pingvox {
namespace {

constexpr std::uint32_t kMaxInLeaf = 4;
/// Tolerance at shared edges, so that no ray passes between two triangles.
constexpr double kEdge = 1e-9;

}  // namespace

bool intersects(const SoundRay& ray, const Eigen::Array3d& inverse, const Eigen::AlignedBox3d& box, double limit_m) {
  double from = 0.0;
  double to = limit_m;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double a = (box.min()[axis] - ray.origin_m[axis]) * inverse[axis];
    const double b = (box.max()[axis] - ray.origin_m[axis]) * inverse[axis];
    // A ray in the plane of a face gives NaN: std::max and std::min then keep their first argument.
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to;
}

Eigen::AlignedBox3d TriangleTree::box_of(std::size_t triangle) const {
  Eigen::AlignedBox3d box;
  for (const std::uint32_t corner : mesh_.triangles[triangle]) box.extend(mesh_.vertices_m[corner]);
  return box;
}

TriangleTree::TriangleTree(TriangleMesh mesh) : mesh_(std::move(mesh)) {
  struct Part {
    std::size_t node;
    std::uint32_t first, count;
  };
  const auto centre = [this](const std::array<std::uint32_t, 3>& t, Eigen::Index axis) {
    return mesh_.vertices_m[t[0]][axis] + mesh_.vertices_m[t[1]][axis] + mesh_.vertices_m[t[2]][axis];
  };
  nodes_.emplace_back();
  std::vector<Part> parts = {{0, 0, static_cast<std::uint32_t>(mesh_.triangles.size())}};
  while (!parts.empty()) {
    const Part part = parts.back();
    parts.pop_back();
    Node node{.box = {}, .first = part.first, .count = part.count};
    for (std::uint32_t i = 0; i < part.count; ++i) node.box.extend(box_of(part.first + i));
    if (part.count > kMaxInLeaf) {
      Eigen::Index axis = 0;
      node.box.sizes().maxCoeff(&axis);
      const auto first = mesh_.triangles.begin() + part.first;
      const std::uint32_t half = part.count / 2;
      std::nth_element(first, first + half, first + part.count,
                       [&](const auto& a, const auto& b) { return centre(a, axis) < centre(b, axis); });
      node.first = static_cast<std::uint32_t>(nodes_.size());
      node.count = 0;
      parts.push_back({nodes_.size(), part.first, half});
      parts.push_back({nodes_.size() + 1, part.first + half, part.count - half});
      nodes_.resize(nodes_.size() + 2);
    }
    // Count rays in the plane of a face as inside.
    node.box.min().array() -= kEdge;
    node.box.max().array() += kEdge;
    nodes_[part.node] = node;
  }
}

void TriangleTree::cross(const SoundRay& ray, double& limit_m, const Found& found) const {
  const Eigen::Array3d inverse = ray.direction.array().inverse();
  // At most 32 levels, as each halves up to 2^32 triangles, with one waiting sibling on each.
  std::array<std::uint32_t, 64> waiting{};
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const Node& node = nodes_[waiting[--count]];
    if (!intersects(ray, inverse, node.box, limit_m)) continue;
    if (node.count == 0) {
      assert(count + 2 <= waiting.size());
      waiting[count++] = node.first;
      waiting[count++] = node.first + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      // Moeller and Trumbore 1997.
      const auto& [a, b, c] = mesh_.triangles[i];
      const Eigen::Vector3d ab = mesh_.vertices_m[b] - mesh_.vertices_m[a];
      const Eigen::Vector3d ac = mesh_.vertices_m[c] - mesh_.vertices_m[a];
      const Eigen::Vector3d p = ray.direction.cross(ac);
      const double determinant = ab.dot(p);
      if (determinant == 0.0) continue;
      const Eigen::Vector3d from_a = ray.origin_m - mesh_.vertices_m[a];
      const double u = from_a.dot(p) / determinant;
      const Eigen::Vector3d q = from_a.cross(ab);
      const double v = ray.direction.dot(q) / determinant;
      if (!(u >= -kEdge && v >= -kEdge && u + v <= 1.0 + kEdge)) continue;
      const double range = ac.dot(q) / determinant;
      if (range > kMinRange_m && range <= limit_m) found(range, ab.cross(ac).normalized(), limit_m);
    }
  }
}

}  // namespace pingvox
