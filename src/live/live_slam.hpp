#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "live/map_locator.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/live/live_event.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/mapping/rebuilt_map.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/causal_slam.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Poses of beams by CausalSlam, and the map along them. The sources of the motion are chosen once, after some seconds
/// of beams, or half a minute where a navigation device has sent nothing yet; samples are kept until then. Where a
/// later solution corrects the path, the map is rebuilt in the background. In a known map the vehicle is located
/// first: until then no pose is known.
class LiveSlam {
 public:
  /// The map in which the vehicle is located, and which is extended.
  struct KnownMap {
    OccupancyMap map;
    std::string name;
    std::optional<StartPose> start;
  };
  /// @param options  its motion is found; mount, filter, echoes and speed of sound are those of `build`
  /// @param devices  of the navigation; 0: does not wait
  static Result<LiveSlam> make(SlamOptions options, std::size_t devices, const BuildOptions& build,
                               const MapOptions& map);
  /// The same in a known map.
  static Result<LiveSlam> make(SlamOptions options, std::size_t devices, const BuildOptions& build, KnownMap known);

  /// Takes a sample of a source of a device, by its number.
  void add(std::size_t device, const std::string& source, NavQuantity quantity, const NavSample& sample);

  /// Whether samples of a beam's time may still come, or the sources of the motion are not chosen yet.
  bool may_come(double beam_s, double now_s) const;
  /// Takes the next beam, and maps it where its pose is known.
  /// @return errors of the map; a failure of SLAM is an event
  Result<void> add(Beam beam, double now_s);
  /// Corrects the map where that is due, or takes over the corrected one. @return as `add`
  Result<void> update(double now_s);
  /// Maps what waits, and corrects the map by the final path. @return as `add`, and of SLAM when it found no path
  Result<void> finish();

  /// As RebuiltMap::track.
  void track(ChangedPages* changes) { map_.track(changes); }

  const OccupancyMap& map() const { return map_.map(); }
  const BuildReport& report() const { return map_.report(); }
  /// The last pose that is known, as far as beams are mapped by such.
  std::optional<StampedPose> pose() const;
  /// The path of the map; nullopt: not known yet.
  std::optional<Trajectory> path() const;
  /// After `finish`: the poses that were estimated.
  const std::optional<SlamSolution>& solution() const { return solution_; }
  LiveSlamStatus status() const;
  std::vector<LiveEvent> take_events() { return std::exchange(events_, {}); }

 private:
  /// The samples of a source, as far as they wait, and the time of its last one.
  struct Source {
    std::size_t device = 0;
    NavSource waiting;
    double last_s = 0.0;
  };
  /// A beam of the window, where it is in the map.
  struct MappedBeam {
    double time_s = 0.0;
    std::optional<Pose> map_from_body;
  };

  LiveSlam(SlamOptions options, std::size_t devices, RebuiltMap map);
  Source& source_of(std::size_t device, const std::string& name, NavQuantity quantity);
  void decide();
  std::optional<Pose> pose_at(double beam_s);
  void note_velocity(const PredictedPose& pose);
  void note_failure(const Error& error);
  void compare_with_solution();
  void locate(const std::vector<StampedPose>& newest);
  bool is_located() const { return !locator_; }
  Pose in_map(const Pose& slam_from_body) const;
  std::optional<Trajectory> estimated_path() const;
  Result<void> correct(const Trajectory& path);
  Trajectory with_last_beams(const Trajectory& path) const;

  SlamOptions options_;
  std::vector<bool> has_sent_;  ///< whether each navigation device has sent anything
  double cell_m_;
  RebuiltMap map_;
  std::string map_name_;               ///< of the known map
  std::optional<MapLocator> locator_;  ///< until the vehicle is located in the known map
  std::optional<Pose> map_from_slam_;  ///< nullopt: no known map, or not located
  LiveSlamStatus status_;              ///< of the map, the last beam and corrections
  std::vector<Source> sources_;        ///< by their devices, then as they first spoke
  std::optional<CausalSlam> slam_;     ///< nullopt: the sources of the motion are not chosen yet
  std::deque<MappedBeam> mapped_;      ///< those that solutions may still move
  std::size_t solutions_ = 0;          ///< that the map was compared with
  double moved_m_ = 0.0;               ///< how far the last solution moved a beam of the map
  bool is_outdated_ = false, is_correcting_ = false;
  double corrected_s_ = 0.0;  ///< when the last correction began
  double may_correct_s_ = 0.0;
  std::optional<Trajectory> path_;  ///< the final one
  std::optional<SlamSolution> solution_;
  bool has_failed_ = false, is_without_velocity_ = false, is_uncertain_ = false;
  std::vector<LiveEvent> events_;
};

}  // namespace pingvox
