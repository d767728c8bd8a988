#include "sonar/contrast.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <optional>
#include <span>

namespace pingvox {
namespace {

/// Signal and noise of one beam.
struct Loudness {
  int rise;      ///< largest rise within kRise_bins
  double noise;  ///< median difference of bins kLag_bins apart, in the noisy part of the beam
};

// Upper quartile of the rises / noise: 5 to 9.5 in pure noise, 11 to 17 in the tank recording.
constexpr double kQuartileNoiseRatio = 9.7, kMedianNoiseRatio = 8.5, kEchoNoiseRatio = 15.0;
constexpr std::size_t kLag_bins = 6;  // beyond the default filter's window

int largest_rise(std::span<const std::uint8_t> bins) {
  int largest = 0;
  std::deque<std::size_t> valleys;  // within the last kRise_bins, in ascending order
  for (std::size_t i = 0; i < bins.size(); ++i) {
    while (!valleys.empty() && bins[valleys.back()] >= bins[i]) valleys.pop_back();
    valleys.push_back(i);
    if (i - valleys.front() > kRise_bins) valleys.pop_front();
    largest = std::max(largest, bins[i] - bins[valleys.front()]);
  }
  return largest;
}

/// Interpolated between integers, since smoothed noise is often less than 2.
double median_difference(std::span<const std::uint8_t> bins) {
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

template <class T>
T nth_smallest(std::vector<T>& values, std::size_t rank) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::ranges::nth_element(values, place);
  return *place;
}

/// Noise grows with the range, as the gain does. The second noisiest of four parts of the beam (fewer if it is short):
/// the noisiest may hold the wall.
double noise_of(std::span<const std::uint8_t> bins) {
  constexpr std::size_t kMinPart_bins = 60, kMaxParts = 4;
  std::vector<double> noises(std::clamp<std::size_t>(bins.size() / kMinPart_bins, 1, kMaxParts));
  for (std::size_t part = 0; part < noises.size(); ++part) {
    const std::size_t first = bins.size() * part / noises.size();
    noises[part] = median_difference(bins.subspan(first, bins.size() * (part + 1) / noises.size() - first));
  }
  return nth_smallest(noises, std::max<std::size_t>(noises.size(), 2) - 2);
}

int contrast_of(std::vector<int>& rises, std::vector<double>& noises) {
  constexpr int kMinRise = 14;  // of 255, for beams without noise
  if (rises.empty()) return kMinRise;
  const int rise = nth_smallest(rises, rises.size() * 3 / 4);
  const double noise = nth_smallest(noises, noises.size() / 2);
  const int half = std::max(kMinRise, (rise + 1) / 2);
  // If most beams have an echo: half of the usual rise; else well above the noise.
  if (rise >= kQuartileNoiseRatio * noise && nth_smallest(rises, rises.size() / 2) >= kMedianNoiseRatio * noise)
    return half;
  return std::max(half, static_cast<int>(std::ceil(kEchoNoiseRatio * noise)));
}

}  // namespace

std::vector<int> contrasts_by_gain(const PolarImage& image, const std::vector<BinWindow>& windows) {
  std::vector<std::optional<Loudness>> heard(image.rows());
  for (std::size_t n = 0; n < image.rows(); ++n) {
    const auto [begin, end] = windows[n];
    if (begin >= end) continue;
    const std::span<const std::uint8_t> bins = image.row(n).subspan(begin, end - begin);
    heard[n] = Loudness{largest_rise(bins), noise_of(bins)};
  }
  const auto rows = static_cast<std::ptrdiff_t>(image.rows());
  constexpr auto kReach = static_cast<std::ptrdiff_t>(kContrastReach_beams);
  std::vector<int> contrasts;
  contrasts.reserve(image.rows());
  std::vector<int> rises;
  std::vector<double> noises;
  for (std::ptrdiff_t n = 0; n < rows; ++n) {
    rises.clear();
    noises.clear();
    for (std::ptrdiff_t at = n - kReach; at <= n + kReach; ++at) {
      const bool inside = at >= 0 && at < rows;
      if (!inside && image.wrap() == PolarImage::Wrap::kNone) continue;
      const std::optional<Loudness>& loudness = heard[static_cast<std::size_t>((at % rows + rows) % rows)];
      if (!loudness) continue;
      rises.push_back(loudness->rise);
      noises.push_back(loudness->noise);
    }
    contrasts.push_back(contrast_of(rises, noises));
  }
  return contrasts;
}

}  // namespace pingvox
