#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/cell_agreement.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/mapping/sweep_coverage.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// How an echo compares with what a map predicts for its beam.
enum class EchoOutcome {
  kPredicted,  ///< the map has something occupied where the echo came from, and nothing before it
  kTooEarly,   ///< the map has something occupied on the axis before it: a false object, or a thick wall
  kFromFree,   ///< the echo came from where the map is free
  kUnknown,    ///< the map does not know the place where the echo came from
};

/// @param first_m  range of what the map has first on the beam's axis; nullopt: nothing
/// @param echo_m   range of the echo
/// @param place    what the map says of where the echo came from, within the tolerance
EchoOutcome outcome_of(const std::optional<double>& first_m, double echo_m, double tolerance_m, Occupancy place);

/// A held-out echo, and its prediction by the map.
struct JudgedEcho {
  double time_s = 0.0, range_m = 0.0;
  std::size_t sweep = 0;
  EchoOutcome outcome = EchoOutcome::kUnknown;
  double error_m = 0.0;  ///< predicted less measured range, of kPredicted
};

struct JudgedEchoes {
  std::vector<JudgedEcho> echoes;    ///< in the order of recording
  std::vector<CellAgreement> cells;  ///< that have been judged, by their keys; empty without CountCells::kYes
};

/// How echoes are judged, and what is changed of how they were heard.
struct HeldOutOptions {
  std::size_t folds = 5;      ///< 2..sweeps; fewer sweeps make fewer folds
  double tolerance_m = 0.1;   ///< between a range and its prediction, > 0
  double nav_offset_s = 0.0;  ///< added to the times of the trajectory
  double range_factor = 1.0;  ///< of all ranges, as of another speed of sound; > 0
  // Added to the mount of the head.
  double mount_x_m = 0.0, mount_y_m = 0.0, mount_yaw_rad = 0.0;
  CountCells cells = CountCells::kNo;
};

/// The echoes of a recording, to predict each of them by a map that is made of other sweeps. Sweeps are dealt into
/// folds in turn: number n into fold n modulo the number of folds.
class HeldOutEchoes {
 public:
  HeldOutEchoes();
  HeldOutEchoes(HeldOutEchoes&&) noexcept;
  HeldOutEchoes& operator=(HeldOutEchoes&&) noexcept;
  ~HeldOutEchoes();

  /// Reads a log to its end and detects its echoes.
  /// @param options  how it is mapped; beams of one sweep are always mapped together
  /// @return kBadOption when the options do not validate, the source's error when it fails, kNoMemory
  Result<void> add(BeamSource& source, const BuildOptions& options);

  std::size_t sweeps() const;
  /// What the sweeps heard along a trajectory. @param cell_m  resolution of the map
  SweepCoverage coverage(const Trajectory& map_from_body, double cell_m) const;

  /// Judges the echoes of beams that have a pose. An echo that is predicted agrees with each occupied cell of its arc
  /// within the tolerance. One that the map has too early contradicts those of the arc that it should have met, one
  /// from free space the cells of its arc: where these are occupied in a map of all sweeps, only its own says so.
  /// @param progress  called with the share that is done
  /// @return errors of mapping, as for BeamMapper
  Result<JudgedEchoes> judge(const Trajectory& map_from_body, const MapOptions& map, const HeldOutOptions& options,
                             const std::function<void(double)>& progress = nullptr) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pingvox
