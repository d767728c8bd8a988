#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace pingvox::bench {

/// Detection of the paper's detector.
struct PaperEdge {
  std::size_t bin = 0;      ///< the second of the two bins
  bool is_falling = false;  ///< intensity decreases: no wall
};

/// The paper's detector as in section 8.2: the first place where "the difference between two sequential
/// measures in a beam is significant enough", of either sign. nullopt: none.
/// @param first_bin  nearer bins hold the ringing of the head
std::optional<PaperEdge> paper_edge(std::span<const std::uint8_t> beam, std::size_t first_bin, int threshold);

}  // namespace pingvox::bench
