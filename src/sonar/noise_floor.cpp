#include "sonar/noise_floor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "sonar/beam_rises.hpp"

namespace pingvox {
namespace {

constexpr double kWallNoiseRatio = 11.0, kQuietNoiseRatio = 12.0, kWallShare = 0.25;
/// Noise grows by no more from one part of a beam to the next: what is louder is a wall.
constexpr double kGrowth = 1.5;
/// Where less than this part of the differences is noise, the bins lie on the slopes of a long echo.
constexpr double kSlopes = 0.25;
constexpr double kMinNoise = 0.5;  // of intensities without noise
constexpr std::size_t kParts = 8, kMinPart_bins = 40;

std::vector<BeamPart> parts_of(std::span<const std::uint8_t> bins) {
  std::vector<BeamPart> parts(std::clamp<std::size_t>(bins.size() / kMinPart_bins, 1, kParts));
  for (std::size_t p = 0; p < parts.size(); ++p) {
    // The bins that `at` says are of this part.
    const std::size_t first = (bins.size() * p + parts.size() - 1) / parts.size();
    const std::size_t end = (bins.size() * (p + 1) + parts.size() - 1) / parts.size();
    parts[p].noise = noise_of(bins.subspan(first, end - first));
    if (p > 0) continue;
    // No part before the first one limits its noise.
    const double on_slopes = noise_on_slopes_of(bins.first(end));
    if (on_slopes < kSlopes * parts[p].noise) parts[p].noise = on_slopes;
  }
  std::size_t p = 0;
  for_each_rise(bins, [&](std::size_t bin, int rise) {
    while ((p + 1) * bins.size() <= bin * parts.size()) ++p;
    parts[p].rise = std::max(parts[p].rise, rise);
  });
  return parts;
}

/// The part of a beam that begins where part p of `parts` does, or before it.
const BeamPart& part_at(const std::vector<BeamPart>& beam, std::size_t p, std::size_t parts) {
  return beam[p * beam.size() / parts];
}

/// Noise of each part, told by many beams.
std::vector<double> noise_by_range(std::span<const std::vector<BeamPart>* const> beams, std::size_t parts) {
  std::vector<double> noises(parts), heard;
  for (std::size_t p = 0; p < parts; ++p) {
    heard.clear();
    for (const std::vector<BeamPart>* beam : beams) heard.push_back(part_at(*beam, p, parts).noise);
    noises[p] = std::max(kMinNoise, nth_smallest(heard, heard.size() / 2));
  }
  for (std::size_t p = 1; p < parts; ++p) noises[p] = std::min(noises[p], kGrowth * noises[p - 1]);
  return noises;
}

/// Whether a beam rises far above the noise in a part or one beside it.
bool has_wall_near(const std::vector<BeamPart>& beam, const std::vector<double>& noises, std::size_t part) {
  const std::size_t end = std::min(part + 2, noises.size());
  for (std::size_t p = part > 0 ? part - 1 : 0; p < end; ++p) {
    if (part_at(beam, p, noises.size()).rise >= kWallNoiseRatio * noises[p]) return true;
  }
  return false;
}

}  // namespace

NoiseFloors::NoiseFloors(const PolarImage& image, const std::vector<BinWindow>& windows)
    : image_(image), windows_(windows), heard_(image.rows()) {
  for (std::size_t n = 0; n < image.rows(); ++n) {
    const auto [begin, end] = windows[n];
    if (begin < end) heard_[n] = parts_of(image.row(n).subspan(begin, end - begin));
  }
}

NoiseFloor NoiseFloors::of(std::size_t beam) const {
  std::vector<int> rises(std::max<std::size_t>(heard_[beam].size(), 1), 0);
  if (heard_[beam].empty()) return {windows_[beam], std::move(rises)};
  std::vector<const std::vector<BeamPart>*> around;
  for_each_beam_around(image_, beam, kContrastReach_beams, [&](std::size_t m) {
    if (!heard_[m].empty()) around.push_back(&heard_[m]);
  });
  const std::vector<double> noises = noise_by_range(around, rises.size());
  for (std::size_t p = 0; p < rises.size(); ++p) {
    const auto walls = std::ranges::count_if(
        around, [&](const std::vector<BeamPart>* beam_around) { return has_wall_near(*beam_around, noises, p); });
    if (static_cast<double>(walls) >= kWallShare * static_cast<double>(around.size())) continue;
    rises[p] = static_cast<int>(std::ceil(kQuietNoiseRatio * noises[p]));
  }
  return {windows_[beam], std::move(rises)};
}

}  // namespace pingvox
