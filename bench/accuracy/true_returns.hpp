#pragma once

#include <optional>
#include <span>
#include <vector>

#include "accuracy/recording.hpp"

namespace pingvox::bench {

/// Ranges from `first_m` to `last_m`.
struct Span {
  double first_m = 0.0, last_m = 0.0;
};

/// What there is for one beam to hear, by geometry alone.
struct TrueReturns {
  /// To the first surface along the middle of the beam; nullopt: none within the bins.
  std::optional<double> axis_m;
  /// Ranges at which a surface in line of sight lies within the cone of half power (one way), in order, apart from each
  /// other: sound comes back from each of them. Empty: a silent beam.
  std::vector<Span> returns;
  /// The same of all the main lobe, out to where it hears nothing: more than twice as wide and high.
  std::vector<Span> lobe;
};

/// How far a range is from the nearest of some spans; nullopt: there are none.
std::optional<double> off_m(double range_m, const std::vector<Span>& spans);

/// Joins spans that overlap or touch.
std::vector<Span> join(std::vector<Span> spans);

/// What is true of each ping of a recording.
std::vector<TrueReturns> true_returns(const Recording& recording);

}  // namespace pingvox::bench
