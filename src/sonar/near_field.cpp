#include "sonar/near_field.hpp"

#include <algorithm>
#include <utility>

#include "sonar/beam_rises.hpp"

namespace pingvox {

std::vector<std::uint8_t> mean_of_beams(const PolarImage& image, const Sweep& sweep, std::size_t beam,
                                        std::size_t first, std::size_t end) {
  std::vector<std::size_t> sums(end - first), counts(sums.size());
  for_each_beam_around(image, beam, kNearFieldReach_beams, [&](std::size_t m) {
    if (sweep.beams[m].bin_length_m != sweep.beams[beam].bin_length_m) return;
    const std::size_t last = std::min(image.bins_in(m), end);
    for (std::size_t i = first; i < last; ++i) {
      sums[i - first] += image.row(m)[i];
      ++counts[i - first];
    }
  });
  std::vector<std::uint8_t> mean(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) mean[i] = static_cast<std::uint8_t>(sums[i] / counts[i]);
  return mean;
}

NearField near_field_of(std::vector<std::uint8_t> mean, std::size_t nearest, int level, double bin_length_m) {
  const auto is_loud = [level](std::uint8_t intensity) { return intensity >= level; };
  NearField near{.mean = std::move(mean),
                 .level = level,
                 .ringing_end = 0,
                 .begin = nearest,
                 .end = nearest,
                 .walls_end = nearest};
  while (!is_loud(near.mean[near.ringing_end])) ++near.ringing_end;
  while (near.ringing_end < near.mean.size() && is_loud(near.mean[near.ringing_end])) ++near.ringing_end;
  while (near.begin > 0 && is_loud(near.mean[near.begin - 1])) --near.begin;
  while (near.end < near.mean.size() && is_loud(near.mean[near.end])) ++near.end;
  const double reach = std::min(kNearWalls_m / bin_length_m, static_cast<double>(near.end - nearest));
  near.walls_end += static_cast<std::size_t>(reach);
  return near;
}

}  // namespace pingvox
