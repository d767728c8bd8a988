#include "sonar/beam_rises.hpp"

#include <array>
#include <cmath>
#include <cstdlib>

namespace pingvox {
namespace {

/// Beyond the default filter's window, and beyond most of it.
constexpr std::size_t kLag_bins = 6, kShortLag_bins = 3;

/// Median of integers, interpolated. REQUIRES at least one.
/// @param counts  how often 0, 1, 2, ... occur
double median_of_counts(std::span<const std::size_t> counts, std::size_t total) {
  const double half = 0.5 * static_cast<double>(total);
  double below = 0.0;
  std::size_t value = 0;
  while (below + static_cast<double>(counts[value]) < half) below += static_cast<double>(counts[value++]);
  const double share = (half - below) / static_cast<double>(counts[value]);
  return value == 0 ? 0.5 * share : static_cast<double>(value) - 0.5 + share;
}

}  // namespace

double noise_of(std::span<const std::uint8_t> bins) {
  if (bins.size() <= kLag_bins) return 0.0;
  std::array<std::size_t, 256> counts{};
  for (std::size_t i = kLag_bins; i < bins.size(); ++i) {
    ++counts[static_cast<std::size_t>(std::abs(bins[i] - bins[i - kLag_bins]))];
  }
  return median_of_counts(counts, bins.size() - kLag_bins);
}

double noise_on_slopes_of(std::span<const std::uint8_t> bins) {
  if (bins.size() <= 2 * kShortLag_bins) return noise_of(bins);
  std::array<std::size_t, 511> counts{};
  for (std::size_t i = 2 * kShortLag_bins; i < bins.size(); ++i) {
    ++counts[static_cast<std::size_t>(std::abs(bins[i] - 2 * bins[i - kShortLag_bins] + bins[i - 2 * kShortLag_bins]))];
  }
  // Of independent bins, the variance of this sum is three times that of a difference.
  return median_of_counts(counts, bins.size() - 2 * kShortLag_bins) / std::sqrt(3.0);
}

}  // namespace pingvox
