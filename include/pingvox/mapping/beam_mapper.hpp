#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/changed_pages.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Maps beams as they arrive from a live device, or from a log (build_map). A beam's echo depends on its neighbours, so
/// the beam is mapped with a delay:
///
/// - Timing::kBySweep: with its sweep, when the first beam of the next one arrives.
/// - Timing::kByBeam: after delay_beams() more of its sweep. The first and the last delay_beams() of a sweep are mapped
///   at its end: only then is it known whether they are neighbours, as in a full turn.
///
/// Between two calls the map may be read: its parents are up to date and it is pruned.
class BeamMapper {
 public:
  /// @param map    has to outlive the mapper
  /// @param count  whether `coverage` is wanted: it takes some memory for each place, 40 MB at most
  /// @return kBadOption when the options do not validate, kNoMemory when memory ran out
  static Result<BeamMapper> make(const BuildOptions& options, OccupancyMap& map, CountSweeps count = CountSweeps::kNo);
  BeamMapper(BeamMapper&&) noexcept;
  BeamMapper& operator=(BeamMapper&&) noexcept;
  ~BeamMapper();

  /// Takes the next beam, which must be valid, and maps those that are due.
  /// @param map_from_body  pose of the vehicle at its time; nullopt: not known. Such a beam is left out and
  ///        counted, but still used for the echoes of its neighbours.
  /// @return kLimit when the map would grow too large, or each of the first beams, kNoMemory when memory ran out. The
  ///         map keeps the beams before; the waiting ones are lost, and the next one begins a new sweep.
  Result<void> add(Beam beam, const std::optional<Pose>& map_from_body);

  /// Maps the beams that still wait. The next one begins a new sweep. @return as for `add`
  Result<void> finish();

  /// Notes changes of the map from now on. nullptr: no longer.
  void track(ChangedPages* changes);

  /// Report of the beams so far, without those that wait.
  const BuildReport& report() const;

  /// Coverage by the complete sweeps so far; empty without CountSweeps::kYes.
  SweepCoverage coverage() const;

  /// Number of later beams of its sweep that a beam waits for; nullopt: for the end of its sweep.
  std::optional<std::size_t> delay_beams() const;

 private:
  class Stages;
  explicit BeamMapper(std::unique_ptr<Stages> stages);
  std::unique_ptr<Stages> stages_;
};

}  // namespace pingvox
