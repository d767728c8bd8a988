#include "pingvox/sonar/detect_echo.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>
#include <string>

namespace pingvox {
namespace {

/// The bins that may be evidence: those that lie inside [min_range_m, max_range_m] as a whole.
struct BinWindow {
  std::size_t begin = 0;
  std::size_t end = 0;
};

BinWindow window_of(std::size_t bins, double bin_length_m, const EchoOptions& options) {
  // 0.75 m / 0.0125 m may come out as 60.000000000000007, which is bin 60 and not 61.
  constexpr double kRounding_bins = 1e-6;
  const auto in_beam = [bins](double n) {
    return static_cast<std::size_t>(std::clamp(n, 0.0, static_cast<double>(bins)));
  };
  return {.begin = in_beam(std::ceil(options.min_range_m / bin_length_m - kRounding_bins)),
          .end = in_beam(std::floor(options.max_range_m / bin_length_m + kRounding_bins))};
}

std::optional<Echo> first_rise(std::span<const std::uint8_t> bins, BinWindow window, int threshold) {
  const auto fell_from = [&bins, threshold](std::size_t top, std::size_t i) {
    return 2 * (bins[top] - bins[i]) > threshold;
  };
  if (window.begin >= window.end) return std::nullopt;
  // Adding up the differences since the valley gives the height above it, so only valley and top have to be known.
  std::size_t valley = window.begin;
  std::size_t top = window.begin;
  std::size_t i = window.begin + 1;
  for (; i < window.end && bins[i] - bins[valley] < threshold; ++i) {
    if (bins[i] <= bins[valley] || fell_from(top, i)) {
      valley = top = i;
    } else if (bins[i] > bins[top]) {
      top = i;
    }
  }
  if (i >= window.end) return std::nullopt;
  Echo echo{.first = i, .peak = i, .last = i};
  for (++i; i < window.end && !fell_from(echo.peak, i); ++i) {
    if (bins[i] > bins[echo.peak]) echo.peak = i;
    echo.last = i;
  }
  echo.intensity = bins[echo.peak];
  return echo;
}

/// Middle of the echo's crest [bins]: of its bins, each weighing as much as it stands above a quarter of the threshold
/// below the peak. A single bin of speckle decides which one is the peak, but hardly about this.
double crest_of(std::span<const std::uint8_t> bins, const Echo& echo, int threshold) {
  double weights = 0.0;
  double moment = 0.0;
  for (std::size_t i = echo.first; i <= echo.last; ++i) {
    const double weight = std::max(0, threshold - 4 * (bins[echo.peak] - bins[i]));
    weights += weight;
    moment += weight * (static_cast<double>(i) + 0.5);
  }
  return moment / weights;
}

std::vector<std::optional<Echo>> rises(const PolarImage& image, const Sweep& sweep, const EchoOptions& options) {
  std::vector<std::optional<Echo>> echoes(image.rows());
  for (std::size_t n = 0; n < image.rows(); ++n) {
    const double bin_length_m = sweep.beams[n].bin_length_m;
    const std::span<const std::uint8_t> bins = image.row(n).first(image.bins_in(n));
    std::optional<Echo> echo = first_rise(bins, window_of(bins.size(), bin_length_m, options), options.threshold);
    if (echo) echo->range_m = crest_of(bins, *echo, options.threshold) * bin_length_m;
    echoes[n] = echo;
  }
  return echoes;
}

}  // namespace

Result<void> EchoOptions::validate() const {
  std::string bad;
  if (!(min_range_m >= 0.0)) bad += fmt::format(" min_range_m must be >= 0, is {};", min_range_m);
  if (!(max_range_m > min_range_m)) {
    bad += fmt::format(" max_range_m must be greater than min_range_m ({}), is {};", min_range_m, max_range_m);
  }
  if (threshold < 1 || threshold > 255) bad += fmt::format(" threshold must be in 1..255, is {};", threshold);
  if (bad.empty()) return {};
  bad.pop_back();
  return fail(Error::Code::kBadOption, "echo:" + bad);
}

std::vector<std::optional<Echo>> detect_echoes(const PolarImage& image, const Sweep& sweep,
                                               const EchoOptions& options) {
  assert(options.validate());
  assert(image.rows() == sweep.beams.size());
  switch (options.detector) {
    case Detector::kRise:
      return rises(image, sweep, options);
  }
  return std::vector<std::optional<Echo>>(image.rows());
}

}  // namespace pingvox
