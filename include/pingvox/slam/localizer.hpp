#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/distance_field.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"

namespace pingvox {

/// How likely an echo or the lack of one is, as a ratio to an echo from an occupied cell (docs/locate.md).
struct BeamLikelihood {
  double range_deviation_m = 0.05;                   ///< of an echo from a cell of the map, along the beam
  double bearing_deviation_rad = 0.6 * kDegree_rad;  ///< of the direction that it came from
  double stray = 0.1;         ///< an echo where the map is free: clutter, or what is not in the map
  double unknown = 0.3;       ///< an echo where the map is unknown
  double behind = 0.05;       ///< an echo from behind an occupied cell
  double silent_wall = 0.4;   ///< no echo, though an occupied cell is in range; one where none is has 1
  double beam_weight = 0.25;  ///< power of each beam's likelihood: beams overlap, and err together

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Standard deviations of a motion: of each coordinate and of the yaw, over time and over the way.
struct MotionNoise {
  double position_m_per_sqrt_s = 0.02, position_m_per_sqrt_m = 0.05;
  double yaw_rad_per_sqrt_s = 0.3 * kDegree_rad, yaw_rad_per_sqrt_rad = 0.02;

  /// Of a vehicle with unknown motion that moves little.
  static MotionNoise random_walk() { return {0.05, 0.0, kDegree_rad, 0.0}; }
  /// Of one whose heading is known, but not its displacement.
  static MotionNoise turns_only() { return {0.15, 0.0, 0.3 * kDegree_rad, 0.02}; }

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

struct LocalizerOptions {
  std::uint64_t seed = 1;  ///< equal seeds give equal results
  Pose body_from_sonar = Pose::Identity();
  FilterOptions filter;
  EchoOptions echo;
  double sound_speed_ratio = 1.0;  ///< true speed of sound over the one that the ranges assume, > 0
  BeamLikelihood beam;
  MotionNoise noise;                                 ///< of the odometry
  MotionNoise without = MotionNoise::random_walk();  ///< where there is no odometry
  std::size_t min_particles = 400,
              max_particles = 4000;  ///< 10..1,000,000; in between, as many as KLD sampling asks for

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Where a vehicle may be, in the map frame.
struct PoseHypothesis {
  double x_m = 0.0, y_m = 0.0, yaw_rad = 0.0;  ///< mean
  double deviation_m = 0.0;                    ///< root of the mean square distance from the mean
  double deviation_rad = 0.0;
  double weight = 1.0;  ///< probability, as far as the model holds
};

/// Where a vehicle is in a map that is known, by the beams of a scanning sonar: Monte Carlo localisation (Thrun et al.
/// 2005, chapter 8) in x, y and yaw. Height, roll and pitch are the odometry's.
///
///     Localizer localizer(*DistanceField::make(map, {}), {});
///     for (const Beam& beam : beams) {
///       localizer.add(odometry_at(beam.time_s));  // where there is any
///       localizer.add(beam);
///       if (const auto pose = localizer.pose()) use(*pose, localizer.is_sure());
///     }
class Localizer {
 public:
  /// Least weight of a hypothesis that counts as the only one.
  static constexpr double kSureWeight = 0.95;

  /// A pose in the map and its certainty.
  struct Located {
    double time_s = 0.0;  ///< of the last beam
    Pose map_from_body = Pose::Identity();
    double deviation_m = 0.0, deviation_rad = 0.0;
  };

  /// REQUIRES valid options.
  Localizer(DistanceField field, const LocalizerOptions& options);
  ~Localizer();
  Localizer(Localizer&&) noexcept;
  Localizer& operator=(Localizer&&) noexcept;

  /// Begins near a pose; deviations are of x, of y, and of the yaw. Without it, the vehicle may be anywhere: it is
  /// searched for when the head has turned once. REQUIRES finite numbers, deviations >= 0.
  void start(double x_m, double y_m, double yaw_rad, double deviation_m, double deviation_rad);
  /// Where the vehicle is in a frame that may drift; from one to the next the vehicle moved. A gap between them (no
  /// call before a beam) counts as time without odometry. REQUIRES a finite pose.
  void add(const StampedPose& odometry_from_body);
  /// Takes the next beam, which must be valid.
  /// @return kCorrupt when its time is before that of the last one
  Result<void> add(Beam beam);
  /// The recording is over: what is held back is used, and if nothing has been found yet the search is made with what
  /// there is.
  void finish();

  /// nullopt: not found yet.
  std::optional<Located> pose() const;
  /// Whether there is one hypothesis alone, within 0.3 m and 5 degrees, that the last turn of the head agrees with, and
  /// that two turns, each searched for itself, have led to, the second to no other place that is more than a fifth as
  /// likely, unless `start` said it.
  bool is_sure() const;
  /// The most likely first; empty: not found yet.
  std::vector<PoseHypothesis> hypotheses() const;
  std::size_t particles() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pingvox
