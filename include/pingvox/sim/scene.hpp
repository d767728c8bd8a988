#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>

#include "pingvox/geometry/mesh.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sim/tank.hpp"
#include "pingvox/sim/vehicle.hpp"
#include "pingvox/sim/world.hpp"

namespace pingvox {

/// Motion of the vehicle in a scene.
enum class Motion {
  kStill,      ///< at the origin of the map frame, heading along x
  kLine,       ///< straight through the scene, once
  kLawnMower,  ///< parallel lanes, to and fro
  kLoop,       ///< closed loop, repeated
  kByHand,     ///< the closed loop, once, driven by hand
};

/// A world, its water and collision-free routes. The origin of the map frame is in the water, and z = 0 is the depth of
/// the routes.
struct Scene {
  World world;
  Eigen::AlignedBox3d water_m;  ///< the water is the part of this box that surfaces do not cut off from the vehicle
  Route line, lawn_mower, loop;
  double sonar_range_m = 5.0;  ///< recommended range of the sonar
  double beams_per_s = 23.0;   ///< recommended rate of the sonar
  double cell_m = 0.05;        ///< recommended edge length of a cell of its map

  /// nullptr for kStill.
  const Route* route(Motion motion) const;
};

/// REQUIRES valid options.
Scene tank_scene(const TankOptions& options);

/// Three quay walls around a basin that is open to the right, a muddy bottom, a row of piles, and a ship's hull at the
/// left wall.
struct HarbourOptions {
  double length_m = 20.0;       ///< along x, 16..200
  double width_m = 14.0;        ///< along y, 12..200
  double water_above_m = 2.0;   ///< above the vehicle, 0.5..50
  double water_below_m = 3.0;   ///< below the vehicle, 0.5..50
  std::size_t piles = 4;        ///< 0..6
  double pile_radius_m = 0.25;  ///< > 0, at most 0.5
  double hull_length_m = 8.0;   ///< >= 0, less than half the length; 0: none
  double hull_beam_m = 2.4;     ///< > 0, at most 3
  double hull_draught_m = 2.5;  ///< > 0, at most all the water

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};
/// REQUIRES valid options.
Scene harbour_scene(const HarbourOptions& options);

/// Canals and basins of 400 x 300 m between quays, with moored hulls and piles, as in the marina of the recording in
/// docs/slam-figures.md: for a sonar with a long range. Its loop of 600 m goes around two islands.
struct MarinaOptions {
  double water_above_m = 1.5;  ///< above the vehicle, 0.5..50
  double water_below_m = 4.0;  ///< below the vehicle, 0.5..50

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};
/// REQUIRES valid options.
Scene marina_scene(const MarinaOptions& options);

/// A bottom that rises to the left, with ripples and boulders, some of which reach up to the vehicle's depth.
struct SeabedOptions {
  double side_m = 24.0;       ///< of the square, 20..200
  double depth_m = 1.8;       ///< of the bottom below the vehicle at the origin, 1.5..50
  double slope = 0.05;        ///< rise over run, -0.1..0.1
  double ripples = 1.0;       ///< 0: smooth; at most 2
  std::size_t boulders = 40;  ///< besides six tall ones; at most 1000

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};
/// REQUIRES valid options.
Scene seabed_scene(const SeabedOptions& options);

/// A winding tunnel with bumps, closed at both ends.
struct CaveOptions {
  double length_m = 18.0;  ///< 10..500
  double radius_m = 2.2;   ///< 1.5..50
  double bumps = 0.15;     ///< fraction of the radius, 0..0.3

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};
/// REQUIRES valid options.
Scene cave_scene(const CaveOptions& options);

/// Any mesh, in the coordinates of its file. The routes go along, over and around its bounding box; to go inside, use a
/// trajectory of your own.
/// @return kBadOption without triangles, or when it is larger than 10 km (not in metres?)
Result<Scene> mesh_scene(TriangleMesh mesh);

}  // namespace pingvox
