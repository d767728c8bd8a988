#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pingvox/geometry/pose2.hpp"

namespace pingvox {

/// How far from the expected pose a match is searched.
struct MatchWindow {
  int cells = 50;        ///< along each axis
  double yaw_rad = 0.0;  ///< to either side
};

struct FieldMatch {
  Pose2 pose;  ///< field_from_points
  double score = 0.0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of x, y [m], yaw [rad], from the shape of the peak
};

/// How near a place is to one of many points: 1 at a point, falling like a Gauss curve of two cells. Fixed as a raster
/// and its maxima over growing windows, so that the best pose of other points is found by branch and bound: exactly,
/// without looking at most poses (as in Hess et al., Real-Time Loop Closure in 2D LIDAR SLAM, 2016, section V).
class PointField {
 public:
  /// @param points_m  at least one, all finite
  /// @param margin_cells  how far around them poses can be searched; 0: for score() alone
  PointField(std::span<const Eigen::Vector2d> points_m, double cell_m, int margin_cells);

  /// Mean of the field at the points, 0..1.
  double score(std::span<const Eigen::Vector2d> points_m, const Pose2& pose) const;

  /// The pose with the highest score within the window around `expected`. nullopt: none is above `min_score`, or
  /// another one, farther away than the peak is wide, is nearly as good.
  std::optional<FieldMatch> match(std::span<const Eigen::Vector2d> points_m, const Pose2& expected,
                                  const MatchWindow& window, double min_score) const;

 private:
  struct Candidate {
    int yaw = 0, x = 0, y = 0;  ///< steps from the expected pose; x, y: lower corner of a block of 2^level cells
    int sum = 0;                ///< upper bound of the sum of the block's scores
  };
  /// The best candidate above `min_sum`, at least as far from `other` as a peak is wide.
  std::optional<Candidate> search(const std::vector<std::vector<Eigen::Vector2i>>& turned, int half_width_cells,
                                  int min_sum, const std::optional<Candidate>& other) const;
  int sum_at(std::span<const Eigen::Vector2i> cells, int level, int x, int y) const;
  Eigen::Matrix3d covariance_at(std::span<const Eigen::Vector2d> points_m, const Pose2& pose, double score) const;

  double cell_m_;
  Eigen::Vector2d origin_m_;  ///< lower corner of the raster
  int width_ = 0, height_ = 0;
  std::vector<std::vector<std::uint8_t>> levels_;  ///< maxima over [x, x + 2^level) x [y, y + 2^level)
};

}  // namespace pingvox
