#pragma once

#include <memory>
#include <optional>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/changed_pages.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// A map of beams as they arrive, whose poses may be corrected later, for instance when SLAM closes a loop. It keeps
/// the echo and the pose of each beam (some 200 bytes). A corrected trajectory starts a thread that rebuilds the
/// map; meanwhile beams are added to the old map, and also to the new one before that replaces it. When no correction
/// is running it is, to the bit, the map that a BeamMapper makes of all beams at their last poses. Not thread-safe:
/// its functions must not be called from several threads at once.
class RebuiltMap {
 public:
  /// @return kBadOption when options do not validate, kNoMemory when memory ran out
  static Result<RebuiltMap> make(const BuildOptions& build, const MapOptions& map);
  /// Adds beams to a known map, which is kept to rebuild the new one. @return as `make`
  static Result<RebuiltMap> extend(const BuildOptions& build, OccupancyMap base);
  RebuiltMap(RebuiltMap&&) noexcept;
  RebuiltMap& operator=(RebuiltMap&&) noexcept;
  ~RebuiltMap();  ///< abandons a rebuild

  /// Takes the next beam, which must be valid, and maps those that are due, as BeamMapper::add. Then the rebuilt map,
  /// if one is ready, takes the place of the old one.
  /// @param map_from_body  in the frame of the last corrected trajectory; nullopt: unknown until a trajectory has
  /// it
  /// @return kLimit when a map or a beam would grow too large, kNoMemory when memory ran out. If that was the old map
  ///         or the beam, the beams that wait are lost. If it was the rebuilt one, the old map stays, with the beams
  ///         that it has.
  Result<void> add(Beam beam, const std::optional<Pose>& map_from_body);

  /// Maps the beams that still wait; the next one begins a new sweep. @return as for `add`
  Result<void> finish();

  /// Corrects the trajectory. All beams so far get the pose at their time; those after its end are moved like the last
  /// one before it; others have none. The map is rebuilt in the background, or, if that is under way,
  /// as soon as it is done: of several trajectories that came meanwhile, for the last one. For that time there are two
  /// maps.
  /// @return kNoMemory when memory ran out: poses and map are as before
  Result<void> correct(const Trajectory& map_from_body);

  /// Whether a corrected map is under way.
  bool is_rebuilding() const;

  /// Takes over the rebuilt map if it is ready: between two beams that are far apart. @return as for `add`
  Result<void> update();

  /// Waits until no corrected map is under way any more. @return as for `add`
  Result<void> wait();

  /// Notes from now on what changes in the map; all of it where a rebuilt one takes its place. nullptr: not any more.
  void track(ChangedPages* changes);

  /// The newest complete map. Any other call may change or replace it.
  const OccupancyMap& map() const;

  /// Report of the beams in `map`; `seconds` are those of building it, without detection.
  const BuildReport& report() const;

 private:
  class State;
  explicit RebuiltMap(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pingvox
