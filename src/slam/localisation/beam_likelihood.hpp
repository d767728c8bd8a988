#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "pingvox/geometry/pose2.hpp"
#include "pingvox/map/distance_field.hpp"
#include "pingvox/slam/localizer.hpp"

namespace pingvox {

/// A frame in the plane, to move many points by: the sine and cosine of its yaw are computed once. Yaws add up, not
/// wrapped.
class PlaneFrame {
 public:
  explicit PlaneFrame(const Pose2& pose)
      : place_(pose.place_m), cosine_(std::cos(pose.yaw_rad)), sine_(std::sin(pose.yaw_rad)), yaw_(pose.yaw_rad) {}

  Eigen::Vector2d turn(const Eigen::Vector2d& v) const {
    return {cosine_ * v.x() - sine_ * v.y(), sine_ * v.x() + cosine_ * v.y()};
  }
  Eigen::Vector2d operator*(const Eigen::Vector2d& point) const { return place_ + turn(point); }
  Pose2 operator*(const Pose2& pose) const { return {*this * pose.place_m, yaw_ + pose.yaw_rad}; }
  PlaneFrame inverse() const {
    return PlaneFrame(-cosine_ * place_.x() - sine_ * place_.y(), sine_ * place_.x() - cosine_ * place_.y(), cosine_,
                      -sine_, -yaw_);
  }

 private:
  PlaneFrame(double x, double y, double cosine, double sine, double yaw)
      : place_(x, y), cosine_(cosine), sine_(sine), yaw_(yaw) {}
  Eigen::Vector2d place_;
  double cosine_, sine_, yaw_;
};

/// What a beam heard, in the horizontal plane of some frame.
struct HeardBeam {
  double time_s = 0.0;
  Eigen::Vector2d sonar_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< of length 1
  double range_m = 0.0;                                  ///< of the echo; without one of the last bin
  bool has_echo = false;

  Eigen::Vector2d end_m() const { return sonar_m + range_m * direction; }
};

HeardBeam transform(const PlaneFrame& to_from, const HeardBeam& beam);

/// Log-likelihood of a beam by the value that the distance field has at its end; `more_deviation_m` is added (as
/// variances) to that of the echo, for poses that are known no better.
class EndTable {
 public:
  EndTable(const HeardBeam& beam, const DistanceField& field, const BeamLikelihood& model,
           double more_deviation_m = 0.0);
  float operator[](std::uint8_t value) const { return log_[value]; }

 private:
  std::array<float, 256> log_{};
};

/// Log-likelihood of a beam at poses of its frame, before BeamLikelihood::beam_weight.
class BeamJudge {
 public:
  BeamJudge(const HeardBeam& beam, const DistanceField& field, const BeamLikelihood& model);
  double log_likelihood(const PlaneFrame& map_from_frame) const;
  /// The same by the end of the echo alone: more where something is in between. 0 without an echo.
  double log_at_end(const PlaneFrame& map_from_frame) const {
    if (!beam_.has_echo) return 0.0;
    const Eigen::Vector2d end = map_from_frame * end_m_;
    return table_[field_.value_at(end.x(), end.y())];
  }

 private:
  const DistanceField& field_;
  HeardBeam beam_;
  Eigen::Vector2d end_m_;
  EndTable table_;
  double clear_m_;  ///< that an echo's beam must go before it may meet something
  double log_behind_, log_silent_wall_;
};

/// Weighted sum over beams.
double log_likelihood(std::span<const BeamJudge> judges, const Pose2& map_from_frame, const BeamLikelihood& model);

/// Mean likelihood of the echoes among beams, 0..1: how well they fit. nullopt: fewer than ten.
std::optional<double> fit_of(std::span<const HeardBeam> beams, const DistanceField& field, const BeamLikelihood& model,
                             const Pose2& map_from_frame);

/// Calls for the sums of many poses at once: adds to `sums` the table's value for the beam's end at each pose.
/// All spans are of one length.
void add_end_likelihood(const DistanceField& field, const EndTable& table, const Eigen::Vector2d& end_m,
                        std::span<const double> x_m, std::span<const double> y_m, std::span<const double> cosine,
                        std::span<const double> sine, std::span<float> sums);

}  // namespace pingvox
