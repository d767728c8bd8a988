#include "sonar/beam_rises.hpp"

#include <array>
#include <cstdlib>

namespace pingvox {

double noise_of(std::span<const std::uint8_t> bins) {
  constexpr std::size_t kLag_bins = 6;
  if (bins.size() <= kLag_bins) return 0.0;
  std::array<std::size_t, 256> counts{};
  for (std::size_t i = kLag_bins; i < bins.size(); ++i) {
    ++counts[static_cast<std::size_t>(std::abs(bins[i] - bins[i - kLag_bins]))];
  }
  const double half = 0.5 * static_cast<double>(bins.size() - kLag_bins);
  double below = 0.0;
  std::size_t value = 0;
  while (below + static_cast<double>(counts[value]) < half) below += static_cast<double>(counts[value++]);
  const double share = (half - below) / static_cast<double>(counts[value]);
  return value == 0 ? 0.5 * share : static_cast<double>(value) - 0.5 + share;
}

}  // namespace pingvox
