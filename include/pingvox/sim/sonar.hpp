#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/random.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sim/world.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

class OptionErrors;

/// A mechanically scanning sonar (docs/simulator.md). Defaults: similar to that of the paper's recording.
struct SonarOptions {
  std::uint64_t seed = 1;  ///< of speckle, noise and dropouts, not of the world

  // The head.
  std::size_t beams_per_turn = 200;             ///< 4..6400; clockwise, starting ahead
  std::size_t bins = 399;                       ///< 1..10,000
  double bin_length_m = 0.0125;                 ///< > 0; also sets the length of the pulse
  double beams_per_s = 23.0;                    ///< > 0
  double beam_width_rad = 3.0 * kDegree_rad;    ///< horizontal, full angle at half power, one way; > 0, at most 1
  double beam_height_rad = 35.0 * kDegree_rad;  ///< vertical, the same; > 0, at most 2
  double side_lobes = 1.0;  ///< amplitude relative to those of a uniform rectangular transducer; 0: none
  double bearing_step_rad = 2.0 * std::numbers::pi / 6400.0;  ///< rounding of the reported bearings; 0: none
  double ringing_m = 0.45;                                    ///< range of the transducer ringing; >= 0
  double gain = 1.0;         ///< time-varied gain: fraction of the transmission loss compensated, 0..1
  double compression = 0.6;  ///< gamma of the 8-bit intensities: 1 linear, less amplifies faint echoes; 0.1..1

  // The water.
  double absorption_db_per_m = 0.2;  ///< one way; 0..10
  double speckle = 0.4;              ///< 0: none; 1: full Rayleigh fading of each bin
  double noise = 1.5;  ///< mean background next to the head in bins of 1.25 cm, as an amplitude (255: the highest that
                       ///< can be shown); the gain raises it; 0..255
  double multipath = 1.0;  ///< fraction of specular reflection that is followed; 0: no second echoes
  double silent = 0.002;   ///< fraction of beams with only ringing and noise (bubbles); 0..1
  double lost = 0.0;       ///< fraction of beams missing from the log; less than 1

  Pose body_from_sensor = Pose::Identity();  ///< the mount: pose of the head on the vehicle

  double range_m() const { return static_cast<double>(bins) * bin_length_m; }
  OptionErrors errors() const;    ///< what is wrong with each field
  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Ground truth: distance to the first surface; nullopt if there is none within the bins.
struct TrueRange {
  std::optional<double> axis_m;  ///< along the axis of the beam
  std::optional<double> cone_m;  ///< smallest within the half-power cone (one way)
};

/// @param bearing_rad  of the beam, sensor frame
/// REQUIRES valid options.
TrueRange true_range(const World& world, const Pose& map_from_sensor, double bearing_rad, const SonarOptions& options);

/// Simulates a scanning sonar in a world. Independent of the beam models and detectors: it sums the returns of all
/// directions of the two-way beam pattern and adds noise. The same options give the same bytes.
class SonarSimulator final : public BeamSource {
 public:
  /// True pose and bearing of the head for one beam.
  struct Ping {
    double time_s = 0.0;
    Pose map_from_sensor = Pose::Identity();
    double bearing_rad = 0.0;  ///< not rounded, in [0, 2 pi)
  };

  /// @param map_from_body    trajectory of the vehicle; the first beam is sent at its first pose
  /// @param turns            of the head; ends earlier with the trajectory
  /// REQUIRES valid options.
  SonarSimulator(World world, Trajectory map_from_body, const SonarOptions& options, std::size_t turns);

  Result<std::optional<Beam>> next() override;

  /// The ping of the last beam from `next`. REQUIRES that there was one.
  const Ping& ping() const { return ping_; }
  const World& world() const { return world_; }

 private:
  /// Cached noise-free beam of one direction, valid while the head stays in place.
  struct Clean {
    Pose map_from_sensor = Pose::Identity();
    std::vector<std::uint32_t> intensities;
  };

  World world_;
  Trajectory map_from_body_;
  SonarOptions options_;
  std::size_t beams_;                      ///< total number
  std::vector<Clean> clean_;               ///< by direction
  std::vector<std::uint32_t> ringing_;     ///< of each bin
  std::vector<std::uint32_t> background_;  ///< mean noise of each bin
  std::vector<std::uint32_t> levels_;      ///< minimum amplitude of each intensity from 1 on
  Random noise_, dropouts_;                ///< separate, so that a dropout does not change the noise of other beams
  std::size_t sent_ = 0;
  Ping ping_;
};

}  // namespace pingvox
