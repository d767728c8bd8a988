#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "map/kernels/lanes.hpp"
#include "map/kernels/ray_aims.hpp"
#include "map/kernels/ray_lanes.hpp"

namespace pingvox::detail {

/// Rays from one place, by the squares of a cube around it that they leave through: finds those that may cross a cell.
/// Neighbours mostly go through the same square, so they are kept as runs of such.
class RayRuns {
 public:
  /// Forgets all rays and keeps the memory. To be called first.
  /// @param fan      must live as long as it is asked
  /// @param squares  along an edge of the cube
  void begin(Lanes lanes, const RayFan& fan, std::uint32_t squares);

  /// Takes in the next `count` rays.
  void add(const AimedRays& aimed, std::size_t count);
  /// To be called when all are in, before any is taken out.
  void sort();

  std::size_t rays() const { return rays_; }
  std::size_t runs() const { return runs_.size(); }
  /// Squares that rays go through.
  std::size_t squares() const { return squares_.size(); }
  /// Edges of these squares beyond which there is none on the same face.
  std::size_t border() const;
  /// Rays without a square.
  std::span<const std::uint32_t> outside() const { return outside_; }

  /// Takes one of the farthest rays out of each square. @param taken  becomes their numbers
  void take_one_of_each_square(std::vector<std::uint32_t>& taken);
  /// Takes out a ray for each of some cells of a brick that may cross it, where there is one.
  /// @param lowest  corner of the brick as seen from where the rays begin [cells]
  /// @param cells   a bit each
  /// @param ends_m  where all rays end
  /// @param taken   gets the rays' numbers
  /// @return the cells that surely none crosses
  template <class Point>
  std::uint64_t take_some_across(const Eigen::Vector3d& lowest, std::uint64_t cells, std::span<const Point> ends_m,
                                 std::vector<std::uint32_t>& taken);
  /// Whether any ray, also one that was taken out, may cross a cube of cells. @param edge  [cells]
  bool may_cross(const Eigen::Vector3d& lowest, double edge) const;

 private:
  static constexpr std::uint32_t kFaces = 6;
  struct Run {
    Aim bounds;               ///< the least of its rays' aims
    std::uint32_t taken = 0;  ///< bit i: ray first + i was taken out
    std::uint32_t first, count;
  };
  struct Square {
    Aim bounds;
    std::uint32_t number;
    std::uint32_t begin, end;  ///< its runs
  };
  /// Columns first..last of a row of squares that rays go through.
  struct Columns {
    std::uint32_t first = std::numeric_limits<std::uint32_t>::max(), last = 0;
  };
  /// A cube of cells as rays come to it through one face.
  struct View {
    CellAhead cube;
    Aim most;                                                      ///< their aims are nowhere greater
    std::uint32_t first_row, last_row, first_column, last_column;  ///< squares of their aims
  };
  /// What is to be looked at for a cell: the runs of a square, then the rays of a run.
  struct SquareToAsk {
    View cell;
    const Square* square;
    std::uint32_t number;  ///< of the cell in its brick
  };
  struct RunToAsk {
    CellAhead cell;
    std::uint32_t run;
    std::uint32_t number;
  };

  void add_run(std::uint32_t square, const Run& run);
  /// A cube of cells through a face; nullopt: no ray through it comes there.
  std::optional<View> view(std::uint32_t face, const Eigen::Vector3d& lowest, double edge) const;
  /// Calls f(square) for the squares with rays that may come into view, until it returns true.
  template <class F>
  bool any_square(const View& view, F&& f) const;
  bool may_cross(std::uint32_t face, const Eigen::Vector3d& lowest, double edge) const;

  Lanes lanes_ = Lanes::kOne;
  const RayFan* fan_ = nullptr;
  std::uint32_t per_edge_ = 1;
  std::size_t rays_ = 0;
  std::vector<std::uint32_t> outside_;
  std::array<Aim, kFaces> faces_;     ///< bounds of their squares
  std::vector<Columns> columns_;      ///< of each row of each face
  std::vector<std::uint32_t> index_;  ///< of each square in squares_, plus one; 0: no ray goes through it
  std::vector<Square> squares_;
  std::vector<Run> runs_;  ///< by squares, once they are sorted
  std::vector<Run> sorted_;
  std::vector<std::uint32_t> square_of_run_;  ///< in squares_, until then
  std::vector<SquareToAsk> squares_to_ask_;
  std::vector<RunToAsk> runs_to_ask_;
};

}  // namespace pingvox::detail
