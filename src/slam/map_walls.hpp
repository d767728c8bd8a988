#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pingvox/slam/distance_field.hpp"

namespace pingvox {

/// The walls of a map, for echoes to be matched with: a line at each occupied column, through those around it.
class MapWalls {
 public:
  explicit MapWalls(const DistanceField& field);

  struct Line {
    Eigen::Vector2d place_m, normal;  ///< of either sign; zero where the columns around form no line
  };
  /// The line at the occupied column that is nearest to a point; nullopt: there is none within `reach_m`, or no line.
  std::optional<Line> nearest(const Eigen::Vector2d& point_m, double reach_m) const;
  double cell_m() const { return cell_m_; }

 private:
  /// Calls visit(index of a column) for those in the squares within `reach_m` of a point.
  template <class Visit>
  void visit_near(const Eigen::Vector2d& point_m, double reach_m, Visit visit) const;

  double cell_m_;
  std::vector<Eigen::Vector2d> columns_;
  std::vector<Line> lines_;                                                ///< of each column
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> squares_;  ///< columns in each
};

}  // namespace pingvox
