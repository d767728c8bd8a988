#include "paper_detector.hpp"

#include <cstdlib>

namespace pingvox::bench {

std::optional<PaperEdge> paper_edge(std::span<const std::uint8_t> beam, std::size_t first_bin, int threshold) {
  for (std::size_t i = first_bin + 1; i < beam.size(); ++i) {
    const int difference = int{beam[i]} - int{beam[i - 1]};
    if (std::abs(difference) >= threshold) return PaperEdge{.bin = i, .is_falling = difference < 0};
  }
  return std::nullopt;
}

}  // namespace pingvox::bench
