#include "slam/sweeps/echo_runs.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "pingvox/sonar/polar_image.hpp"

namespace pingvox {
namespace {

/// Bins that were taken for noise within an echo, and the fewest bins of an echo.
constexpr std::size_t kGap_bins = 2, kShortest_bins = 3;
constexpr std::size_t kRunsOfBeam = 2;

bool is_thresholded(const Sweep& sweep) {
  std::uint8_t level = 0;
  for (const Beam& beam : sweep.beams) {
    for (const std::uint8_t intensity : beam.intensities) {
      if (intensity == 0 || intensity == level) continue;
      if (level != 0) return false;
      level = intensity;
    }
  }
  return true;
}

EchoRun run_of(const Beam& beam, std::size_t first, std::size_t last) {
  const auto bins = static_cast<double>(last - first + 1);
  return {beam.time_s, beam.bearing_rad, (static_cast<double>(first) + bins / 2.0) * beam.bin_length_m,
          bins / 2.0 * beam.bin_length_m};
}

/// The runs of bins that are not 0, the longest ones, nearest first.
void add_runs(const Beam& beam, const EchoOptions& echo, std::vector<EchoRun>& runs) {
  struct Bins {
    std::size_t first, last;
  };
  std::vector<Bins> found;
  const double nearest_m = echo.min_range_m.value_or(EchoOptions::kDefaultBlanking_m);
  for (std::size_t i = echo.min_bin; i < beam.intensities.size(); ++i) {
    const double range_m = static_cast<double>(i) * beam.bin_length_m;
    if (beam.intensities[i] == 0 || range_m < nearest_m || range_m + beam.bin_length_m > echo.max_range_m) continue;
    if (!found.empty() && i - found.back().last <= kGap_bins + 1) {
      found.back().last = i;
    } else {
      found.push_back({i, i});
    }
  }
  std::erase_if(found, [](const Bins& bins) { return bins.last - bins.first + 1 < kShortest_bins; });
  // The longest first; of equals, the nearest.
  std::ranges::sort(found, {}, [](const Bins& bins) {
    return std::pair(-static_cast<std::ptrdiff_t>(bins.last - bins.first), bins.first);
  });
  if (found.size() > kRunsOfBeam) found.resize(kRunsOfBeam);
  std::ranges::sort(found, {}, &Bins::first);
  for (const Bins& bins : found) runs.push_back(run_of(beam, bins.first, bins.last));
}

}  // namespace

std::vector<EchoRun> echo_runs(const Sweep& sweep, const FilterOptions& filter, const EchoOptions& echo) {
  std::vector<EchoRun> runs;
  if (is_thresholded(sweep)) {
    for (const Beam& beam : sweep.beams) add_runs(beam, echo, runs);
    return runs;
  }
  const PolarImage image = apply_filter(PolarImage(sweep), filter);
  const std::vector<std::optional<Echo>> echoes = detect_echoes(image, sweep, echo);
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    if (!echoes[i]) continue;
    EchoRun run = run_of(sweep.beams[i], echoes[i]->first, echoes[i]->last);
    // On a slanting wall the middle of the run is behind its crest: pairs of such echoes would shrink the trajectory.
    run.range_m = echoes[i]->range_m;
    run.place = EchoRun::Place::kCrest;
    runs.push_back(run);
  }
  return runs;
}

}  // namespace pingvox
