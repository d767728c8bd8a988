#pragma once

#include <optional>
#include <span>
#include <vector>

#include "accuracy/recording.hpp"

namespace pingvox::bench {

/// An interval of ranges.
struct Span {
  double first_m = 0.0, last_m = 0.0;
};

/// Ground truth of one beam, by geometry.
struct TrueReturns {
  /// Range of the first surface on the axis; nullopt: none within the bins.
  std::optional<double> axis_m;
  /// Ranges of surfaces in line of sight within the half-power cone (one way), sorted and disjoint. Empty: a silent
  /// beam.
  std::vector<Span> returns;
  /// The same for the whole main lobe, out to its first null, more than twice as wide and high.
  std::vector<Span> lobe;
};

/// Distance of a range to the nearest span; nullopt: no spans.
std::optional<double> distance_m(double range_m, const std::vector<Span>& spans);

/// Joins spans that overlap or touch.
std::vector<Span> join(std::vector<Span> spans);

/// Ground truth of each ping of a recording.
std::vector<TrueReturns> true_returns(const Recording& recording);

}  // namespace pingvox::bench
