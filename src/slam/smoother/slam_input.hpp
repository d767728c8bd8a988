#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "nav/internal/navigation.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/nav/time_span.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "slam/odometry/sonar_odometry.hpp"
#include "slam/smoother/slam_solver.hpp"
#include "slam/sweeps/sweep_echoes.hpp"

/// What was recorded, prepared for the least-squares problem.
namespace pingvox {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kKnotsOfSweep = 4.0;

/// Where the velocity is measured on the body. By the sonar it is the body's own.
Eigen::Vector3d place_of_velocity(const VelocitySource& velocity, const SlamOptions& options);
/// How the sonar is mounted, seen from the source of the velocity.
Pose2 velocity_from_sonar(const VelocitySource& velocity, const SlamOptions& options);

/// The source of that name and quantity; a new one where there is none yet.
NavSource& source_in(std::vector<NavSource>& sources, std::string_view name, NavQuantity quantity);
/// Adds a sample to its source, on the clock of the beams and in order of time.
/// @return kCorrupt when a number is not finite
Result<void> add_sample(std::string_view source, NavQuantity quantity, const NavSample& sample, double offset_s,
                        std::vector<NavSource>& sources);

/// The inputs of a trajectory.
struct MotionSources {
  std::vector<NavSource> measured;
  /// Motion as estimated from the sonar, in place of a measured velocity, which is then ignored.
  std::optional<SonarSources> by_sonar = std::nullopt;
};

/// What is used of the navigation, the heading with most samples first.
struct Navigation {
  VelocitySource velocity;
  std::vector<HeadingSource> headings;
  std::optional<TimeSeries> depth;
};

inline constexpr std::array kVelocityQuantities = {NavQuantity::kVelocity};

/// nullopt: no valid samples.
/// @param window  of samples by which outliers are judged
std::optional<VelocitySource> velocity_of(const NavLog& log, const SlamOptions& options,
                                          const OutlierWindow& window = {});
/// All headings, the one with the most samples first. Without any, how the turn rates turn.
/// @param by_sonar  one more heading; nullptr: none
std::vector<HeadingSource> headings_of(const NavLog& log, const SlamOptions& options,
                                       const NavSource* by_sonar = nullptr);
/// @return kUnsupported without a velocity or a heading, or when the velocity is that of no vehicle; kBadOption when a
/// mounted source is not there, or the calibration is of another velocity
Result<Navigation> navigation_of(MotionSources sources, const SlamOptions& options, const OutlierWindow& window = {});

/// @return kUnsupported where no heading is known for long while beams come
Result<void> check_headings(std::span<const HeadingSource> headings, std::span<const double> beam_times_s);

bool overlap(const TimeSpan& span, const TimeSeries& series);
tl::unexpected<Error> no_overlap(const TimeSpan& beams, const TimeSeries& series, const std::string& what);

/// What was recorded until some time.
struct SlamInput {
  std::span<const double> beam_times_s;
  std::span<const SweepEchoes> sweeps;
  Navigation navigation;
  TimeSpan span;  ///< common to all that is needed
};

/// @return kUnsupported when the times do not overlap
Result<SlamInput> slam_input_of(std::span<const double> beam_times_s, std::span<const SweepEchoes> sweeps,
                                Navigation navigation);
/// @return as navigation_of, too
Result<SlamInput> slam_input_of(std::span<const double> beam_times_s, std::span<const SweepEchoes> sweeps,
                                MotionSources sources, const SlamOptions& options);

/// Some four knots in the time of a sweep, both ends included.
/// @param beams  in this time: bounds how many knots there may be
/// @return kUnsupported when all beams have the same time; kCorrupt when their times jump
Result<std::vector<double>> knot_times(const TimeSpan& span, std::span<const SweepEchoes> sweeps, std::size_t beams);

SlamSolver solver_of(SlamProblem problem, const SlamInput& recording, const SlamOptions& options, Unknowns start,
                     Before before = {});

}  // namespace pingvox
