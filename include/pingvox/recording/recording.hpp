#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/beam_topic.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/input_file.hpp"
#include "pingvox/io/nav_fields.hpp"
#include "pingvox/io/open_log.hpp"
#include "pingvox/limits.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/mapping/head_options.hpp"
#include "pingvox/nav/clock_offset.hpp"
#include "pingvox/nav/main_source.hpp"
#include "pingvox/recording/calibration_file.hpp"
#include "pingvox/recording/nav_offset.hpp"
#include "pingvox/recording/navigation.hpp"
#include "pingvox/recording/vehicle_path.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/locate_recording.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "pingvox/sonar/background.hpp"
#include "pingvox/sonar/sound_speed.hpp"

/// What was recorded on a dive as one value, and what is made of it.
namespace pingvox {

struct RecordingOptions {
  static constexpr Limits kNavOffsets_s{-1e10, 1e10};

  std::vector<InputFile> nav = {};                            ///< navigation logs, in any order
  std::optional<double> nav_offset_s = std::nullopt;          ///< added to their times; nullopt: to be found
  std::vector<NamedSource> nav_sources = {};                  ///< of them, to use instead of others
  std::map<std::string, Pose> nav_mounts = {};                ///< body_from_source by its name; the identity for others
  std::optional<CalibrationFile> calibration = std::nullopt;  ///< of their sensors, and of the sonar's place
  /// TUM lines instead of navigation: the path, or to `locate` odometry in a frame that may drift.
  std::optional<InputFile> poses = std::nullopt;
  HeadOptions head = {};
  Pose body_from_sonar = Pose::Identity();            ///< the mount of the head
  std::optional<double> nav_salinity = std::nullopt;  ///< of water whose temperature and depth the navigation has
  std::optional<double> background_m = std::nullopt;  ///< range of the background that is subtracted; nullopt: none
  Damage damage = Damage::kSkip;
  BeamTopic topic = {};                                          ///< of beams in a ROS bag
  std::vector<NavFields> nav_fields = {};                        ///< of messages with navigation in ROS bags
  std::optional<Eigen::Vector3d> cloud_origin_m = std::nullopt;  ///< as for open_scans

  /// kBadOption: poses together with navigation, or what needs navigation without any.
  Result<void> validate() const;
};

/// A log of a recording, opened.
struct OpenedLog {
  std::string name;
  Format format = Format::kCsv;
  Log log;

  BeamSource* beams() const;  ///< nullptr: it is of scans
  ScanSource* scans() const;  ///< nullptr: it is of beams
};

/// What was recorded on one dive: logs of a sonar, the head that made them and how it is mounted, and the navigation of
/// the vehicle on the sonar's clock. Const functions read files, but change nothing; logs can be read again and again,
/// but for standard input and pipes.
class Recording {
 public:
  /// Reads the navigation, and estimates the offset of its clock to that of the first log; where that is impossible,
  /// `path`, `slam` and `locate` return the error.
  /// @param logs  of beams or scans, at least one
  /// @return kBadOption when the options do not validate; errors of reading, which name the file
  static Result<Recording> open(std::vector<InputFile> logs, RecordingOptions options = {});

  const std::vector<InputFile>& logs() const { return logs_; }
  const RecordingOptions& options() const { return options_; }
  /// The logs of navigation as one; without any it has no sources.
  const NavFiles& nav() const { return nav_; }
  /// "dive.tlog, dvl.csv"
  std::string nav_names() const;
  /// Between the clock of the navigation and that of the first log, or why it cannot be determined.
  const Result<NavOffset>& nav_offset() const { return nav_offset_; }
  /// nullopt: the ranges are as the device computes them.
  const std::optional<Water>& water() const { return water_; }

  /// Opens a log as it is.
  /// @return kUnsupported when it is no log, kBadOption for an option that does not fit it
  Result<OpenedLog> open_log(std::size_t number) const;

  /// The path of the vehicle: by the poses, else by the navigation, else at the origin all the time.
  /// @return as read_path and path_of
  Result<VehiclePath> path() const;

 private:
  Recording(std::vector<InputFile> logs, RecordingOptions options, NavFiles nav)
      : logs_(std::move(logs)), options_(std::move(options)), nav_(std::move(nav)) {}

  std::vector<InputFile> logs_;
  RecordingOptions options_;
  NavFiles nav_;
  Result<NavOffset> nav_offset_ = NavOffset{};
  std::optional<Water> water_;
};

/// The constant background near the head in each direction, learned from all logs, as each may be short.
/// @return kBadOption for standard input, which can be read only once; kUnsupported when there are too few beams
Result<Background> learn_background(const Recording& recording, double range_m);

/// Subtracts the background (RecordingOptions::background_m) from an opened log of beams, if that is set.
/// @param background  of the recording; nullopt: it is learned, and kept here for the next log
/// @return as learn_background
Result<void> subtract_background(const Recording& recording, OpenedLog& log, std::optional<Background>& background);

/// Rough upper bound of the cost of a map.
struct MapCost {
  double beams = 0.0, seconds = 0.0, bytes = 0.0;
};

/// The forecast of a map from the beginnings of the logs.
struct MapForecast {
  double resolution_m = MapOptions::kDefaultResolution_m;  ///< as asked, else by `resolution_for`
  /// The usual range of their beams, at most that of the options: of the log with the longest one; nullopt: no log of
  /// beams can be read.
  std::optional<double> range_m = std::nullopt;
  double beam_width_rad = 0.0;                 ///< of that log
  std::optional<MapCost> cost = std::nullopt;  ///< nullopt: unknown, or beams of too many cells
  /// Logs that can be opened only once, by their number: opened, and still to be read from their beginning.
  std::map<std::size_t, OpenedLog> opened = {};
};

/// Looks at the first beams of each log. A log that fails here will fail when it is mapped, where it says why.
/// @param map  its resolution, if set, is used
/// @return the error of opening a log that can be opened only once
Result<MapForecast> forecast_map(const Recording& recording, const MapOptions& map = {},
                                 const BuildOptions& build = {});

/// An empty map with the resolution of a forecast. @return as OccupancyMap::make
Result<OccupancyMap> make_map(const MapForecast& forecast, MapOptions map);

/// What was mapped of a log.
struct MappedLog {
  std::string name;
  bool has_beams = true;  ///< false: scans of points, which the report counts as beams
  BuildReport report;
  BeamModelOptions beam;      ///< as used: width and height may be those of the log's device
  bool assumes_beam = false;  ///< width or height are defaults: neither options nor log have them
  std::size_t damaged = 0;    ///< records that could not be read
  std::string first_damage;   ///< place and reason of the first one
  std::string note;           ///< where its beams are not read as its format says; empty: they are
  /// Error of the poses' clock by the rotation of the sonar image. nullopt: not observable.
  std::optional<ClockOffset> clock_check;

  bool is_nothing() const;  ///< no beam or point of it is on the map
};

/// Beams or points that are not on the map for one reason.
struct SkippedBeams {
  enum class Why { kNoPose, kBlocked, kTooLong, kOutside };
  Why why;
  LeftOut left_out;    ///< at least one
  std::string reason;  ///< "outside the time of the poses, 0.000 s to 24.000 s"
};
/// The beams or points of a log that are not on the map along `trajectory`, by reason, without damaged records.
std::vector<SkippedBeams> skipped_beams(const MappedLog& mapped, const Trajectory& trajectory, const Lattice& lattice);

/// Adds a log to a map, reading it to its end.
/// @param build  all but the size of the beam and the mount, which are the recording's
/// @return kUnsupported when the path is of navigation and the log has no times; errors of build_map
Result<MappedLog> map_log(const Recording& recording, OpenedLog& log, const VehiclePath& path,
                          const BuildOptions& build, OccupancyMap& map, const Progress& progress = {});

/// Adds what was mapped of another log. First and last time are those of all; the coverage is that of the log with most
/// sweeps.
void add(const BuildReport& log, BuildReport& all);

/// A map of a recording, and how it was made.
struct RecordingMap {
  OccupancyMap map;
  MapForecast forecast;  ///< from which its resolution follows
  BuildReport report;    ///< of all logs together
  VehiclePath path;
  std::vector<MappedLog> logs;
};

/// Maps all logs of a recording along its path (Recording::path).
/// @param map    without a resolution, that of `forecast_map` is used
/// @param build  filter, echoes, votes: size of the beam, mount, speed of sound in known water and background are the
///               recording's
/// @return kCorrupt when nothing of any log is on the map; errors of Recording::path and map_log
Result<RecordingMap> build_map(const Recording& recording, const MapOptions& map = {}, const BuildOptions& build = {},
                               const Progress& progress = {});
/// The same along another path, as that of `slam`.
Result<RecordingMap> build_map(const Recording& recording, VehiclePath path, const MapOptions& map = {},
                               const BuildOptions& build = {}, const Progress& progress = {});

/// What SLAM found in a recording.
struct RecordingSlam {
  SlamSolution solution;
  SlamOptions options;                     ///< as used
  std::size_t skipped = 0;                 ///< records that could not be read
  std::vector<NavFiles::Note> notes = {};  ///< where the logs are not read as their formats say
  double read_s = 0.0, solve_s = 0.0;      ///< of wall time
  std::size_t beams = 0;                   ///< that were read
  LeftOut no_pose = {};                    ///< of these, those outside of the time of the trajectory, or in its gaps
  /// The navigation in whose frame the trajectory lies (Recording::path); nullopt: its origin is its first pose.
  std::optional<VehiclePath::Nav> frame_of = std::nullopt;

  /// For build_map, with the estimated place of the sonar.
  VehiclePath path() const;
};

/// Where the vehicle was, by a SlamSmoother over all beams and navigation, or as on board by a CausalReplay.
/// @param options  their mount, mounts and offset of the navigation, calibration and speed of sound in known water are
///                 the recording's
/// @param first    the first log, where it was opened already: standard input is read once
/// @return as SlamSmoother::solve; kUnsupported for scans; errors of reading
Result<RecordingSlam> slam(const Recording& recording, const SlamOptions& options = {},
                           Estimation estimation = Estimation::kBatch, std::optional<OpenedLog> first = std::nullopt);

struct RecordingLocateOptions {
  LocateOptions locate = {};  ///< mount, noise and speed of sound in known water are the recording's
  /// Heights of the map that are used; nullopt: half a metre around the sonar at the first beam.
  std::optional<double> min_z_m = std::nullopt, max_z_m = std::nullopt;
  std::string map_name = "the map";  ///< for messages
};

/// Where the vehicle was in a known map.
struct RecordingLocation {
  LocatedRecording found;
  LocateOptions options;  ///< as used
  /// Names of the sources of the motion; both empty: none, or that of `RecordingOptions::poses`.
  std::string velocity, heading;
  std::vector<OtherSource> others;                     ///< sources of velocity and heading that were not used
  std::vector<SourceStep> steps;                       ///< of `RecordingOptions::poses`, that no vehicle makes
  std::size_t odometry_poses = 0;                      ///< of `RecordingOptions::poses`
  std::size_t beams = 0, skipped = 0;                  ///< skipped: records that could not be read
  double recorded_s = 0.0;                             ///< from the first to the last beam
  std::size_t field_bytes = 0;                         ///< of the distance field
  double read_s = 0.0, field_s = 0.0, locate_s = 0.0;  ///< of wall time
};

/// @param progress  called with the share that is done, in 0..1
/// @return as locate_recording; kUnsupported also when beams and navigation do not overlap in time, or the map has no
///         walls at the height of the sonar
Result<RecordingLocation> locate(const Recording& recording, const OccupancyMap& map,
                                 const RecordingLocateOptions& options = {},
                                 const std::function<void(double)>& progress = nullptr);

}  // namespace pingvox
