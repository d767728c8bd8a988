#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox {

/// Echoes while the head turns. Each beam comes back once, with the echo that detect_echoes(filtered(...)) finds for it
/// in its whole sweep, to the last bit. What that depends on decides when it comes:
///
/// - A beam with delay_beams() beams of its sweep on either side comes back when the last of these is heard.
/// - The first and the last delay_beams() of a sweep come back when the sweep is finished, in their order: only then it
///   is known whether they are neighbours (a full turn) or not. Until then the first ones wait for about a turn.
/// - Without a delay_beams() all beams wait for that, and come back in their order.
class EchoStream {
 public:
  struct Heard {
    std::uint64_t number = 0;  ///< of the beam: that many were added before it
    Beam beam;
    std::optional<Echo> echo;
    std::optional<Echo> beyond;  ///< where there is none: what was heard farther away than max_range_m
  };
  enum class Wait {
    kForNeighbours,  ///< a beam comes back as soon as its echo is settled
    kForSweep,       ///< all of a sweep come back together: less work
  };

  /// REQUIRES valid options.
  EchoStream(const FilterOptions& filter, const EchoOptions& echo, Wait wait = Wait::kForNeighbours);

  /// Takes the next beam, which must be valid. Returns the beams whose echoes it settled: the rest of the sweep that it
  /// showed to be finished, or the beam delay_beams() before it, or none.
  std::vector<Heard> add(Beam beam);
  /// Returns what is left of the last sweep, and starts anew.
  std::vector<Heard> finish();

  /// How many beams of its sweep must be heard after a beam. nullopt: all, because the blanking range is to be found,
  /// or as they are waited for.
  std::optional<std::size_t> delay_beams() const { return delay_; }

  /// Sweeps that came to their end, those that were cut not among them.
  std::size_t complete_sweeps() const { return complete_sweeps_; }

 private:
  std::vector<Heard> rest_of(Sweep sweep);

  FilterOptions filter_;
  EchoOptions echo_;
  std::optional<std::size_t> delay_;
  SweepAssembler assembler_;
  std::uint64_t first_ = 0;  ///< number of the gathered sweep's first beam
  std::size_t complete_sweeps_ = 0;
  std::size_t settled_ = 0;  ///< beams of the gathered sweep that were returned: those from the delay_-th on
};

}  // namespace pingvox
