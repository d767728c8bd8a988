#pragma once

#include <optional>
#include <vector>

#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// The beams of one turn of the head, or of one pass over its sector, in the order in which they were heard.
struct Sweep {
  enum class Extent {
    kTurn,    ///< 360 degrees: the last beam is a neighbour of the first
    kSector,  ///< from one end of a sector to the other
    kCut,     ///< the recording ended (or the head's settings changed) before the sweep was complete
  };
  Extent extent = Extent::kCut;
  std::vector<Beam> beams;
};

/// Cuts a stream of beams into sweeps, whatever the head does: full turns either way, sectors to and fro, a changed
/// step, lost and doubled beams, beams of different lengths. A sweep of a turning head is complete when it has turned
/// 360 degrees since its first beam, one of a sector when the head turns back.
class SweepAssembler {
 public:
  /// Takes the next beam. Returns the sweep that this beam showed to be finished, which does not contain it.
  std::optional<Sweep> add(Beam beam);
  /// Returns what has been gathered since the last sweep (nullopt: nothing) and starts anew. A gathered turn counts as
  /// kTurn if the head had turned all the way round, else kCut.
  std::optional<Sweep> finish();

 private:
  Sweep gathered_;
  double turned_rad_ = 0.0;  ///< signed angle from the first gathered beam to the last
};

}  // namespace pingvox
