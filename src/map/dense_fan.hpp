#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "map/kernels/lanes.hpp"
#include "map/kernels/ray_lanes.hpp"
#include "map/ray_runs.hpp"
#include "pingvox/map/scan_window.hpp"

namespace pingvox::detail {

/// What the last cells of rays say.
enum class RayEnds {
  kHit,
  kMarked,  ///< hits that are marked already
  kNothing,
};

/// What tracers of fans work in. Nothing in it means anything between fans.
struct FanRoom {
  std::vector<std::uint64_t> cells;  ///< places of those with points
  std::vector<Eigen::Vector3d> middles_m;
  RayRuns rays;
  std::vector<Eigen::Vector3d> walked_ends_m;
  std::vector<ReadyRay> ready;
  std::vector<std::uint32_t> not_ready, found;      ///< rays
  std::vector<std::uint8_t> is_touched, is_to_ask;  ///< a byte a page
  std::vector<std::uint64_t> to_ask, all_asked;     ///< pages
};

/// Marks in a window what rays from one place cross, without walking all of them where many go side by side.
///
/// There, of the rays through each square of directions the farthest is walked. Then each cell that borders on a marked
/// one is asked whether another ray may cross it; that ray is walked, too. What borders on new marks is asked in its
/// turn. In the end no ray crosses a cell without a mark: to come there it would first have to enter one that borders
/// on a marked one, and of all these none is crossed. So the cells are exactly those of walking every ray
/// (tests/map/dense_fan_test.cpp), and to ask in single precision is enough.
/// @tparam Point  Eigen::Vector3d or Eigen::Vector3f: what ends are given as
template <class Point>
class DenseFan {
 public:
  /// @param start    place of the cell where all rays begin
  /// @param squares  along each edge of a cube around it: about as many as cells lie between its far ends, an even
  ///                 number, so that the rays of a square go ahead or back along the same axes
  DenseFan(Lanes lanes, const RayFan& fan, std::uint64_t start, std::uint32_t squares, ScanWindow& window)
      : lanes_(lanes), fan_(fan), start_(start), squares_(squares), window_(window), room_(window.fan_room()) {}

  /// Marks the cells of the rays to `ends_m` [m, map frame] as missed but for their last ones.
  /// @param others  gets the numbers of rays that the window cannot take (see prepare_rays)
  /// @return how many rays it walked
  std::size_t mark(std::span<const Point> ends_m, RayEnds ends, std::vector<std::uint32_t>& others);

 private:
  /// For rays that hit. @return whether it pays; if not only hits were marked, and not all
  bool mark_dense();
  void walk_all(RayEnds ends);
  /// Their ends are marked already.
  void walk(std::span<const std::uint32_t> rays);
  /// @param number_of  of the first of these rays, the second, ...
  template <class End, class NumberOf>
  void walk_some(std::span<const End> ends_m, RayEnds ends, MissesIn where, NumberOf&& number_of);
  void walk_the_rest();
  void ask_page(std::uint64_t page);
  void ask_brick(std::uint64_t brick);
  Eigen::Vector3d corner_of(std::uint64_t place) const;

  Lanes lanes_;
  const RayFan& fan_;
  std::uint64_t start_;
  std::uint32_t squares_;
  ScanWindow& window_;
  FanRoom& room_;

  std::span<const Point> ends_m_;
  std::vector<std::uint32_t>* others_ = nullptr;
  std::size_t walked_ = 0;
};

}  // namespace pingvox::detail
