#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace pingvox::detail {

/// Number of gaps between angles that divide a width into steps of at most `apart`; 0 for a width of 0.
std::size_t gaps_between(double width_rad, double apart_rad);
/// Angle i of 0..gaps, from -width / 2 to width / 2; 0 when there are no gaps.
double spread_angle(double width_rad, std::size_t gaps, std::size_t i);

/// Sensitivity of a beam off its axis: half at its edges. @see share_on_arc
double vertical_pattern(double elevation_rad, double height_rad);

/// Elevations of a beam's rays, evenly spaced from its lower edge to its upper one.
struct Elevations {
  /// @param gaps  between them
  Elevations(double height_rad, std::size_t gaps);

  std::size_t count;
  std::vector<double> across, up;  ///< cosine and sine; behind them is room for kEndsAtOnce more
  std::vector<double> pattern;     ///< see vertical_pattern
};

/// The elevations of beams of one height, kept for each number of gaps that is not too large.
class ElevationTables {
 public:
  explicit ElevationTables(double height_rad) : height_rad_(height_rad) {}

  /// Valid until the next call.
  const Elevations& elevations_for(double apart_rad);

 private:
  static constexpr std::size_t kMaxKept = 256;  ///< gaps: some 800 KB for all
  double height_rad_;
  std::vector<std::optional<Elevations>> kept_;  ///< by gaps
  std::optional<Elevations> large_;
};

}  // namespace pingvox::detail
