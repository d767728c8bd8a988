#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nav/internal/step_filter.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// Poses of a moving vehicle from navigation samples as they arrive. The sources are chosen as by nav_trajectory, after
/// one second of an attitude and of a position, and kept from then on.
/// Fixes become positions relative to the first one, at the last known depth. The samples of the last minute are kept.
/// Samples behind a step that no vehicle makes are held back: where the next ones return, they are outliers; where they
/// stay for half a second, the poses go on in the new frame, and none is known between the two.
class LivePoses {
 public:
  /// Takes a sample; those that are not valid, not finite, not possible (a latitude beyond pi/2) or not later than the
  /// last one of their source are left out.
  void add(const std::string& source, NavQuantity quantity, const NavSample& sample);

  /// map_from_body; nullopt: not known (yet): a pose needs samples of each source before and after it, without a gap.
  std::optional<Pose> at(double time_s) const;
  /// Later poses may become known by further samples; earlier ones do not. nullopt: none is known so far.
  std::optional<double> known_until_s() const;

  /// Whether a valid sample came so far: of an attitude, or of a position (a fix is one).
  bool has(NavQuantity quantity) const;

  /// Names of the sources; empty: not chosen yet.
  const std::string& attitude() const { return attitude_; }
  const std::string& position() const { return position_; }

  /// A step into a new frame.
  struct NewFrame {
    std::string source;
    NavQuantity quantity = NavQuantity::kPosition;
    SourceStep step;
  };
  /// The steps of the chosen sources and of the depths of fixes since they were taken last.
  std::vector<NewFrame> take_new_frames() { return std::exchange(new_frames_, {}); }
  /// Samples of the chosen sources that were left out as outliers.
  std::size_t outliers() const;

 private:
  using Name = std::pair<std::string, NavQuantity>;
  struct Stream {
    explicit Stream(NavQuantity quantity) : filter(MotionLimits::of(quantity)) {}
    StepFilter filter;
    std::vector<NavSample> samples;  ///< the good ones of the last minute
    std::vector<double> cuts_s;      ///< between the sample at each of these times and the next one no pose is known
    double last_s = 0.0;             ///< time of the last sample, good or not
    bool is_long = false;            ///< its samples reach over kToDecide_s, or did
  };
  /// Samples of a stream on both sides of a time, or twice the one at this time.
  struct Around {
    const NavSample *before, *after;
  };

  void add_to(const Name& name, Stream& stream, const NavSample& sample, const SamplePose& pose);
  void add_depth(const std::string& source, const NavSample& sample);
  void note_new_frame(const Name& name, const SourceStep& step);
  void decide();
  static std::optional<Around> around(const Stream& stream, double time_s);

  std::map<Name, Stream> streams_;        ///< of attitudes and positions
  std::map<std::string, Stream> depths_;  ///< of each source; without samples
  std::optional<Eigen::Vector3d> first_fix_;
  std::optional<double> depth_m_;
  std::string attitude_, position_;
  std::vector<NewFrame> new_frames_;
  std::size_t long_attitudes_ = 0, long_positions_ = 0;
  std::size_t until_decision_ = 0;  ///< samples to come before sources that were never known together are tried again
};

}  // namespace pingvox
