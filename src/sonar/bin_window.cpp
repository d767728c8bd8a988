#include "sonar/bin_window.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace pingvox {
namespace {

// 0.75 m / 0.0125 m may come out as 60.000000000000007, which is bin 60 and not 61.
constexpr double kRounding_bins = 1e-6;

/// Number of a beam's bins that end within a range.
std::size_t bins_within(double range_m, double bin_length_m, double bins) {
  return static_cast<std::size_t>(std::clamp(std::floor(range_m / bin_length_m + kRounding_bins), 0.0, bins));
}

}  // namespace

std::vector<BinWindow> windows_of(const PolarImage& image, const Sweep& sweep, const EchoOptions& options) {
  assert(options.min_range_m);
  std::vector<BinWindow> windows;
  windows.reserve(image.rows());
  for (std::size_t n = 0; n < image.rows(); ++n) {
    const double bins = static_cast<double>(image.bins_in(n));
    const double bin_length_m = sweep.beams[n].bin_length_m;
    const double begin = std::ceil(*options.min_range_m / bin_length_m - kRounding_bins);
    windows.push_back({.begin = std::max(static_cast<std::size_t>(std::clamp(begin, 0.0, bins)), options.min_bin),
                       .end = image.bins_in(n)});
  }
  return windows;
}

std::vector<BinWindow> clip_windows(double max_range_m, std::vector<BinWindow> windows, const Sweep& sweep) {
  for (std::size_t n = 0; n < windows.size(); ++n) {
    std::size_t& end = windows[n].end;
    end = bins_within(max_range_m, sweep.beams[n].bin_length_m, static_cast<double>(end));
  }
  return windows;
}

}  // namespace pingvox
