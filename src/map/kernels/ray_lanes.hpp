#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "map/kernels/lanes.hpp"
#include "pingvox/geometry/key.hpp"
#include "pingvox/map/ray_dda.hpp"
#include "pingvox/map/scan_window.hpp"
#include "pingvox/map/trace_ray.hpp"

/// Rays from one place, several at a time, into the bit masks of a ScanWindow. The cells are those of FaceCrossings, to
/// the last one: the same sums of the same whole numbers (tests/map/ray_lanes_test.cpp).
namespace pingvox::detail {

/// Where the window lies and where rays begin, in cells as the lattice counts them: cell 0 has its lowest corner at the
/// origin of the map.
struct RayFan {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< metres times cells per metre
  double cells_per_m = 1.0;
  std::array<std::int64_t, 3> window_lowest{};  ///< lowest cell of the window
  /// Cells that are in the window and in the lattice: lowest <= floor(coordinate) <= highest.
  std::array<double, 3> lowest{}, highest{};
};

/// One ray, ready to be walked: where it crosses the faces of cells in units of 2^-62 of its length (FaceCrossings).
struct alignas(64) ReadyRay {
  std::array<std::int64_t, 3> next, apart;
  std::uint32_t left;   ///< faces to cross
  std::uint32_t ahead;  ///< bit a is set when the key grows along axis a
  std::uint64_t end;    ///< place of its last cell in the window
};

/// Prepares rays to `ends_m` [m, map frame].
/// @tparam Point   Eigen::Vector3d or Eigen::Vector3f
/// @param others   gets the numbers of all others: outside of the window, no numbers, too many faces, or so close to a
///                 corner at their end that only exact counting tells which face comes last
template <class Point>
void prepare_rays(Lanes lanes, const RayFan& fan, std::span<const Point> ends_m, std::vector<ReadyRay>& ready,
                  std::vector<std::uint32_t>& others);

/// Finds the places in the window of the cells that hold points [m, map frame]. Of points in a row that share their
/// cell it is there once.
/// @tparam Point   Eigen::Vector3d or Eigen::Vector3f
/// @param places   as many as are returned mean something
/// @param outside  gets the numbers of points outside of the window
/// @return how many
/// REQUIRES room for kWrittenBeyond more places than there are points
inline constexpr std::size_t kWrittenBeyond = 16;
template <class Point>
std::size_t find_cells(Lanes lanes, const RayFan& fan, std::span<const Point> points_m, std::span<std::uint64_t> places,
                       std::vector<std::uint32_t>& outside);

/// Middles [m, map frame] of cells at places in the window.
/// REQUIRES as many middles as there are places
void find_middles(Lanes lanes, const RayFan& fan, double resolution_m, std::span<const std::uint64_t> places,
                  std::span<Eigen::Vector3d> middles_m);

/// Where rays leave their marks.
enum class MissesIn {
  kMask,        ///< ScanWindow::missed
  kMaskOrLayer  ///< or ScanWindow::layer, if many walk side by side and none leaves the layer where they begin
};

/// Marks the cells of each ray as missed, its first one included, its last one not.
/// @param start  place of the cell where all of them begin; the same as that of others in the window's layer
void mark_rays(Lanes lanes, std::span<const ReadyRay> rays, std::uint64_t start, MissesIn where, ScanWindow& window);

/// A lattice of 16 levels at most, where rays begin and end anywhere.
struct KeyGrid {
  double cells_per_m = 1.0;
  double half = 32768.0;  ///< cells from its centre to its border
};

/// Prepares one ray for each segment; `end` becomes the key where it begins: 16 bits a component, x in the lowest.
/// @param others  gets the numbers of those that are not ready (as above, or outside of the lattice); `left` is 0 then
/// REQUIRES ready.size() == segments.size()
void prepare_rays(Lanes lanes, const KeyGrid& grid, std::span<const Segment> segments, std::span<ReadyRay> ready,
                  std::vector<std::uint32_t>& others);

/// Writes the keys of each ray, its first one included, its last one not: ray i from keys[i] on.
/// REQUIRES rays made ready for a KeyGrid, and room for one key more than the faces of each
void write_keys(Lanes lanes, std::span<const ReadyRay> rays, std::span<Key* const> keys);

}  // namespace pingvox::detail
