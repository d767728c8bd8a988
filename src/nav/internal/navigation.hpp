#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/nav/time_span.hpp"

/// A vehicle's navigation, prepared for dead reckoning.
namespace pingvox {

/// How a source is mounted: the identity, if nothing is said of it.
Pose mount_of(const std::map<std::string, Pose>& body_from_source, const std::string& source);

/// Numbers over time, linear between the samples.
class TimeSeries {
 public:
  /// REQUIRES at least one sample, and times that rise strictly.
  /// @param gap_steps  a step of more than so many median ones, and of more than half a second, is a gap
  TimeSeries(std::vector<double> times_s, std::vector<double> values, double gap_steps = 5.0);

  double from_s() const { return times_s_.front(); }
  double to_s() const { return times_s_.back(); }
  std::size_t size() const { return times_s_.size(); }
  const std::vector<double>& times_s() const { return times_s_; }
  const std::vector<double>& values() const { return values_; }
  /// The first and last value go on outside.
  double at(double time_s) const;
  /// Where a stretch of time lies in gaps between samples, or outside of them.
  std::vector<TimeSpan> gaps(double from_s, double to_s) const;
  /// How long that is in the stretch, all in all.
  double gap_s(double from_s, double to_s) const;
  double longest_step_s() const;
  double usual_step_s() const { return usual_step_s_; }    ///< median; 0 of one sample
  double usual_limit_s() const { return usual_limit_s_; }  ///< longer steps are gaps

 private:
  std::vector<double> times_s_, values_;
  double usual_step_s_ = 0.0, usual_limit_s_ = 0.0;
};

/// Yaw of the body [rad] by one source, without jumps at the half turn.
struct HeadingSource {
  std::string name;
  TimeSeries yaw_rad;
  std::optional<TimeSeries> roll_rad, pitch_rad;  ///< of a source of attitude
  bool drifts = false;                            ///< the rotation of the body, from 0 at the beginning
  bool by_sonar = false;                          ///< by matching sweeps
  std::size_t left_out = 0;                       ///< few_left_out of its source

  /// By which sources are compared.
  std::size_t samples() const { return yaw_rad.size() + left_out; }
};

/// Adds a yaw as the angle that is nearest to the one before: without a jump at the half turn.
void add_yaw(double yaw_rad, std::vector<double>& yaws_rad);

/// Turned into the frame of the body by the mount. nullopt: no valid sample.
std::optional<HeadingSource> heading_source(const NavSource& source, const Pose& body_from_source);

/// A heading that drifts: the turn rate integrated. nullopt: fewer than two valid samples.
std::optional<HeadingSource> turned_heading(const NavSource& source, const Pose& body_from_source);

/// The rotation of the body by a turn rate, less its bias by a heading: a compass does not turn as the body
/// does where it deviates. Roll and pitch are the heading's. nullopt: the rate does not cover the time of the heading.
std::optional<HeadingSource> gyro_heading(const NavSource& rate, const Pose& body_from_source,
                                          const HeadingSource& heading);

/// @return kBadOption when a mount is of none of the sources
Result<void> check_mounts(const NavLog& log, const std::map<std::string, Pose>& body_from_source);

/// The heading or attitude with most samples (HeadingSource::samples), the first of equals.
/// @param body_from_source  how sources are mounted, by name; the identity for others
std::optional<HeadingSource> best_heading(const NavLog& log, const std::map<std::string, Pose>& body_from_source,
                                          const NavSource* velocity = nullptr);

/// Velocity over ground in the frame of the body [m/s], without outliers.
struct VelocitySource {
  std::string name;
  TimeSeries ahead, left;
  TimeSeries density;       ///< standard deviation of the way after one second [m / sqrt(s)]
  std::size_t clipped = 0;  ///< samples that were outliers on either axis
  bool by_sonar = false;    ///< by matching sweeps: it has no mount and no scale of its own
};

/// Which samples an outlier is judged by: itself, and those before and after it.
struct OutlierWindow {
  std::size_t before = 5, after = 5;
};

/// Per axis, samples are held within two robust standard deviations of the median of the window. The density is that of
/// the median second difference within 30 s on either side. nullopt: fewer than two valid samples.
std::optional<VelocitySource> velocity_source(const NavSource& source, const Pose& body_from_source,
                                              const OutlierWindow& window = {});

/// The only number of a source, as depth. nullopt: no valid sample.
std::optional<TimeSeries> number_source(const NavSource& source);

}  // namespace pingvox
