#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cloud/scan_window.hpp"

/// Rays into a ScanWindow, as many side by side as the machine's vectors have lanes. Their cells are
/// those of FaceCrossings (geometry/ray_dda.hpp), to the last one: the same sums of the same whole numbers
/// (tests/cloud/ray_kernels_test.cpp).
namespace pingvox::detail {

/// Where the window lies, in cells as the lattice counts them: cell 0 has its lowest corner at the origin of the map.
struct RayGrid {
  double cells_per_m = 1.0;
  std::array<std::int64_t, 3> lowest{};  ///< lowest cell of the window
  /// Coordinates that are in the window and in the lattice: inside_from <= coordinate < inside_to.
  std::array<double, 3> inside_from{}, inside_to{};
};

inline constexpr std::uint64_t kNoPlace = ~std::uint64_t{0};

/// Rays ready to be walked, an array for each number. Faces lie where FaceCrossings has them, in units of 2^-62 of the
/// ray's length.
struct PreparedRays {
  std::array<std::vector<std::int64_t>, 3> next;   ///< the first face along each axis; kNever: none
  std::array<std::vector<std::int64_t>, 3> apart;  ///< from face to face
  std::vector<std::int64_t> left;                  ///< faces to cross; 0 where the ray is not ready, too
  std::vector<std::int64_t> ahead;                 ///< bit a is set when the key grows along axis a
  std::vector<std::uint64_t> start;                ///< place of the first cell
  std::vector<std::uint64_t> end;                  ///< of the last one; kNoPlace: the ray is not ready
  std::size_t count = 0;
};

/// Prepares the rays from `from_m[i]` to `to_m[i]` [m, map frame]. Not ready are those with an end outside of the
/// window or in no number, that cross too many faces, or that end so close to a corner that only exact counting tells
/// which face comes last. REQUIRES as many beginnings as ends
void prepare_rays(const RayGrid& grid, std::span<const Eigen::Vector3d> from_m, std::span<const Eigen::Vector3d> to_m,
                  PreparedRays& rays);
void prepare_rays(const RayGrid& grid, std::span<const Eigen::Vector3d> from_m, std::span<const Eigen::Vector3f> to_m,
                  PreparedRays& rays);

/// Finds the places of the cells that hold points [m, map frame]; kNoPlace outside of the window.
void find_places(const RayGrid& grid, std::span<const Eigen::Vector3d> points_m, std::vector<std::uint64_t>& places);
void find_places(const RayGrid& grid, std::span<const Eigen::Vector3f> points_m, std::vector<std::uint64_t>& places);

/// Marks the cells of each ray that is ready as missed, its first one included, its last one not.
void mark_rays(const PreparedRays& rays, ScanWindow& window);

}  // namespace pingvox::detail
