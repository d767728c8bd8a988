#include "pingvox/sim/world.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace pingvox {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

// --- Crossings: each function calls `found(range, normal)` for all of them; the caller applies the limits.

template <class Found>
void cross(const Rectangle& r, const SoundRay& ray, const Found& found) {
  const Vector3d normal = r.half_u_m.cross(r.half_v_m).normalized();
  const double approach = ray.direction.dot(normal);
  if (approach == 0.0) return;
  const double range = (r.centre_m - ray.origin_m).dot(normal) / approach;
  const Vector3d off = ray.at(range) - r.centre_m;
  if (std::abs(off.dot(r.half_u_m)) > r.half_u_m.squaredNorm()) return;
  if (std::abs(off.dot(r.half_v_m)) > r.half_v_m.squaredNorm()) return;
  found(range, normal);
}

template <class Found>
void cross(const Cuboid& c, const SoundRay& ray, const Found& found) {
  // Slab method in the frame of the box.
  const Pose cuboid_from_map = c.map_from_cuboid.inverse();
  const Vector3d origin = cuboid_from_map * ray.origin_m;
  const Vector3d direction = cuboid_from_map.linear() * ray.direction;
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();
  Eigen::Index enter_axis = 0;
  Eigen::Index leave_axis = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (std::abs(origin[axis]) > c.half_m[axis]) return;
      continue;
    }
    const double side = std::copysign(c.half_m[axis], direction[axis]);
    const double from = (-side - origin[axis]) / direction[axis];
    const double to = (side - origin[axis]) / direction[axis];
    if (from > enter) {
      enter = from;
      enter_axis = axis;
    }
    if (to < leave) {
      leave = to;
      leave_axis = axis;
    }
  }
  if (enter > leave) return;
  found(enter, Vector3d(c.map_from_cuboid.linear().col(enter_axis)));
  found(leave, Vector3d(c.map_from_cuboid.linear().col(leave_axis)));
}

/// Intersections of a ray and the unit sphere (or circle): |origin + range * direction| = 1.
std::optional<std::array<double, 2>> unit_crossings(double dd, double od, double oo) {
  const double discriminant = od * od - dd * (oo - 1.0);
  if (dd == 0.0 || discriminant < 0.0) return std::nullopt;
  const double root = std::sqrt(discriminant);
  return std::array{(-od - root) / dd, (-od + root) / dd};
}

template <class Found>
void cross(const Cylinder& c, const SoundRay& ray, const Found& found) {
  const double height = c.axis_m.norm();
  const Vector3d up = c.axis_m / height;
  const Vector3d from_base = ray.origin_m - c.base_m;
  const double climb = ray.direction.dot(up);
  const double start = from_base.dot(up);
  const Vector3d d = (ray.direction - climb * up) / c.radius_m;
  const Vector3d o = (from_base - start * up) / c.radius_m;
  if (const auto ranges = unit_crossings(d.squaredNorm(), o.dot(d), o.squaredNorm())) {
    for (const double range : *ranges) {
      const double level = start + range * climb;
      if (level >= 0.0 && level <= height) found(range, Vector3d((o + range * d).normalized()));
    }
  }
  if (climb == 0.0) return;
  for (const double level : {0.0, height}) {
    const double range = (level - start) / climb;
    if ((o + range * d).squaredNorm() < 1.0) found(range, up);
  }
}

template <class Found>
void cross(const Sphere& s, const SoundRay& ray, const Found& found) {
  const Vector3d o = (ray.origin_m - s.centre_m) / s.radius_m;
  const Vector3d d = ray.direction / s.radius_m;
  if (const auto ranges = unit_crossings(d.squaredNorm(), o.dot(d), o.squaredNorm())) {
    for (const double range : *ranges) found(range, Vector3d((o + range * d).normalized()));
  }
}

template <class Found>
void cross(const Ellipsoid& e, const SoundRay& ray, const Found& found) {
  const Pose ellipsoid_from_map = e.map_from_ellipsoid.inverse();
  const Vector3d o = (ellipsoid_from_map * ray.origin_m).cwiseQuotient(e.radii_m);
  const Vector3d d = (ellipsoid_from_map.linear() * ray.direction).cwiseQuotient(e.radii_m);
  if (const auto ranges = unit_crossings(d.squaredNorm(), o.dot(d), o.squaredNorm())) {
    for (const double range : *ranges) {
      const Vector3d gradient = (o + range * d).cwiseQuotient(e.radii_m);
      found(range, Vector3d(e.map_from_ellipsoid.linear() * gradient.normalized()));
    }
  }
}

/// Crossings of any solid with kMinRange_m < range <= limit_m.
template <class Solid, class Found>
void cross_any(const Solid& solid, const SoundRay& ray, double& limit_m, const Found& found) {
  std::visit(
      [&](const auto& s) {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, std::shared_ptr<const TriangleTree>>) {
          s->cross(ray, limit_m, found);
        } else {
          cross(s, ray, [&](double range, const Vector3d& normal) {
            if (range > kMinRange_m && range <= limit_m) found(range, normal, limit_m);
          });
        }
      },
      solid);
}

Vector3d against(const SoundRay& ray, const Vector3d& normal) {
  return normal.dot(ray.direction) > 0.0 ? Vector3d(-normal) : normal;
}

// --- Triangles.

std::uint32_t index_of(std::size_t n) {
  return static_cast<std::uint32_t>(n);
}

void append(const TriangleMesh& part, TriangleMesh& mesh) {
  const std::uint32_t base = index_of(mesh.vertices_m.size());
  mesh.vertices_m.insert(mesh.vertices_m.end(), part.vertices_m.begin(), part.vertices_m.end());
  for (const auto& [a, b, c] : part.triangles) mesh.triangles.push_back({base + a, base + b, base + c});
}

/// Number of segments of a circle whose chords stay within `tolerance` of it.
std::size_t pieces_of(double radius, double tolerance) {
  const double share = std::min(1.0, tolerance / radius);
  const double pieces = std::ceil(std::numbers::pi / std::acos(1.0 - share));
  return static_cast<std::size_t>(std::clamp(pieces, 8.0, 512.0));
}

/// A grid of vertices, `columns` to a row, as triangles.
TriangleMesh grid(std::vector<Vector3d> vertices, std::size_t columns) {
  TriangleMesh mesh{std::move(vertices), {}};
  const std::size_t rows = mesh.vertices_m.size() / columns;
  for (std::size_t row = 0; row + 1 < rows; ++row) {
    for (std::size_t column = 0; column + 1 < columns; ++column) {
      const std::uint32_t a = index_of(row * columns + column);
      const std::uint32_t above = a + index_of(columns);
      mesh.triangles.push_back({a, a + 1, above});
      mesh.triangles.push_back({a + 1, above + 1, above});
    }
  }
  return mesh;
}

TriangleMesh mesh_of(const Rectangle& r, double) {
  return grid({r.centre_m - r.half_u_m - r.half_v_m, r.centre_m + r.half_u_m - r.half_v_m,
               r.centre_m - r.half_u_m + r.half_v_m, r.centre_m + r.half_u_m + r.half_v_m},
              2);
}

TriangleMesh mesh_of(const Cuboid& c, double tolerance) {
  TriangleMesh mesh;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto half = [&](Eigen::Index which) {
      return Vector3d(c.map_from_cuboid.linear().col(which % 3) * c.half_m[which % 3]);
    };
    for (const double side : {-1.0, 1.0}) {
      append(mesh_of(Rectangle{c.map_from_cuboid.translation() + side * half(axis), half(axis + 1), half(axis + 2)},
                     tolerance),
             mesh);
    }
  }
  return mesh;
}

TriangleMesh mesh_of(const Cylinder& c, double tolerance) {
  const Vector3d u = c.axis_m.unitOrthogonal() * c.radius_m;
  const Vector3d v = c.axis_m.normalized().cross(u);
  const std::size_t pieces = pieces_of(c.radius_m, tolerance);
  // Four rings, two of them degenerate at the centre of an end.
  std::vector<Vector3d> vertices;
  for (const auto& [along, radius] : {std::pair{0.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}, {1.0, 0.0}}) {
    for (std::size_t i = 0; i <= pieces; ++i) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(pieces);
      vertices.emplace_back(c.base_m + along * c.axis_m + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
  }
  return grid(std::move(vertices), pieces + 1);
}

TriangleMesh mesh_of(const Ellipsoid& e, double tolerance) {
  // Half of the tolerance for each of the two curved directions.
  const std::size_t pieces = pieces_of(e.radii_m.maxCoeff(), 0.5 * tolerance);
  const std::size_t rows = pieces / 2;
  std::vector<Vector3d> vertices;
  for (std::size_t row = 0; row <= rows; ++row) {
    const double polar = std::numbers::pi * static_cast<double>(row) / static_cast<double>(rows);
    for (std::size_t i = 0; i <= pieces; ++i) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(pieces);
      const Vector3d unit(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar));
      vertices.emplace_back(e.map_from_ellipsoid * unit.cwiseProduct(e.radii_m));
    }
  }
  return grid(std::move(vertices), pieces + 1);
}

TriangleMesh mesh_of(const Sphere& s, double tolerance) {
  return mesh_of(Ellipsoid{Pose(Eigen::Translation3d(s.centre_m)), Vector3d::Constant(s.radius_m)}, tolerance);
}

TriangleMesh mesh_of(const std::shared_ptr<const TriangleTree>& tree, double) {
  return tree->mesh();
}

/// Bounding box of a shape.
AlignedBox3d bounds_of(const Sphere& s) {
  return {s.centre_m - Vector3d::Constant(s.radius_m), s.centre_m + Vector3d::Constant(s.radius_m)};
}
AlignedBox3d rotate(const Pose& pose, const Vector3d& half) {
  const Vector3d reach = pose.linear().cwiseAbs() * half;
  return {pose.translation() - reach, pose.translation() + reach};
}
AlignedBox3d bounds_of(const Cuboid& c) {
  return rotate(c.map_from_cuboid, c.half_m);
}
AlignedBox3d bounds_of(const Ellipsoid& e) {
  return rotate(e.map_from_ellipsoid, e.radii_m);
}
AlignedBox3d bounds_of(const Rectangle& r) {
  const Vector3d reach = r.half_u_m.cwiseAbs() + r.half_v_m.cwiseAbs();
  return {r.centre_m - reach, r.centre_m + reach};
}
AlignedBox3d bounds_of(const Cylinder& c) {
  const Vector3d top = c.base_m + c.axis_m;
  const Vector3d reach = Vector3d::Constant(c.radius_m);
  return AlignedBox3d(c.base_m - reach, c.base_m + reach).merged(AlignedBox3d(top - reach, top + reach));
}
AlignedBox3d bounds_of(const std::shared_ptr<const TriangleTree>& tree) {
  return tree->bounds();
}

}  // namespace

TriangleMesh heightfield(const std::vector<double>& heights_m, std::size_t columns, const Vector3d& corner_m,
                         double step_m) {
  assert(columns >= 2 && heights_m.size() >= 2 * columns && heights_m.size() % columns == 0);
  std::vector<Vector3d> vertices;
  vertices.reserve(heights_m.size());
  for (std::size_t i = 0; i < heights_m.size(); ++i) {
    const std::size_t row = i / columns;
    vertices.emplace_back(corner_m + Vector3d(static_cast<double>(i % columns) * step_m,
                                              static_cast<double>(row) * step_m, heights_m[i]));
  }
  return grid(std::move(vertices), columns);
}

void World::add(Shape shape, const Material& material) {
  Solid solid = std::visit(
      [](auto&& s) -> Solid {
        using S = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<S, TriangleMesh>) {
          return std::make_shared<const TriangleTree>(std::forward<decltype(s)>(s));
        } else {
          return std::forward<decltype(s)>(s);
        }
      },
      std::move(shape));
  AlignedBox3d bounds = std::visit([](const auto& s) { return bounds_of(s); }, solid);
  // Padded, so that rounding does not put a flat surface outside of its box.
  bounds.min().array() -= 1e-9;
  bounds.max().array() += 1e-9;
  surfaces_.push_back({std::move(solid), material, bounds});
}

std::optional<Crossing> World::first(const SoundRay& ray, double limit_m) const {
  const Eigen::Array3d inverse = ray.direction.array().inverse();
  std::optional<Crossing> nearest;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    if (!intersects(ray, inverse, surfaces_[i].bounds, limit_m)) continue;
    cross_any(surfaces_[i].solid, ray, limit_m, [&](double range, const Vector3d& normal, double& limit) {
      limit = range;
      nearest = Crossing{range, against(ray, normal), i};
    });
  }
  return nearest;
}

std::vector<Crossing> World::all(const SoundRay& ray, double limit_m) const {
  const Eigen::Array3d inverse = ray.direction.array().inverse();
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    if (!intersects(ray, inverse, surfaces_[i].bounds, limit_m)) continue;
    cross_any(surfaces_[i].solid, ray, limit_m, [&](double range, const Vector3d& normal, double&) {
      crossings.push_back({range, against(ray, normal), i});
    });
  }
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& a, const Crossing& b) { return a.range_m < b.range_m; });
  return crossings;
}

World World::near(const Vector3d& point_m, double limit_m) const {
  World part;
  for (const Surface& surface : surfaces_) {
    if (surface.bounds.exteriorDistance(point_m) <= limit_m) part.surfaces_.push_back(surface);
  }
  return part;
}

TriangleMesh World::mesh(double tolerance_m) const {
  assert(tolerance_m > 0.0);
  TriangleMesh mesh;
  for (const Surface& surface : surfaces_) {
    append(std::visit([&](const auto& s) { return mesh_of(s, tolerance_m); }, surface.solid), mesh);
  }
  return mesh;
}

AlignedBox3d World::bounds() const {
  AlignedBox3d box;
  for (const Surface& surface : surfaces_) box.extend(surface.bounds);
  return box;
}

}  // namespace pingvox
