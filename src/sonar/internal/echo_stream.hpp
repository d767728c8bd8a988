#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox {

/// Detects echoes while the head turns. Each beam is returned once, with exactly the echo that
/// detect_echoes(apply_filter(...)) finds for it in its whole sweep:
///
/// - A beam with delay_beams() beams of its sweep on either side is returned when the last of these arrives.
/// - The first and the last delay_beams() of a sweep are returned, in order, when the sweep ends: only then is it known
///   whether they are neighbours (a full turn). The first ones wait for about a turn.
/// - Without a delay_beams() all beams are returned, in order, when the sweep ends.
class EchoStream {
 public:
  struct BeamWithEcho {
    std::uint64_t number = 0;  ///< of the beam, counted from 0
    Beam beam;
    std::optional<Echo> echo;
    std::optional<Echo> beyond;  ///< without an echo: the one beyond max_range_m, if any
  };
  enum class Wait {
    kForNeighbours,  ///< a beam is returned as soon as its echo is final
    kForSweep,       ///< all beams of a sweep are returned together: less work
  };

  /// REQUIRES valid options.
  EchoStream(const FilterOptions& filter, const EchoOptions& echo, Wait wait = Wait::kForNeighbours);

  /// Takes the next beam, which must be valid. Returns the beams whose echoes are final now: the rest of the sweep that
  /// ended before it, the beam delay_beams() before it, or none.
  std::vector<BeamWithEcho> add(Beam beam);
  /// Returns the rest of the last sweep, and restarts.
  std::vector<BeamWithEcho> finish();

  /// Beams of its sweep that must arrive after a beam. nullopt: all, because the blanking range is measured or with
  /// kForSweep.
  std::optional<std::size_t> delay_beams() const { return delay_; }

  /// Number of complete sweeps; those of Extent::kCut do not count.
  std::size_t complete_sweeps() const { return complete_sweeps_; }

 private:
  std::vector<BeamWithEcho> rest_of(Sweep sweep);

  FilterOptions filter_;
  EchoOptions echo_;
  std::optional<std::size_t> delay_;
  SweepAssembler assembler_;
  std::uint64_t first_ = 0;  ///< number of the pending sweep's first beam
  std::size_t complete_sweeps_ = 0;
  std::size_t returned_ = 0;  ///< beams of the pending sweep that were returned, from the delay_-th on
};

}  // namespace pingvox
