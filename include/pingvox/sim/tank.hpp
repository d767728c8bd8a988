#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// A square tank with vertical walls, a floater (a vertical cylinder) in it, and a turning sonar that stands still.
/// Defaults: about the tank and the head of the paper's recording.
struct TankOptions {
  std::uint64_t seed = 1;  ///< of speckle and noise; the scene does not depend on it
  std::size_t turns = 5;   ///< 1..10,000

  // The scene, in the sensor's frame where not said otherwise.
  double side_m = 4.5;               ///< of the square, > 0
  double sensor_x_m = 0.1;           ///< from the tank's centre along its walls; inside
  double sensor_y_m = -0.45;         ///< the same to the left
  double sensor_yaw_rad = 0.05;      ///< of the sensor in the tank, counter-clockwise
  double floater_bearing_rad = 1.6;  ///< of its axis
  double floater_range_m = 1.8;      ///< of its axis; the sensor is outside of it
  double floater_radius_m = 0.15;    ///< >= 0; 0: no floater

  // The head.
  std::size_t beams_per_turn = 200;   ///< 4..6400; it turns clockwise, from straight ahead
  std::size_t bins = 399;             ///< 1..10,000
  double bin_length_m = 0.0125;       ///< > 0
  double beams_per_s = 23.0;          ///< > 0
  double beam_width_rad = 0.0523599;  ///< horizontally, 3 degrees to half power, one way; > 0, at most 1
  double beam_height_rad = 0.610865;  ///< vertically, 35 degrees; > 0, at most 2
  double ringing_m = 0.45;            ///< the head's own reflection fills the bins up to here; >= 0

  // The water.
  double speckle = 0.25;     ///< 0: none; 1: full Rayleigh fading of each bin
  double noise = 5.0;        ///< mean of the background next to the head [intensity]; it grows with the range (gain)
  double second_echo = 0.3;  ///< share that comes back from the next wall after each mirroring; 0: none; < 1

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Ground truth in closed form: how far the middle of the beam goes until it meets a wall or the floater.
/// REQUIRES valid options.
double true_range_m(const TankOptions& options, double bearing_rad);

/// The sonar in the tank as a source of beams. It knows nothing of beam models or detectors: it adds up what comes back
/// from each direction of the beam pattern, both ways, and lays noise over it. The same options give the same bytes.
class TankSimulator final : public BeamSource {
 public:
  /// REQUIRES valid options.
  explicit TankSimulator(const TankOptions& options);
  Result<std::optional<Beam>> next() override;

 private:
  TankOptions options_;
  std::vector<std::vector<std::uint32_t>> clean_;  ///< what comes back in each direction, without noise
  std::vector<std::uint32_t> background_;          ///< mean noise of each bin
  std::uint64_t random_;                           ///< state of the generator
  std::size_t sent_ = 0;
};

}  // namespace pingvox
