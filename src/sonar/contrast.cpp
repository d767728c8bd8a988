#include "sonar/contrast.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "sonar/beam_rises.hpp"

namespace pingvox {
namespace {

// Upper quartile of the rises / noise: 5 to 9.5 in pure noise, 11 to 17 in the tank recording.
constexpr double kQuartileNoiseRatio = 9.7, kMedianNoiseRatio = 8.5, kEchoNoiseRatio = 15.0;

int largest_rise(std::span<const std::uint8_t> bins) {
  int largest = 0;
  for_each_rise(bins, [&](std::size_t, int rise) { largest = std::max(largest, rise); });
  return largest;
}

/// Noise grows with the range, as the gain does. The second noisiest of four parts of the beam (fewer if it is short):
/// the noisiest may hold the wall.
double noise_of_noisy_part(std::span<const std::uint8_t> bins) {
  constexpr std::size_t kMinPart_bins = 60, kMaxParts = 4;
  std::vector<double> noises(std::clamp<std::size_t>(bins.size() / kMinPart_bins, 1, kMaxParts));
  for (std::size_t part = 0; part < noises.size(); ++part) {
    const std::size_t first = bins.size() * part / noises.size();
    noises[part] = noise_of(bins.subspan(first, bins.size() * (part + 1) / noises.size() - first));
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

Contrasts::Contrasts(const PolarImage& image, const std::vector<BinWindow>& windows)
    : image_(image), heard_(image.rows()) {
  for (std::size_t n = 0; n < image.rows(); ++n) {
    const auto [begin, end] = windows[n];
    if (begin >= end) continue;
    const std::span<const std::uint8_t> bins = image.row(n).subspan(begin, end - begin);
    heard_[n] = Loudness{largest_rise(bins), noise_of_noisy_part(bins)};
  }
}

int Contrasts::of(std::size_t beam) const {
  std::vector<int> rises;
  std::vector<double> noises;
  for_each_beam_around(image_, beam, kContrastReach_beams, [&](std::size_t m) {
    if (!heard_[m]) return;
    rises.push_back(heard_[m]->rise);
    noises.push_back(heard_[m]->noise);
  });
  return contrast_of(rises, noises);
}

}  // namespace pingvox
