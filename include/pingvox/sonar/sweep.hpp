#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// The beams of one turn of the head, or of one pass over its sector, in the order of recording.
struct Sweep {
  enum class Extent {
    kTurn,    ///< 360 degrees: the last beam is a neighbour of the first
    kSector,  ///< from one end of a sector to the other
    kCut,     ///< not complete: the recording ended, beams were lost over a wide angle, the head's settings changed, or
              ///< a limit of SweepAssembler was reached
  };
  Extent extent = Extent::kCut;
  std::vector<Beam> beams;
};

/// Cuts a stream of beams into sweeps: full turns either way, sectors to and fro, with changed steps, lost and doubled
/// beams, and beams of different lengths.
///
/// - A turn is complete when the head has turned 360 degrees since the sweep's first beam; up to a quarter of a step
///   short of it counts (bearings are rounded, and heads jitter).
/// - A sector is complete when the head turns back by more than a quarter of its step (less is jitter, and no movement
///   at all is a doubled beam), or jumps to the bearing where the pass began (flyback).
/// - Any other jump, of more than 45 degrees and more than four steps, ends the sweep as kCut: beams were lost or the
///   head was given a new sector. Smaller gaps are lost beams inside the sweep.
/// - A bin length that differs from the first beam's by more than 1 % ends it as kCut: one image cannot hold both.
///   Different numbers of bins stay together.
/// - kMaxBeams beams, or an image of kMaxPixels, end it as kCut: a head that stands still must not fill the memory.
class SweepAssembler {
 public:
  /// Twice the beams in a turn of the finest head (1/16 gradian).
  static constexpr std::size_t kMaxBeams = 12'800;
  /// Beams times bins of the longest one; a single longer beam is a sweep of its own.
  static constexpr std::size_t kMaxPixels = std::size_t{1} << 25;

  /// Takes the next beam, which must be valid. Returns the sweep that ended before this beam, if it did.
  std::optional<Sweep> add(Beam beam);
  /// Returns the beams since the last sweep (nullopt: none) and restarts: kTurn if the head has turned all the way
  /// round, its last step included, else kCut.
  std::optional<Sweep> finish();
  /// The beams since the last sweep.
  std::span<const Beam> pending() const { return pending_.beams; }

 private:
  /// How `beam`, turned by `delta_rad` since the beam before it, ends the pending sweep; nullopt: the sweep goes on.
  std::optional<Sweep::Extent> end_by(const Beam& beam, double delta_rad) const;
  /// Whether the first step was jitter, judged by the second one.
  bool is_jitter(double delta_rad) const;
  double smaller_step_rad() const;  ///< of the last two: a lost beam doubles one of them
  double larger_step_rad() const;
  std::optional<Sweep> close(Sweep::Extent extent);

  Sweep pending_;
  std::size_t longest_ = 0;    ///< bins of the longest pending beam
  double turned_rad_ = 0.0;    ///< signed angle from the first pending beam to the last
  double furthest_rad_ = 0.0;  ///< the same to the beam furthest from the first; its sign is the direction
  /// Sizes of the last two steps ahead, newest first. They outlive the sweep.
  std::array<double, 2> steps_rad_ = {0.0, 0.0};
};

/// Cuts a whole recording into sweeps; the beams left over at its end are the last one. REQUIRES valid beams.
std::vector<Sweep> sweeps_of(std::span<const Beam> beams);

}  // namespace pingvox
