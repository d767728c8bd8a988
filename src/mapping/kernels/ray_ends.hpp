#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

/// The cells where many rays of the same length end, several at a time.
namespace pingvox::detail {

/// Where a cell is that a ray ends in: its page, counted from a lowest one, above the number of the cell in its page.
inline constexpr int kCellBits = 12;
inline constexpr int kPlaceBits = 17;  ///< of a page along each axis
inline constexpr std::uint64_t kNoPlace = ~std::uint64_t{0};

/// Where rays of one length end, and where places begin.
struct RayEnds {
  std::array<std::array<double, 4>, 3> map_from_sensor{};  ///< rows of the transform [m]
  double range_m = 0.0;
  double cells_per_m = 0.0;
  std::array<std::int64_t, 3> lowest{};  ///< of the lattice's cells, counted from its middle: the lowest with a place
  /// Cells of the lattice that have a place: lowest <= inside_from <= cell < inside_to.
  std::array<double, 3> inside_from{}, inside_to{};
};

/// Finds the place of each ray's end; kNoPlace where it has none, and for no numbers. The end of ray i is, with the
/// same rounding, that of `map_from_sensor * (direction * range_m)` for the direction (across[i] * way_x, across[i] *
/// way_y, up[i]). REQUIRES room for kEndsAtOnce rays more than there are, in all three
inline constexpr std::size_t kEndsAtOnce = 8;
void find_ends(const RayEnds& ends, double way_x, double way_y, std::span<const double> across, const double* up,
               std::uint64_t* places);

}  // namespace pingvox::detail
