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

/// A flat piece of wall.
struct Rectangle {
  Eigen::Vector3d centre_m;
  Eigen::Vector3d half_u_m, half_v_m;  ///< from the centre to the middle of two edges; at right angles
};

/// A solid box, turned as its pose says.
struct Cuboid {
  Pose map_from_cuboid;    ///< its frame has its origin in the middle
  Eigen::Vector3d half_m;  ///< half edges, > 0
};

/// A solid cylinder with both its ends.
struct Cylinder {
  Eigen::Vector3d base_m;  ///< the middle of one end
  Eigen::Vector3d axis_m;  ///< from there to the middle of the other; not 0
  double radius_m;         ///< > 0
};

struct Sphere {
  Eigen::Vector3d centre_m;
  double radius_m;  ///< > 0
};

struct Ellipsoid {
  Pose map_from_ellipsoid;  ///< its frame has its origin in the middle
  Eigen::Vector3d radii_m;  ///< > 0
};

/// Heights over a grid in the plane, two triangles a cell: seen by sound as a mesh.
/// @param heights_m  row by row, `columns` to a row; at least two rows and two columns
/// @param corner_m   where the first one stands; its z is added to all
/// @param step_m     from one to the next, along x in a row and along y from row to row
TriangleMesh heightfield(const std::vector<double>& heights_m, std::size_t columns, const Eigen::Vector3d& corner_m,
                         double step_m);

using Shape = std::variant<Rectangle, Cuboid, Cylinder, Sphere, Ellipsoid, TriangleMesh>;

/// What a surface does to sound. Powers are relative to what a wall of `scatter` 1 sends back at a right angle.
struct Material {
  double scatter = 1.0;  ///< power that comes back diffusely; falls with the cosine of the angle of incidence (Lambert)
  double glint = 0.5;    ///< power added where sound meets the surface at a right angle; gone at some 20 degrees
  double mirror = 0.3;   ///< share of the amplitude that goes on as from a mirror, 0..1
};

/// Where a ray goes through a surface.
struct Crossing {
  double range_m = 0.0;     ///< > kLeastRange_m
  Eigen::Vector3d normal;   ///< of length 1, against the ray
  std::size_t surface = 0;  ///< which one of the world's, in the order in which they were added
};

/// Surfaces in space, in the map frame [m]. It answers two questions: what does a ray meet, and where are the surfaces.
/// Const functions may run in many threads at once.
class World {
 public:
  /// Adds a surface. REQUIRES finite values that keep what the shapes ask for.
  void add(Shape shape, const Material& material = {});

  std::size_t size() const { return surfaces_.size(); }
  const Material& material(std::size_t surface) const { return surfaces_[surface].material; }

  /// What a ray meets first within `limit_m`; nullopt: nothing.
  std::optional<Crossing> first(const SoundRay& ray, double limit_m) const;
  /// All that it goes through within `limit_m`, nearest first.
  std::vector<Crossing> all(const SoundRay& ray, double limit_m) const;

  /// The surfaces as triangles: flat ones as they are, round ones by pieces that stay within `tolerance_m` of them
  /// (but of no more than 512 pieces to a circle). REQUIRES tolerance_m > 0.
  TriangleMesh mesh(double tolerance_m) const;

  /// The smallest box around everything; empty for an empty world.
  Eigen::AlignedBox3d bounds() const;

 private:
  /// A mesh stands behind a pointer: worlds that are copied share it, for it never changes.
  using Solid = std::variant<Rectangle, Cuboid, Cylinder, Sphere, Ellipsoid, std::shared_ptr<const TriangleTree>>;
  struct Surface {
    Solid solid;
    Material material;
    Eigen::AlignedBox3d bounds;
  };
  std::vector<Surface> surfaces_;
};

}  // namespace pingvox
