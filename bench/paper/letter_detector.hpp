#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace pingvox::bench {

/// Where the paper's detector fires.
struct LetterEdge {
  std::size_t bin = 0;      ///< the second of the two that differ
  bool is_falling = false;  ///< the sound got weaker there: no wall
};

/// The paper's detector by the letter of section 8.2: the first place where "the difference between two sequential
/// measures in a beam is significant enough", whichever way. nullopt: nowhere.
/// @param first_bin  what lies before it is the head's own reflection
std::optional<LetterEdge> letter_edge(std::span<const std::uint8_t> beam, std::size_t first_bin, int threshold);

}  // namespace pingvox::bench
