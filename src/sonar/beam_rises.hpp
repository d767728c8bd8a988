#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pingvox/sonar/polar_image.hpp"

/// What contrast and noise floor of a beam are made of.
namespace pingvox {

/// Maximum length of a rise: longer than a wall's, shorter than that of a background that grows with the range.
inline constexpr std::size_t kRise_bins = 48;

/// Beams to either side that affect one beam's contrast and noise floor.
inline constexpr std::size_t kContrastReach_beams = 16;

/// Calls f(bin, rise) for each bin: its height above the lowest of the kRise_bins before it.
template <class F>
void for_each_rise(std::span<const std::uint8_t> bins, F&& f) {
  // The valleys within the last kRise_bins: from `lowest` on, in ascending order.
  std::vector<std::size_t> valleys;
  valleys.reserve(bins.size());
  std::size_t lowest = 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    while (valleys.size() > lowest && bins[valleys.back()] >= bins[i]) valleys.pop_back();
    valleys.push_back(i);
    if (i - valleys[lowest] > kRise_bins) ++lowest;
    f(i, bins[i] - bins[valleys[lowest]]);
  }
}

/// The noise of bins: their median difference to the one six before, which is beyond the default filter's window.
/// Interpolated between integers, since smoothed noise is often less than 2.
double noise_of(std::span<const std::uint8_t> bins);

/// The same by their median second difference, which is 0 on a slope: differences of bins that a long echo fills are
/// those of its slopes.
double noise_on_slopes_of(std::span<const std::uint8_t> bins);

/// Calls f(m) for each beam m within `reach` beams of beam n, itself included, across the seam of a full turn.
template <class F>
void for_each_beam_around(const PolarImage& image, std::size_t n, std::size_t reach, F&& f) {
  const auto rows = static_cast<std::ptrdiff_t>(image.rows()), middle = static_cast<std::ptrdiff_t>(n);
  const auto far = static_cast<std::ptrdiff_t>(reach);
  for (std::ptrdiff_t at = middle - far; at <= middle + far; ++at) {
    const bool is_inside = at >= 0 && at < rows;
    if (is_inside || image.wrap() == PolarImage::Wrap::kAround) f(static_cast<std::size_t>((at % rows + rows) % rows));
  }
}

template <class T>
T nth_smallest(std::vector<T>& values, std::size_t rank) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::ranges::nth_element(values, place);
  return *place;
}

}  // namespace pingvox
