#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace pingvox::bench {

/// Where the paper's detector fires.
struct PaperEdge {
  std::size_t bin = 0;      ///< the second of the two that differ
  bool is_falling = false;  ///< the sound got weaker there: no wall
};

/// The paper's detector as section 8.2 has it: the first place where "the difference between two sequential
/// measures in a beam is significant enough", whichever way. nullopt: nowhere.
/// @param first_bin  what lies before it is the head's own reflection
std::optional<PaperEdge> paper_edge(std::span<const std::uint8_t> beam, std::size_t first_bin, int threshold);

}  // namespace pingvox::bench
