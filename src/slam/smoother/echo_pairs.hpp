#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pingvox/geometry/pose2.hpp"
#include "slam/smoother/map_walls.hpp"
#include "slam/smoother/slam_problem.hpp"

/// Echoes on the ground, and pairs of them.
namespace pingvox {

/// Where an echo is with the present unknowns.
struct EchoOnGround {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Vector2d bulge = Eigen::Vector2d::Zero();   ///< of the way of the vehicle, see SlamProblem::bulge
  Eigen::Vector2d arm = Eigen::Vector2d::Zero();     ///< from the velocity's source to the wall
  Eigen::Vector2d ray = Eigen::Vector2d::Zero();     ///< the beam's direction
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();  ///< of the wall; zero where the echoes around form no line
};

/// Normal of the line through points; zero if they are no line. REQUIRES a point.
Eigen::Vector2d normal_of(std::span<const Eigen::Vector2d> points);

/// The body's yaw at an echo.
double yaw_of(const PlacedEcho& echo, const Unknowns& unknowns);

EchoOnGround place_echo(const SlamProblem& problem, const Pose2& mount, const Unknowns& unknowns,
                        const std::vector<SlamProblem::Way>& ways, const PlacedEcho& echo);

/// Places all echoes, and fits the wall's line at each: through the five nearest of its sweep within five metres.
/// @param sweeps  where the echoes of each sweep begin, and the end of the last
std::vector<EchoOnGround> place_echoes(const SlamProblem& problem, const Pose2& mount, const Unknowns& unknowns,
                                       const std::vector<SlamProblem::Way>& ways, std::span<const PlacedEcho> echoes,
                                       std::span<const std::size_t> sweeps);

struct EchoPair {
  std::uint32_t a = 0, b = 0;                        ///< echoes
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();  ///< of the wall, mean of both
  double distance_m = 0.0;                           ///< from b to a along the normal
  double weight = 0.0;                               ///< of its square: one over the variance, less for outliers
};

struct PairOptions {
  std::uint64_t seed = 1;
  double gate_m = 10.0;
  double scale = 1.0;  ///< of the noise of an echo's place and of the reach of far partners
};

/// Sweeps farther apart in the log than this are partners where they are near in place: so many of them, and so near.
inline constexpr std::size_t kFar = 12, kFarPartners = 10;
inline constexpr double kFarReach_m = 35.0;
/// Sweeps before a sweep that are its partners in any case are no farther back than this.
inline constexpr std::size_t kFarthestNear = 8;
/// The far partners of a sweep are those of the lowest numbers: the same for both, and in each iteration.
std::uint64_t partner_rank(std::uint64_t seed, std::size_t sweep, std::size_t other);

struct EchoPairs {
  std::vector<EchoPair> pairs;
  std::size_t loops_found = 0, loops_kept = 0;  ///< see SlamReport
};

/// An echo and a wall of a known map.
struct WallMatch {
  std::uint32_t echo = 0;
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();
  double distance_m = 0.0;  ///< from the wall to the echo along the normal
  double weight = 0.0;      ///< of its square, as that of a pair
};
std::vector<WallMatch> match_walls(std::span<const PlacedEcho> echoes, std::span<const EchoOnGround> ground,
                                   const MapWalls& walls, double gate_m);

/// Which sweep of the log it is, and where the vehicle was in its middle.
struct SweepPlace {
  std::size_t number = 0;
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
  bool is_held = false;
};

/// Pairs of each echo of a sweep that is not fixed with the nearest of other sweeps: of those before and after its own,
/// and of some of those that are near in place only.
/// @param places  of each sweep, in rising order of their numbers
EchoPairs echo_pairs(std::span<const PlacedEcho> echoes, std::span<const EchoOnGround> ground,
                     std::span<const std::size_t> sweeps, std::span<const SweepPlace> places,
                     const PairOptions& options);

/// How a place along a normal depends on the knots around an echo, and on the globals from kWall to kSonarY. The bulge
/// is fixed, and the knots of an echo that is.
struct EchoRow {
  Eigen::Matrix<double, 6, 1> by_knots = Eigen::Matrix<double, 6, 1>::Zero();  ///< the one before, the one after
  Eigen::Vector3d by_globals = Eigen::Vector3d::Zero();
};
EchoRow echo_row(const PlacedEcho& echo, const EchoOnGround& ground, const Unknowns& unknowns,
                 const Eigen::Vector2d& normal);

/// Distance of a pair along its normal, and its derivatives by the knots around both echoes and by the globals from
/// kWall to kSonarY. The normal turns with the yaw; the bulges are fixed, and the knots of echoes that are.
struct PairRow {
  double distance_m = 0.0;
  Eigen::Matrix<double, 15, 1> by = Eigen::Matrix<double, 15, 1>::Zero();  ///< a, after a, b, after b, globals
};
PairRow pair_row(const PlacedEcho& a, const EchoOnGround& ground_a, const PlacedEcho& b, const EchoOnGround& ground_b,
                 const Unknowns& unknowns, const EchoPair& pair);

}  // namespace pingvox
