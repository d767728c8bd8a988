#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "nav/internal/navigation.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "pingvox/slam/slam_calibration.hpp"
#include "slam/sweeps/echo_runs.hpp"

/// The least-squares problem of SlamSmoother: what is known, what is unknown, and the residuals with their derivatives
/// (docs/slam.md).
namespace pingvox {

/// Places of the unknowns that are not of a knot. Those of heading source n begin at heading(n): constant, sin1, cos1,
/// sin2, cos2.
namespace global {
inline constexpr std::size_t kVelocityYaw = 0, kVelocityScale = 1, kWall = 2, kSonarX = 3, kSonarY = 4, kHeadings = 5,
                             kOfHeading = 5;
inline constexpr std::size_t heading(std::size_t source) {
  return kHeadings + kOfHeading * source;
}
}  // namespace global

/// Standard deviation of an unknown that is fixed.
inline constexpr double kHeld = 1e-6;

struct Unknowns {
  /// x, y of the velocity's source [m], and the body's yaw less that of the main heading [rad].
  std::vector<Eigen::Vector3d> knots;
  Eigen::VectorXd globals;

  /// Between a knot and the next.
  Eigen::Vector3d at(std::size_t knot, double share) const {
    return knots[knot] + share * (knots[knot + 1] - knots[knot]);
  }
};

/// Prior on a heading source.
struct HeadingPrior {
  HeadingCalibration deviation;
  bool turns_with_velocity = false;  ///< same device as the velocity: turned against its mount by the same angle
};

/// An echo within the time of the knots, or one from before them.
struct PlacedEcho {
  EchoRun run;
  std::size_t sweep = 0;
  std::size_t knot = 0;  ///< before it
  double share = 0.0;    ///< of the way to the next knot, in time
  double main_yaw_rad = 0.0;
  /// From before the knots: where the velocity's source was and the body's yaw, which stay. No knot then.
  std::optional<Pose2> fixed = std::nullopt;
};

/// What is known of the first knot and the globals from knots that left the problem: half of x'Ax + b'x of what they
/// differ from where it was made.
struct WindowPrior {
  Eigen::Vector3d knot = Eigen::Vector3d::Zero();
  Eigen::VectorXd globals;
  Eigen::MatrixXd information;  ///< the knot, then the globals
  Eigen::VectorXd gradient;
};

/// What is known.
class SlamProblem {
 public:
  /// @param knot_times_s  at least two, rising, within all headings and the velocity
  /// @param headings  the main one first
  /// @param calibration  what is known of the sensors; nullopt: no more than is usual
  SlamProblem(std::vector<double> knot_times_s, VelocitySource velocity, std::vector<HeadingSource> headings,
              const std::optional<SlamCalibration>& calibration = std::nullopt);

  std::size_t knots() const { return knot_times_s_.size(); }
  std::size_t globals() const { return global::heading(headings_.size()); }
  const std::vector<double>& knot_times_s() const { return knot_times_s_; }
  const VelocitySource& velocity() const { return velocity_; }
  const std::vector<HeadingSource>& headings() const { return headings_; }
  const std::vector<HeadingPrior>& heading_priors() const { return heading_priors_; }
  double main_yaw_rad(double time_s) const { return headings_.front().yaw_rad.at(time_s); }
  /// The knot before a time, and the share of the way to the next. nullopt: outside of the knots.
  std::optional<std::pair<std::size_t, double>> between_knots(double time_s) const;

  /// Priors on the globals.
  std::vector<Estimate> global_priors() const;

  /// Dead reckoning from the origin, with the headings and the velocity corrected by their priors.
  Unknowns dead_reckoning() const;

  /// The velocity integrated over the time between two knots.
  struct Way {
    Eigen::Vector2d moved = Eigen::Vector2d::Zero();     ///< [m]
    Eigen::Vector2d weighted = Eigen::Vector2d::Zero();  ///< each part of it times its share of the time
    Eigen::Vector2d measured =
        Eigen::Vector2d::Zero();  ///< mean velocity as measured, in the frame of its source [m/s]
    double deviation_m = 0.0;     ///< of either axis
    /// The same where the error in a gap of the velocity is alike all along it. Solved is without it: knots in a gap
    /// that are as free as that are led astray by wrong pairs.
    double with_steady_m = 0.0;
  };
  std::vector<Way> ways(const Unknowns& unknowns) const;
  /// Standard deviation of the way in all gaps of the velocity that are longer than this.
  double gap_deviation_m(double longer_than_s) const;
  /// How far the integrated velocity, at a time within an interval, is off the straight line between its ends.
  Eigen::Vector2d bulge(const Unknowns& unknowns, const Way& way, std::size_t knot, double time_s) const;

  /// One weighted residual and its derivatives: by two knots that follow each other, and by the globals.
  struct Row {
    double residual = 0.0;
    std::size_t knot = 0;
    Eigen::Vector3d by_knot = Eigen::Vector3d::Zero(), by_next = Eigen::Vector3d::Zero();
    Eigen::VectorXd by_globals;
  };
  /// Priors are in a WindowPrior.
  void begin_with_prior() { has_prior_ = true; }

  /// All but the pairs: motion, headings and priors.
  std::vector<Row> rows(const Unknowns& unknowns, const std::vector<Way>& ways) const;

 private:
  struct Node {
    double time_s, share, main_yaw_rad;
    Eigen::Vector2d velocity;
  };
  /// Variance of a motion that is the same for all of a gap: grows with the square of how far a vehicle gets in it that
  /// goes ahead.
  double steady_variance_m2(const TimeSpan& gap) const;
  Row row(std::size_t knot, double residual) const;
  double deviation_rad(const Unknowns& unknowns, std::size_t source, double yaw_rad) const;
  /// Residual of a heading at a knot [rad], with derivatives by the error of the knot and the globals of the source.
  struct HeadingResidual {
    double residual_rad, by_error;
    std::array<double, global::kOfHeading> by_source;
  };
  HeadingResidual heading_residual(const Unknowns& unknowns, std::size_t source, std::size_t knot) const;

  std::vector<double> knot_times_s_;
  VelocitySource velocity_;
  std::vector<HeadingSource> headings_;
  SlamCalibration calibration_;  ///< but for its headings
  std::vector<HeadingPrior> heading_priors_;
  bool has_prior_ = false;
  std::vector<std::vector<Node>> nodes_;  ///< of each interval, both ends included
  std::vector<double> steady_m2_;         ///< of each interval: variance of a motion that is the same for all of a gap
};

}  // namespace pingvox
