#include "sonar/noise_floor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "sonar/beam_rises.hpp"

namespace pingvox {
namespace {

constexpr double kWallNoiseRatio = 11.0, kEchoNoiseRatio = 12.0, kWallShare = 0.25;
/// Noise grows by no more from one part of a beam to the next: what is louder is a wall.
constexpr double kGrowth = 1.5;
constexpr double kLeastNoise = 0.5;  // of intensities without noise
constexpr std::size_t kParts = 8, kMinPart_bins = 40;

/// What is heard in one part of a beam.
struct Part {
  double noise = 0.0;
  int rise = 0;  ///< the largest that ends in it
};

std::vector<Part> parts_of(std::span<const std::uint8_t> bins) {
  std::vector<Part> parts(std::clamp<std::size_t>(bins.size() / kMinPart_bins, 1, kParts));
  for (std::size_t p = 0; p < parts.size(); ++p) {
    // The bins that `at` says are of this part.
    const std::size_t first = (bins.size() * p + parts.size() - 1) / parts.size();
    const std::size_t end = (bins.size() * (p + 1) + parts.size() - 1) / parts.size();
    parts[p].noise = noise_of(bins.subspan(first, end - first));
  }
  for_each_rise(bins, [&](std::size_t bin, int rise) {
    int& largest = parts[bin * parts.size() / bins.size()].rise;
    largest = std::max(largest, rise);
  });
  return parts;
}

/// The part of a beam that begins where part p of `parts` does, or before it.
const Part& part_at(const std::vector<Part>& beam, std::size_t p, std::size_t parts) {
  return beam[p * beam.size() / parts];
}

/// Noise of each part, told by many beams.
std::vector<double> noise_by_range(std::span<const std::vector<Part>* const> beams, std::size_t parts) {
  std::vector<double> noises(parts), heard;
  for (std::size_t p = 0; p < parts; ++p) {
    heard.clear();
    for (const std::vector<Part>* beam : beams) heard.push_back(part_at(*beam, p, parts).noise);
    noises[p] = std::max(kLeastNoise, nth_smallest(heard, heard.size() / 2));
  }
  for (std::size_t p = 1; p < parts; ++p) noises[p] = std::min(noises[p], kGrowth * noises[p - 1]);
  return noises;
}

/// Whether a beam rises far above the noise in a part or one beside it.
bool has_wall_near(const std::vector<Part>& beam, const std::vector<double>& noises, std::size_t part) {
  const std::size_t end = std::min(part + 2, noises.size());
  for (std::size_t p = part > 0 ? part - 1 : 0; p < end; ++p) {
    if (part_at(beam, p, noises.size()).rise >= kWallNoiseRatio * noises[p]) return true;
  }
  return false;
}

}  // namespace

std::vector<NoiseFloor> noise_floors(const PolarImage& image, const std::vector<BinWindow>& windows) {
  std::vector<std::vector<Part>> heard(image.rows());
  for (std::size_t n = 0; n < image.rows(); ++n) {
    const auto [begin, end] = windows[n];
    if (begin < end) heard[n] = parts_of(image.row(n).subspan(begin, end - begin));
  }
  std::vector<NoiseFloor> floors;
  floors.reserve(image.rows());
  std::vector<const std::vector<Part>*> around;
  for (std::size_t n = 0; n < image.rows(); ++n) {
    around.clear();
    for_each_beam_around(image, n, [&](std::size_t m) {
      if (!heard[m].empty()) around.push_back(&heard[m]);
    });
    std::vector<int> rises(std::max<std::size_t>(heard[n].size(), 1), 0);
    if (!heard[n].empty()) {
      const std::vector<double> noises = noise_by_range(around, rises.size());
      for (std::size_t p = 0; p < rises.size(); ++p) {
        const auto walls = std::ranges::count_if(
            around, [&](const std::vector<Part>* beam) { return has_wall_near(*beam, noises, p); });
        if (static_cast<double>(walls) >= kWallShare * static_cast<double>(around.size())) continue;
        rises[p] = static_cast<int>(std::ceil(kEchoNoiseRatio * noises[p]));
      }
    }
    floors.emplace_back(windows[n], std::move(rises));
  }
  return floors;
}

}  // namespace pingvox
