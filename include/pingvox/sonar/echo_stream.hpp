#pragma once

#include <cstddef>
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
/// - Without a delay_beams() all beams wait for that.
class EchoStream {
 public:
  struct Heard {
    Beam beam;
    std::optional<Echo> echo;
  };

  /// REQUIRES valid options.
  EchoStream(const FilterOptions& filter, const EchoOptions& echo);

  /// Takes the next beam, which must be valid. Returns the beams whose echoes it settled: the rest of the sweep that it
  /// showed to be finished, or the beam delay_beams() before it, or none.
  std::vector<Heard> add(Beam beam);
  /// Returns what is left of the last sweep, and starts anew.
  std::vector<Heard> finish();

  /// How many beams of its sweep must be heard after a beam. nullopt: all, because the blanking range is to be found.
  std::optional<std::size_t> delay_beams() const { return delay_; }

 private:
  std::vector<Heard> rest_of(const Sweep& sweep);

  FilterOptions filter_;
  EchoOptions echo_;
  std::optional<std::size_t> delay_;
  SweepAssembler assembler_;
  std::size_t settled_ = 0;  ///< beams of the gathered sweep that were returned: those from the delay_-th on
};

}  // namespace pingvox
