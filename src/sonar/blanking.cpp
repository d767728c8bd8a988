#include "sonar/internal/blanking.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <vector>

#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox {
namespace {

constexpr std::size_t kMinBeams = 32;

/// Lowest decile and median of the beams, bin by bin.
struct Profile {
  std::vector<int> low;
  std::vector<int> median;
};

Profile profile_of(const PolarImage& image) {
  constexpr std::size_t kLowShare = 10;  // one beam in ten may lack the ringing
  Profile profile;
  std::vector<std::uint8_t> column;
  for (std::size_t i = 0; i < image.columns(); ++i) {
    column.clear();
    for (std::size_t n = 0; n < image.rows(); ++n) {
      if (i < image.bins_in(n)) column.push_back(image.row(n)[i]);
    }
    if (column.size() < kMinBeams) break;
    std::ranges::sort(column);
    profile.low.push_back(column[column.size() / kLowShare]);
    profile.median.push_back(column[column.size() / 2]);
  }
  return profile;
}

int middle_of(std::vector<int> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

double blanking_range_m(const PolarImage& image, const Sweep& sweep) {
  assert(image.rows() == sweep.beams.size());
  const Profile profile = profile_of(image);
  const std::size_t bins = profile.low.size();
  if (bins == 0) return EchoOptions::kDefaultBlanking_m;
  const double bin_length_m = sweep.beams.front().bin_length_m;

  // The ringing begins at the transducer, or as soon as the receiver is switched on: in the first eighth.
  const auto begin = profile.low.begin();
  const auto strongest = std::max_element(begin, begin + static_cast<std::ptrdiff_t>((bins + 7) / 8));
  const int background = middle_of(profile.low);
  constexpr int kFaintest = 8;
  if (*strongest < 2 * background + kFaintest) return 0.0;
  const int level = background + (*strongest - background) / 4;
  const std::size_t farthest = bins / 2;
  auto i = static_cast<std::size_t>(strongest - begin);
  while (i < farthest && profile.low[i] >= level) ++i;

  // The decay ends where the median beam stops falling, or is down to a sixteenth.
  const int nothing = *strongest / 16;
  const double most = std::max(2.0, static_cast<double>(bins));
  const auto ahead = static_cast<std::size_t>(std::clamp(std::ceil(0.05 / bin_length_m), 2.0, most));
  while (i + ahead < farthest && profile.median[i] > nothing && profile.median[i + ahead] < profile.median[i]) ++i;
  return static_cast<double>(i) * bin_length_m;
}

}  // namespace pingvox
