#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pingvox/device/head_status.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/live/live_event.hpp"
#include "pingvox/live/live_options.hpp"
#include "pingvox/map/changed_pages.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/causal_slam.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// State of a navigation device.
struct LiveNavStatus {
  LiveNav::Kind kind = LiveNav::Kind::kMavlink;
  std::string name;          ///< "mavlink:udp://127.0.0.1:14550", with the port that was chosen
  bool is_connected = true;  ///< of one that waits for others to send, always
  std::size_t connections = 0;
  std::string problem;  ///< why it is not connected
  std::size_t messages = 0, damaged = 0;
  std::optional<Error> recording_error;
  // Of topics of ROS 2.
  std::string refused;         ///< why none of the messages can be used; empty: they can
  std::string no_attitude;     ///< why messages of the last five seconds had no attitude; empty: they had
  std::size_t publishers = 0;  ///< that send at the same time; 0: at most one
  // Of those that wait for others to send.
  std::string vehicle;              ///< who is followed, as "192.168.2.2:14550 (system 1)"; empty: nobody yet
  std::size_t vehicles = 0;         ///< that were followed, one after the other
  std::size_t ignored = 0;          ///< frames of others
  std::vector<std::string> others;  ///< the first ones of them
};

/// What SLAM does.
struct LiveSlamStatus {
  LiveMotion motion = LiveMotion::kUndecided;
  std::optional<MotionReport> by;  ///< of the last solution; nullopt: none yet
  std::size_t loops = 0;           ///< closed
  std::size_t corrections = 0;     ///< how often the map was corrected
  bool is_correcting = false;      ///< a corrected map is being made
  /// Where the vehicle was located in the known map, at that time. nullopt: not yet, or there is none.
  std::optional<PoseHypothesis> located;
  // Of the last beam, where motion is from a velocity.
  double without_velocity_s = 0.0;  ///< since the last one was measured
  double deviation_m = 0.0;         ///< standard deviation of the displacement since the last solution
  /// LiveMapping::pose, however uncertain its position is: depth and heading are measured.
  std::optional<StampedPose> predicted;
};

struct LiveStatus {
  double time_s = 0.0;  ///< since the start
  HeadStatus head;
  std::size_t beams = 0;  ///< that came: mapped, not mapped and waiting
  std::size_t mapped = 0;
  std::size_t not_mapped = 0;    ///< without a pose, dropped, blocked or too long
  std::size_t waiting = 0;       ///< for their poses, or for the end of their sweep
  std::size_t without_pose = 0;  ///< of those not mapped
  std::vector<LiveNavStatus> nav;
  std::string attitude, position;      ///< sources of the poses; empty: not chosen yet
  std::size_t outliers = 0;            ///< samples of these sources that were left out
  std::size_t new_frames = 0;          ///< how often one of them went on in another frame
  std::optional<LiveSlamStatus> slam;  ///< nullopt: poses are not by SLAM
};

/// What is new since the last call, to show a run.
struct LiveChanges {
  static constexpr std::size_t kMaxBeams = 2000;

  std::vector<Beam> beams;  ///< that arrived, in order; of more than kMaxBeams the last ones
  ChangedPages::Taken map;  ///< changed parts of `map`
};

/// Maps with a sonar while it runs: drives the head, records its bytes, maps each beam at the pose of its time, from
/// the navigation devices or SLAM, and sends the nearest obstacles to an autopilot. One loop of the caller drives it,
/// and only `wait` blocks:
///
///     for (bool goes_on = true; goes_on; goes_on = live.step().value_or(false)) live.wait(1.0);
///     live.finish();
///
/// A device that is missing or falls silent is retried as long as it runs. Where recordings, navigation or the map
/// fail, the rest goes on, and an event reports it.
class LiveMapping {
 public:
  /// Seconds of a clock that never goes back.
  using Clock = std::function<double()>;

  /// Called several times a second while waiting for a publisher of the beams' topic (ROS 2); false gives up. The
  /// argument says why it takes long; empty: it does not yet.
  using KeepWaiting = std::function<bool(const std::string& problem)>;

  /// Creates the recordings and opens the devices; names of hosts are looked up in the background.
  /// @param clock         nullptr: the steady clock of the system
  /// @param keep_waiting  nullptr: ten seconds
  /// @return kBadOption when the options do not validate, kIo when a recording exists, an address is in use or
  ///         nobody publishes the topic of the beams, errors of reading a replay; no recordings are left behind then
  static Result<LiveMapping> open(const LiveOptions& options, Clock clock = nullptr,
                                  const KeepWaiting& keep_waiting = nullptr);
  LiveMapping(LiveMapping&&) noexcept;
  LiveMapping& operator=(LiveMapping&&) noexcept;
  ~LiveMapping();

  /// Waits until `step` has something to do.
  /// @param seconds  at most, and not longer than one second
  /// @param file     descriptor that ends the wait as well when it is readable; -1: none
  void wait(double seconds, int file = -1) const;

  /// Reads, records and sends what is due, and maps beams for 10 ms, at least one.
  /// @return false at the end of a replay (a head has none), an error when a replay can no longer be read; after either
  ///         false
  Result<bool> step();

  /// Stops the head and maps all beams that wait. To be called once, at the end.
  /// @return kLimit or kNoMemory of the map, which keeps the beams before
  Result<void> finish();

  /// Up to date between two calls. The beams that wait are not in it.
  /// With SLAM a corrected map takes its place in a step.
  const OccupancyMap& map() const;
  const BuildReport& report() const;  ///< of the map
  /// What the sweeps that have ended heard, and how far the head moved meanwhile; after `finish` of all of them. None
  /// with SLAM, which moves them later.
  SweepCoverage coverage() const;
  double time_s() const;        ///< since the start; beams count from there
  double since_1970_s() const;  ///< when it started, as recordings have it; 0 of a replay, which has its own times
  std::size_t beams() const;    ///< that came so far
  LiveStatus status() const;
  const std::vector<std::filesystem::path>& recordings() const;
  /// With SLAM the path of the vehicle as it is known now, after `finish` that of the map: CausalSlam::path, and after
  /// its end the beams as the map has them. It is copied. nullopt: without SLAM, or not known yet.
  std::optional<Trajectory> path() const;
  /// With SLAM, after `finish`: the poses that were estimated while it ran, from the first one at 0, 0, and a report.
  /// nullptr: none.
  const SlamSolution* slam_solution() const;

  /// Where the vehicle is, as far as it is known: by SLAM or navigation the last pose, which may be older than the last
  /// beam; without either the origin. nullopt: not known yet.
  std::optional<StampedPose> pose() const;
  /// What is new since the last call, with KeepChanges::kYes.
  LiveChanges take_changes();

  const LiveHead& head() const;  ///< as it is driven
  /// How the beams are mapped: the given options, with the beam of the head.
  const BuildOptions& build() const;
  /// Changes the settings of the head from its next request on; its address and the resolution of the map stay.
  /// @return kBadOption for bad settings, kUnsupported for a replay
  Result<void> drive(const LiveHead& head);
  /// Ends the recording of all devices, if there is one, and begins another one, in files of their own:
  /// LiveOptions::record has to be a folder. Their times are on the clock of this run.
  /// @return kBadOption where LiveOptions::record names nothing, kIo where a file exists or cannot be made
  Result<void> begin_recording();
  void end_recording();
  bool is_recording() const;  ///< of the head; also false after a recording has failed
  /// Begins a new map, with SLAM also a new path from 0, 0. Counts of beams (`status`, `report`) restart.
  /// @return the map so far, with the beams that waited for the end of their sweep; with SLAM along the path as it is
  ///         known now. kNoMemory: nothing is changed
  Result<OccupancyMap> begin_new_map();

  /// The events since the last call, in order; beyond the first thousand they are lost.
  std::vector<LiveEvent> take_events();
  /// Longest time from the arrival of a beam until the mapper was done with it, since the last call [s].
  double take_latency_s();

 private:
  class Run;
  explicit LiveMapping(std::unique_ptr<Run> run);
  std::unique_ptr<Run> run_;
};

}  // namespace pingvox
