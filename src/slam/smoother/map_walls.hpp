#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pingvox/map/distance_field.hpp"

namespace pingvox {

/// The walls of a map, for echoes to be matched with: a line at each occupied column, through those around it. Where
/// these form no line, as in a hull, whose columns fill an area, and in piles, the line is through the outline.
class MapWalls {
 public:
  explicit MapWalls(const DistanceField& field);

  struct Line {
    Eigen::Vector2d place_m, normal;  ///< of an outline away from what it is of, else of either sign
  };
  /// The line at the occupied column that is nearest to a point, or at the nearest of an outline that is seen.
  /// @param ray  direction in which it is looked
  /// @return nullopt: there is no column within `reach_m`, or no line
  std::optional<Line> nearest(const Eigen::Vector2d& point_m, const Eigen::Vector2d& ray, double reach_m) const;
  double cell_m() const { return cell_m_; }

 private:
  /// Columns with their lines, of which the normal is zero where there is none.
  class Columns {
   public:
    explicit Columns(double square_m) : square_m_(square_m) {}
    void add(const Eigen::Vector2d& place_m);
    /// Calls visit(index of a column) for those within `reach_m` of a point.
    template <class Visit>
    void visit_near(const Eigen::Vector2d& point_m, double reach_m, Visit visit) const;

    std::vector<Eigen::Vector2d> places_m;
    std::vector<Line> lines;

   private:
    std::int32_t square_at(double m) const;

    double square_m_;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> squares_;
  };

  double cell_m_;
  Columns all_, outlines_;
};

}  // namespace pingvox
