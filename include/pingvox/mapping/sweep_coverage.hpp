#pragma once

#include <cstddef>

#include "pingvox/sonar/beam_pauses.hpp"

namespace pingvox {

/// Whether a mapper counts what its sweeps heard (SweepCoverage).
enum class CountSweeps { kNo, kYes };

/// How often the sweeps of a recording heard each place, and how far the head moved meanwhile: what a map can be made
/// of. A place is a column of half a metre, or of four cells where that is more; an echo is from all places that its
/// beam is wide.
struct SweepCoverage {
  std::size_t beams = 0, echoes = 0;  ///< of beams with a pose
  std::size_t sweeps = 0;             ///< with such a beam
  std::size_t places = 0;             ///< with an echo
  std::size_t places_heard_once = 0;  ///< of these, those with echoes of one sweep only
  double sweeps_per_place = 0.0;      ///< median
  // Medians of complete sweeps; of all where none is complete.
  double sweep_s = 0.0;       ///< duration
  double moved_m = 0.0;       ///< length of the head's path in a sweep
  double turned_rad = 0.0;    ///< largest angle from the head's attitude at the beginning of a sweep
  double beam_width_m = 0.0;  ///< of the beam at the median range of the echoes
  BeamPauses pauses;          ///< of the beams with a pose

  /// Share of the places that more than one sweep heard; 0 without any.
  double share_heard_again() const {
    return places == 0 ? 0.0 : 1.0 - static_cast<double>(places_heard_once) / static_cast<double>(places);
  }
};

}  // namespace pingvox
