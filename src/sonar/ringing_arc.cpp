#include "sonar/ringing_arc.hpp"

#include <algorithm>
#include <bitset>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace pingvox {
namespace {

/// Whether the beams look into nearly all directions.
bool is_around(const Sweep& sweep) {
  constexpr std::size_t kSectors = 36, kMinSeen = 27;
  std::bitset<kSectors> seen;
  for (const Beam& beam : sweep.beams) {
    seen.set(static_cast<std::size_t>(beam.bearing_rad / (2.0 * std::numbers::pi) * kSectors) % kSectors);
  }
  return seen.count() >= kMinSeen;
}

struct Span {
  double range_m, end_m;
};

}  // namespace

std::optional<double> end_of_ringing_arc_m(const std::vector<std::optional<Echo>>& echoes, const Sweep& sweep) {
  assert(echoes.size() == sweep.beams.size());
  constexpr double kFarthest_m = 1.5, kWidth_m = 0.2, kShare = 0.8;
  std::vector<Span> near;
  for (std::size_t n = 0; n < echoes.size(); ++n) {
    if (!echoes[n] || echoes[n]->range_m > kFarthest_m) continue;
    near.push_back({echoes[n]->range_m, static_cast<double>(echoes[n]->last + 1) * sweep.beams[n].bin_length_m});
  }
  const auto least = static_cast<std::size_t>(std::ceil(kShare * static_cast<double>(echoes.size())));
  if (near.empty() || near.size() < least || !is_around(sweep)) return std::nullopt;
  std::ranges::sort(near, {}, &Span::range_m);
  const auto narrow = [&](const Span& first) {
    const auto last = &first + (least - 1);
    return last < near.data() + near.size() && last->range_m - first.range_m <= kWidth_m;
  };
  const auto arc = std::ranges::find_if(near, narrow);
  if (arc == near.end()) return std::nullopt;
  // One echo in ten may go on into something else.
  std::vector<double> ends_m;
  for (auto span = arc; span != near.end() && span->range_m - arc->range_m <= kWidth_m; ++span) {
    ends_m.push_back(span->end_m);
  }
  const auto end = ends_m.begin() + static_cast<std::ptrdiff_t>(ends_m.size() * 9 / 10);
  std::ranges::nth_element(ends_m, end);
  return *end;
}

}  // namespace pingvox
