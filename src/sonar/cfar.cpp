#include "sonar/cfar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace pingvox {
namespace {

/// Rayleigh amplitudes have exponentially distributed squares; each rate below is the fraction of squares that exceed
/// `times` the noise estimated from the squares of the training bins.

/// Finn and Johnson 1968: T = times the mean of n.
double rate_of_averages(double times, std::size_t n) {
  const auto count = static_cast<double>(n);
  return std::pow(1.0 + times / count, -count);
}

/// Weiss 1982: T = times the smaller mean of two groups of m.
double rate_smallest(double times, std::size_t m) {
  const double base = 2.0 + times / static_cast<double>(m);
  double term = 2.0 * std::pow(base, -static_cast<double>(m));
  double rate = term;
  for (std::size_t i = 1; i < m; ++i) {
    term *= static_cast<double>(m - 1 + i) / static_cast<double>(i) / base;
    rate += term;
  }
  return rate;
}

/// Hansen and Sawyers 1980: T = times the greater mean of two groups of m.
double rate_greatest(double times, std::size_t m) {
  const auto count = static_cast<double>(m);
  return 2.0 * std::pow(1.0 + times / count, -count) - rate_smallest(times, m);
}

/// Rohling 1983: T = times the k-th smallest of n.
double rate_of_ordered(double times, std::size_t k, std::size_t n) {
  double rate = 1.0;
  for (std::size_t i = 0; i < k; ++i) rate *= static_cast<double>(n - i) / (static_cast<double>(n - i) + times);
  return rate;
}

/// Rank of the ordered statistic among n values in ascending order, from 1.
std::size_t rank_of(std::size_t n) {
  return std::max<std::size_t>(1, n * 3 / 4);
}

double rate(double times, const CfarOptions& options) {
  const std::size_t n = 2 * options.training;
  switch (options.noise) {
    case CfarOptions::Noise::kCellAveraging:
      return rate_of_averages(times, n);
    case CfarOptions::Noise::kSmallestOf:
      return rate_smallest(times, options.training);
    case CfarOptions::Noise::kGreatestOf:
      return rate_greatest(times, options.training);
    case CfarOptions::Noise::kOrdered:
      break;
  }
  return rate_of_ordered(times, rank_of(n), n);
}

/// Training bins before and after a bin.
struct Training {
  std::span<const std::uint8_t> before;
  std::span<const std::uint8_t> behind;
};

Training training_of(std::span<const std::uint8_t> bins, std::size_t i, const CfarOptions& options) {
  const std::size_t before_end = i > options.guard ? i - options.guard : 0;
  const std::size_t before_begin = before_end - std::min(before_end, options.training);
  const std::size_t behind_begin = std::min(bins.size(), i + options.guard + 1);
  const std::size_t behind_end = std::min(bins.size(), behind_begin + options.training);
  return {bins.subspan(before_begin, before_end - before_begin), bins.subspan(behind_begin, behind_end - behind_begin)};
}

/// Prefix sums of squares: the noise of all bins in one pass.
class Squares {
 public:
  explicit Squares(std::span<const std::uint8_t> bins) : bins_(bins), up_to_(bins.size() + 1) {
    for (std::size_t i = 0; i < bins.size(); ++i)
      up_to_[i + 1] = up_to_[i] + static_cast<std::uint64_t>(bins[i] * bins[i]);
  }
  /// REQUIRES a part of the bins.
  double sum(std::span<const std::uint8_t> part) const {
    const auto begin = static_cast<std::size_t>(part.data() - bins_.data());
    return static_cast<double>(up_to_[begin + part.size()] - up_to_[begin]);
  }

 private:
  std::span<const std::uint8_t> bins_;
  std::vector<std::uint64_t> up_to_;
};

/// nullopt: no training bins.
std::optional<double> noise_around(const Training& training, const Squares& squares, CfarOptions::Noise noise) {
  const std::size_t n = training.before.size() + training.behind.size();
  if (n == 0) return std::nullopt;
  const auto mean = [&squares](std::span<const std::uint8_t> part) {
    return squares.sum(part) / static_cast<double>(part.size());
  };
  switch (noise) {
    case CfarOptions::Noise::kCellAveraging:
      return std::sqrt((squares.sum(training.before) + squares.sum(training.behind)) / static_cast<double>(n));
    case CfarOptions::Noise::kSmallestOf:
      if (training.before.empty()) return std::sqrt(mean(training.behind));
      if (training.behind.empty()) return std::sqrt(mean(training.before));
      return std::sqrt(std::min(mean(training.before), mean(training.behind)));
    case CfarOptions::Noise::kGreatestOf:
      if (training.before.empty()) return std::sqrt(mean(training.behind));
      if (training.behind.empty()) return std::sqrt(mean(training.before));
      return std::sqrt(std::max(mean(training.before), mean(training.behind)));
    case CfarOptions::Noise::kOrdered:
      break;
  }
  std::array<std::size_t, 256> counts{};
  for (const std::uint8_t bin : training.before) ++counts[bin];
  for (const std::uint8_t bin : training.behind) ++counts[bin];
  std::size_t value = 0;
  for (std::size_t below = counts[0]; below < rank_of(n); below += counts[value]) ++value;
  return static_cast<double>(value);
}

}  // namespace

double cfar_scale(const CfarOptions& options) {
  if (options.scale) return *options.scale;
  double low = 0.0;
  double high = 1.0;
  while (rate(high, options) > options.false_alarm_rate && high < 1e12) high *= 2.0;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (rate(middle, options) > options.false_alarm_rate ? low : high) = middle;
  }
  return std::sqrt(high);
}

std::optional<std::size_t> first_above_noise(std::span<const std::uint8_t> bins, double scale, double least,
                                             const CfarOptions& options) {
  const Squares squares(bins);
  for (std::size_t i = 1; i < bins.size(); ++i) {
    if (bins[i] <= bins[i - 1]) continue;
    const std::optional<double> noise = noise_around(training_of(bins, i, options), squares, options.noise);
    if (noise && bins[i] > scale * *noise && bins[i] >= *noise + least) return i;
  }
  return std::nullopt;
}

}  // namespace pingvox
