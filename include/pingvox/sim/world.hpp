#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "pingvox/geometry/mesh.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/sim/triangle_tree.hpp"

namespace pingvox {

/// A flat wall.
struct Rectangle {
  Eigen::Vector3d centre_m;
  Eigen::Vector3d half_u_m, half_v_m;  ///< from the centre to the midpoints of two edges; orthogonal
};

/// A solid, oriented box.
struct Cuboid {
  Pose map_from_cuboid;    ///< origin at the centre
  Eigen::Vector3d half_m;  ///< half edges, > 0
};

/// A solid cylinder with end caps.
struct Cylinder {
  Eigen::Vector3d base_m;  ///< centre of one end
  Eigen::Vector3d axis_m;  ///< to the centre of the other end; not 0
  double radius_m;         ///< > 0
};

struct Sphere {
  Eigen::Vector3d centre_m;
  double radius_m;  ///< > 0
};

struct Ellipsoid {
  Pose map_from_ellipsoid;  ///< origin at the centre
  Eigen::Vector3d radii_m;  ///< > 0
};

/// A height field over a grid as a mesh of two triangles a cell.
/// @param heights_m  row by row, `columns` to a row; at least two rows and two columns
/// @param corner_m   position of the first height; its z is added to all
/// @param step_m     spacing, along x in a row and along y from row to row
TriangleMesh heightfield(const std::vector<double>& heights_m, std::size_t columns, const Eigen::Vector3d& corner_m,
                         double step_m);

using Shape = std::variant<Rectangle, Cuboid, Cylinder, Sphere, Ellipsoid, TriangleMesh>;

/// Acoustic properties of a surface. Powers are relative to the return of a wall of `scatter` 1 at normal incidence.
struct Material {
  double scatter = 1.0;  ///< diffuse return; falls with the cosine of the angle of incidence (Lambert)
  double glint = 0.5;    ///< specular return added at normal incidence; gone at some 20 degrees
  double mirror = 0.3;   ///< fraction of the amplitude that is mirrored onwards, 0..1
};

/// Intersection of a ray and a surface.
struct Crossing {
  double range_m = 0.0;     ///< > kMinRange_m
  Eigen::Vector3d normal;   ///< of length 1, facing the ray
  std::size_t surface = 0;  ///< index of the surface, in the order of add()
};

/// Surfaces in the map frame [m], for ray casting and as a mesh.
/// Const functions may run in many threads at once.
class World {
 public:
  /// Adds a surface. REQUIRES finite values within the limits of the shapes.
  void add(Shape shape, const Material& material = {});

  std::size_t size() const { return surfaces_.size(); }
  const Material& material(std::size_t surface) const { return surfaces_[surface].material; }

  /// First crossing of a ray within `limit_m`; nullopt: none.
  std::optional<Crossing> first(const SoundRay& ray, double limit_m) const;
  /// All crossings within `limit_m`, nearest first.
  std::vector<Crossing> all(const SoundRay& ray, double limit_m) const;

  /// The surfaces with a bounding box within `limit_m` of a point: all that a ray from there may cross in that range.
  World near(const Eigen::Vector3d& point_m, double limit_m) const;

  /// The surfaces as triangles: round ones are approximated to `tolerance_m` (at most 512 segments a circle). REQUIRES
  /// tolerance_m > 0.
  TriangleMesh mesh(double tolerance_m) const;

  /// Bounding box; empty for an empty world.
  Eigen::AlignedBox3d bounds() const;

 private:
  /// Copies of a world share its meshes, which never change.
  using Solid = std::variant<Rectangle, Cuboid, Cylinder, Sphere, Ellipsoid, std::shared_ptr<const TriangleTree>>;
  struct Surface {
    Solid solid;
    Material material;
    Eigen::AlignedBox3d bounds;
  };
  std::vector<Surface> surfaces_;
};

}  // namespace pingvox
