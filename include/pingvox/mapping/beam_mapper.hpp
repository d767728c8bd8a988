#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Maps beams as they come: a live device's, or a log's (build_map). A beam's echo depends on its neighbours, so it
/// goes into the map later than it came:
///
/// - Timing::kBySweep: with its sweep, when the first beam behind that comes.
/// - Timing::kByBeam: when delay_beams() more of its sweep have come. The first and the last delay_beams() of a sweep
///   come with its end: only then it is known whether they are neighbours, as in a full turn.
///
/// Between two calls the map may be read: its parents are right and it is pruned.
class BeamMapper {
 public:
  /// @param map  has to outlive the mapper
  /// @return kBadOption when the options do not validate, kNoMemory when memory ran out
  static Result<BeamMapper> make(const BuildOptions& options, OccupancyMap& map);
  BeamMapper(BeamMapper&&) noexcept;
  BeamMapper& operator=(BeamMapper&&) noexcept;
  ~BeamMapper();

  /// Takes the next beam, which must be valid, and maps those that are due.
  /// @param map_from_body  where the vehicle was when it was heard; nullopt: not known. Such a beam is left out and
  ///        counted, though what it heard still counts for its neighbours' echoes.
  /// @return kLimit when the map or a beam would grow too large, kNoMemory when memory ran out. The map keeps what it
  ///         had got; the beams that wait are lost, and the next one begins a new sweep.
  Result<void> add(Beam beam, const std::optional<Pose>& map_from_body);

  /// Maps the beams that still wait. The next one begins a new sweep. @return as for `add`
  Result<void> finish();

  /// What became of the beams so far; those that wait are not in it.
  const BuildReport& report() const;

  /// For how many more beams of its sweep one waits; nullopt: for the end of its sweep.
  std::optional<std::size_t> delay_beams() const;

 private:
  class Stages;
  explicit BeamMapper(std::unique_ptr<Stages> stages);
  std::unique_ptr<Stages> stages_;
};

}  // namespace pingvox
