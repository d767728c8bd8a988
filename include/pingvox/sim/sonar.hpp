#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sim/random.hpp"
#include "pingvox/sim/world.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// A turning head in water (docs/simulator.md). Defaults: about that of the paper's recording.
struct SonarOptions {
  std::uint64_t seed = 1;  ///< of speckle, noise and dropouts; what is there does not depend on it

  // The head.
  std::size_t beams_per_turn = 200;                          ///< 4..6400; it turns clockwise, from straight ahead
  std::size_t bins = 399;                                    ///< 1..10,000
  double bin_length_m = 0.0125;                              ///< > 0; the pulse is as long as the bins ask for
  double beams_per_s = 23.0;                                 ///< > 0
  double beam_width_rad = 3.0 * std::numbers::pi / 180.0;    ///< horizontally, to half power, one way; > 0, at most 1
  double beam_height_rad = 35.0 * std::numbers::pi / 180.0;  ///< vertically; > 0, at most 2
  double side_lobes = 1.0;  ///< amplitude, as a share of those of an evenly driven rectangular face; 0: none
  double bearing_step_rad = 2.0 * std::numbers::pi / 6400.0;  ///< to which it rounds reported bearings; 0: it does not
  double ringing_m = 0.45;  ///< the head's own reflection fills the bins up to here; >= 0
  double gain = 1.0;        ///< share of the loss with range that the receiver makes up for, 0..1
  double compression =
      0.6;  ///< exponent by which amplitudes are shown as 8 bits: 1 linear; less brings out the faint; 0.1..1

  // The water.
  double absorption_db_per_m = 0.2;  ///< one way; 0..10
  double speckle = 0.4;              ///< 0: none; 1: full Rayleigh fading of each bin
  double noise = 1.5;  ///< mean background next to the head in bins of 1.25 cm, as an amplitude (255: the highest that
                       ///< can be shown); the gain raises it; 0..255
  double multipath = 1.0;  ///< share of what surfaces mirror that goes on; 0: no second echoes
  double silent = 0.002;   ///< share of beams in which nothing but ringing and noise is heard (bubbles); 0..1
  double lost = 0.0;       ///< share of beams that never arrive in the log; less than 1

  Pose body_from_sensor = Pose::Identity();  ///< the mount: pose of the head on the vehicle

  double range_m() const { return static_cast<double>(bins) * bin_length_m; }
  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// How far it is to the first surface, by geometry alone; nullopt where there is none within the bins.
struct TrueRange {
  std::optional<double> axis_m;  ///< along the middle of the beam
  std::optional<double> cone_m;  ///< the least within the cone of half power (one way) around it
};

/// @param bearing_rad  where the head looked, sensor frame
/// REQUIRES valid options.
TrueRange true_range(const World& world, const Pose& map_from_sensor, double bearing_rad, const SonarOptions& options);

/// The turning head in a world as a source of beams. It knows nothing of beam models or detectors: it adds up what
/// comes back from each direction of the beam pattern, both ways, and lays noise over it. The same options give the
/// same bytes.
class SonarSimulator final : public BeamSource {
 public:
  /// Where the head was when it sent a beam, and where it looked: what a log cannot know.
  struct Ping {
    double time_s = 0.0;
    Pose map_from_sensor = Pose::Identity();
    double bearing_rad = 0.0;  ///< not rounded, in [0, 2 pi)
  };

  /// @param map_from_body    the vehicle's path; the first beam is sent at its first pose
  /// @param turns            of the head; it stops before when the trajectory ends
  /// REQUIRES valid options.
  SonarSimulator(World world, Trajectory map_from_body, const SonarOptions& options, std::size_t turns);

  Result<std::optional<Beam>> next() override;

  /// The ping of the beam that `next` gave last. REQUIRES that there was one.
  const Ping& ping() const { return ping_; }
  const World& world() const { return world_; }

 private:
  /// What one direction sounds like from one place, without noise, kept as long as the head stays there.
  struct Clean {
    Pose map_from_sensor = Pose::Identity();
    std::vector<std::uint32_t> intensities;
  };

  World world_;
  Trajectory map_from_body_;
  SonarOptions options_;
  std::size_t beams_;                      ///< to be sent in all
  std::vector<Clean> clean_;               ///< by direction
  std::vector<std::uint32_t> ringing_;     ///< of each bin
  std::vector<std::uint32_t> background_;  ///< mean noise of each bin
  std::vector<std::uint32_t> levels_;      ///< the least amplitude of each intensity from 1 on
  Random noise_, dropouts_;                ///< apart, so that a dropout does not change the noise of other beams
  std::size_t sent_ = 0;
  Ping ping_;
};

}  // namespace pingvox
