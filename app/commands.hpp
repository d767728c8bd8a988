#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "console.hpp"
#include "device/internal/head_emulator.hpp"
#include "device/internal/nav_emulator.hpp"
#include "option_table.hpp"
#include "pingvox/analysis/slice.hpp"
#include "pingvox/analysis/visible_cells.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/bag_fields.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/glb.hpp"
#include "pingvox/io/grids.hpp"
#include "pingvox/io/mcap_map.hpp"
#include "pingvox/live/live_options.hpp"
#include "pingvox/map/cast_ray.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/mapping/head_options.hpp"
#include "pingvox/nav/main_source.hpp"
#include "pingvox/recording/evaluate.hpp"
#include "pingvox/recording/fit.hpp"
#include "pingvox/recording/mosaic.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sim/nav_sensors.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sim/sonar.hpp"
#include "pingvox/sim/tank.hpp"
#include "pingvox/sim/vehicle.hpp"
#include "pingvox/slam/locate_recording.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "pingvox/sonar/device_profile.hpp"
#include "pingvox/viewer/render_cartesian.hpp"
#include "pingvox/viewer/render_echoes.hpp"
#include "pingvox/viewer/render_map.hpp"
#include "pingvox/web/readers.hpp"

/// The commands as plain values: returned by `parse_command_line`, executed by `run`. `run` returns the exit status;
/// `main` maps errors to theirs.
namespace pingvox::app {

/// --help or --version.
struct ShowText {
  OutputOptions output_options;
  std::string text;
};

/// How ROS bags are read, where the types of their messages do not determine it: --topic and --fields.
struct BagArgs {
  BeamTopic beams;
  std::vector<NavFields> nav;
  std::string file = {};  ///< that --fields names; empty: none
};

/// Interpretation of a map: thresholds for occupied and free, and the deepest level.
struct OccupancyArgs {
  std::optional<double> occupied_from = std::nullopt;  ///< lowest probability of an occupied cell; nullopt: of the map
  std::optional<double> free_below = std::nullopt;     ///< a cell is free below this probability; nullopt: of the map
  std::optional<int> cut_depth = std::nullopt;         ///< levels that are kept; nullopt: all

  /// kBadOption for thresholds on a .bt, which holds no probabilities.
  Result<void> check(Format format) const;
  /// kBadOption when they contradict each other.
  Result<void> validate() const;
  /// The thresholds that are given; of the others those of `usual`, as far as they fit.
  Thresholds apply_to(const Thresholds& usual) const;
  /// @return kBadOption when the map has fewer levels than `cut_depth`
  Result<OccupancyMap> apply_to(OccupancyMap map) const;
};

/// Where the vehicle was: at most one of the two.
struct PathArgs {
  std::optional<std::string> poses;        ///< TUM lines
  std::vector<std::string> navs;           ///< navigation logs
  std::optional<double> nav_offset_s;      ///< added to their times; nullopt: to be found
  std::vector<NamedSource> nav_sources;    ///< of them, to use instead of others
  std::optional<std::string> calibration;  ///< of their sensors: output of 'slam --calibration'
};

/// What a command reads as a recording.
struct RecordingArgs {
  std::vector<std::string> logs;  ///< "-" is standard input
  PathArgs path;
  std::map<std::string, Pose> nav_mounts;  ///< body_from_source by its name
  Pose body_from_sonar = Pose::Identity();
  bool has_mount = false;  ///< it was given
  HeadOptions head;
  std::optional<double> nav_salinity;             ///< of water whose temperature and depth the navigation log has
  std::optional<double> background_m;             ///< range of the background to subtract
  std::optional<Eigen::Vector3d> cloud_origin_m;  ///< nullopt: as the file says
  Damage damage = Damage::kSkip;
  BagArgs bag;
};

/// Many dives, each with its own navigation: --nav is a folder.
struct CampaignArgs {
  std::string kept;                       ///< folder of the maps of dives
  bool has_sum = true;                    ///< they are added to one map; else they are the output
  std::string made_with;                  ///< the program and the options that determine the maps
  std::vector<std::string> option_files;  ///< that options were read from
};

struct MapCommand {
  OutputOptions output_options;
  RecordingArgs recording;
  std::string output;  ///< "-" is standard output
  Format format = Format::kBt;
  MapOptions map;
  OccupancyArgs occupancy;  ///< of the finished map
  BuildOptions build;
  std::vector<LimitedOption> limited;
  std::string made_by;                   ///< the command line, written into the file
  std::optional<CampaignArgs> campaign;  ///< nullopt: all logs are of one dive
};

struct InfoCommand {
  OutputOptions output_options;
  std::string file;
  std::vector<LimitedOption> limited;
  Damage damage = Damage::kSkip;
  BagArgs bag;
};

struct CompareCommand {
  OutputOptions output_options;
  std::string a, b;
  std::vector<LimitedOption> limited;
  std::optional<double> layer_z_m;             ///< compare only the layer of cells at this height
  std::optional<double> occupied_probability;  ///< occupancy threshold of A
  std::optional<std::string> visible_from;     ///< poses from which the cells to find could be seen
  Pose body_from_sensor = Pose::Identity();
  ViewOptions view{.min_range_m = EchoOptions::kDefaultBlanking_m};
};

/// Where 0, 0 of a map or path is on the earth: at most one of the two.
struct OriginArgs {
  std::optional<Eigen::Vector3d> fix;  ///< as NavQuantity::kFix has it
  std::vector<std::string> navs;       ///< navigation logs that the map was made with

  bool empty() const { return !fix && navs.empty(); }
};

/// What a raster of a map shows.
enum class RasterValues { kHeights, kOccupancy };

/// Which echoes of a beam are written.
enum class EchoesOfBeam { kFirst, kAll };

struct ConvertCommand {
  OutputOptions output_options;
  std::string input, output;
  Format format = Format::kCsv;
  Damage damage = Damage::kSkip;
  BagArgs bag;
  std::optional<double> resolution_m;  ///< of a mesh's map; nullopt: the default
  OccupancyArgs occupancy;             ///< of a map
  SliceOptions slice;                  ///< of a map
  std::optional<EchoesOfBeam> echoes;  ///< the detected echoes of a log instead of its beams
  FilterOptions filter;
  EchoOptions echo;
  double sound_speed_ratio = 1.0;  ///< of the echoes
  std::optional<double> background_m;
  std::vector<NamedSource> nav_sources;  ///< that poses are made of
  std::vector<LimitedOption> limited;
  Surface surface = Surface::kHighest;
  RasterValues raster = RasterValues::kHeights;
  MeshColours colours = MeshColours::kHeight;
  OriginArgs origin;
  McapMessages messages = McapMessages::kFoxglove;
  std::string drawn_path, beams;            ///< a trajectory and a log that are written beside a map; empty: none
  Pose body_from_sonar = Pose::Identity();  ///< of these beams
};

/// Views of a picture: the first two for logs of beams, the others for maps, also of logs.
enum class PictureView { kPolar, kCartesian, kAbove, kSide, kSlice };
/// Kinds that options of 'render' may be limited to (Option::only_for), besides those of logs.
inline constexpr std::string_view kDrawnMaps = "pictures of maps",
                                  kMappedLogs = "logs drawn as maps (--view above, side, slice)";
/// "--view polar"
std::string view_kind(PictureView view);
/// What a picture shows: the first three of a log of beams, the last of the map of one.
enum class ShownImage { kRaw, kFiltered, kBackground, kAgreement };
enum class EchoMarks { kOn, kOff };

/// One of several pictures side by side.
struct PanelCommand {
  std::string input;
  std::string caption;
  std::optional<PictureView> view;  ///< nullopt: polar of a log of beams, else, and of its agreement, from above
  ShownImage image = ShownImage::kRaw;
  EchoMarks marks = EchoMarks::kOn;
  std::optional<std::size_t> sweep;  ///< from 1; nullopt: polar all, Cartesian the fullest one
  BetweenBeams between = BetweenBeams::kInterpolate;
  EchoPictureOptions echo_picture;
  MapPictureOptions map_picture;
  std::optional<MapAxes> axes;  ///< of the map; nullopt: as the map or the navigation says
  MapOptions map;               ///< for logs that are mapped
  OccupancyArgs occupancy;      ///< of the map that is drawn
  BuildOptions build;
  RecordingArgs recording;               ///< its log is `input`
  std::vector<std::string> drawn_paths;  ///< trajectories drawn over a map
};

struct RenderCommand {
  OutputOptions output_options;
  std::string output, title;
  Damage damage = Damage::kSkip;
  BagArgs bag;
  std::vector<PanelCommand> panels;    ///< at least one
  std::vector<LimitedOption> limited;  ///< to views: "--view polar", "logs drawn as maps"
};

/// Whether a browser is opened at the address of a page.
enum class OpenBrowser { kYes, kNo };

struct ViewCommand {
  OutputOptions output_options;
  std::vector<std::string> files;        ///< at least one, of any kind; "-" is standard input
  std::optional<std::string> export_to;  ///< a page in one file instead of a server
  std::string address = "127.0.0.1";     ///< of this machine, at which the page is served
  int port = 0;                          ///< 0: any that is free
  web::Readers readers = web::Readers::kWithToken;
  OpenBrowser browser = OpenBrowser::kYes;
  RecordingArgs recording;  ///< its logs are among the files
  MapOptions map;           ///< of logs that are mapped, and of meshes
  OccupancyArgs occupancy;  ///< of all maps
  BuildOptions build;
  CountCells agreement = CountCells::kNo;  ///< of the cells of a map with echoes that were held out of it
  std::vector<LimitedOption> limited;
};

struct MosaicCommand {
  OutputOptions output_options;
  RecordingArgs recording;
  std::string output;  ///< "-" is standard output
  Format format = Format::kPng;
  RecordingMosaicOptions mosaic;
  std::optional<PictureUp> up;         ///< of a PNG; nullopt: ahead of a head that stands still, else y
  double gamma = 0.5;                  ///< of a PNG
  std::optional<Eigen::Vector3d> fix;  ///< of a GeoTIFF, where 0, 0 is; nullopt: as the navigation says
};

struct SimulateCommand {
  OutputOptions output_options;
  std::string output;
  std::string world;  ///< tank, harbour, seabed, cave, or the file of a mesh
  TankOptions tank;
  SonarOptions sonar;
  std::optional<double> range_m;       ///< range of the bins; nullopt: that of the world, or of `sonar`
  std::optional<double> bin_length_m;  ///< alternative to range_m
  Motion motion = Motion::kStill;
  std::optional<std::string> poses;  ///< trajectory instead of a built-in route
  TravelOptions travel;
  DriftOptions drift;
  std::optional<std::size_t> turns;  ///< nullopt: for the whole route
  std::optional<std::string> nav;    ///< file for the navigation measurements
  NavSensorOptions nav_sensors;
  std::optional<std::string> truth;          ///< folder for the ground truth
  std::optional<double> truth_resolution_m;  ///< else by the world
};

struct SlamCommand {
  OutputOptions output_options;
  RecordingArgs recording;
  std::string output;  ///< TUM lines; "-" is standard output
  std::optional<std::string> map, calibration, covariance, graph;
  Format map_format = Format::kBt;
  MapOptions map_options;  ///< these two of the map
  BuildOptions build;      ///< but for filter, echoes and speed of sound, which are those of `slam`
  SlamOptions slam;
  Estimation estimation = Estimation::kBatch;
  std::vector<LimitedOption> limited;
  std::string made_by;  ///< the command line, written into the map
};

/// Which poses `locate` writes.
enum class WrittenPoses {
  kAll,   ///< also those that are the most likely of several, or do not fit
  kSure,  ///< those that are known to be right
};

struct LocateCommand {
  OutputOptions output_options;
  RecordingArgs recording;  ///< its poses are odometry, in a frame that may drift
  std::string map;
  std::string output;                      ///< TUM lines; "-" is standard output
  std::optional<StartPose> start;          ///< nullopt: anywhere
  std::optional<double> min_z_m, max_z_m;  ///< heights of the map that are used; nullopt: near the sonar's
  LocalizerOptions localizer;
  Estimation estimation = Estimation::kBatch;  ///< of the poses by navigation
  WrittenPoses written = WrittenPoses::kAll;
};

struct EvaluateCommand {
  OutputOptions output_options;
  RecordingArgs recording;
  EvaluateOptions evaluation;
  std::optional<FitParameter> fit;  ///< parameter to estimate; nullopt: none
  std::vector<LimitedOption> limited;
};

struct MergeCommand {
  OutputOptions output_options;
  std::vector<std::string> maps;       ///< at least one
  std::map<std::string, Pose> at;      ///< where the maps of these names lie in the result; the others as they are
  std::optional<double> resolution_m;  ///< nullopt: that of the map with the largest cells
  std::string output;                  ///< "-" is standard output
  Format format = Format::kBt;
  std::string made_by;  ///< the command line, written into the file
};

/// The query of a map, for each of some places.
enum class Question { kPoint, kRay, kNearest, kClearance, kRegion };

struct QueryCommand {
  OutputOptions output_options;
  std::string map;
  Question question = Question::kPoint;
  std::vector<std::vector<double>> places;                       ///< the numbers of each
  bool reads_places = false;                                     ///< more of them, a line each, from standard input
  double max_range_m = std::numeric_limits<double>::infinity();  ///< of rays, and of what is near
  UnknownCells unknown = UnknownCells::kPass;                    ///< to rays
  OccupancyArgs occupancy;
};

/// Where a page is served.
struct PageAddress {
  std::string address;
  int port = 0;  ///< 0: any that is free
};

struct LiveCommand {
  OutputOptions output_options;
  LiveOptions live;
  std::string output;
  Format format = Format::kBt;
  std::size_t max_beams = 0;  ///< stop after them; 0: never
  double write_every_s = 10.0;
  std::optional<std::string> poses;  ///< file of the final path
  std::optional<PageAddress> view;   ///< nullopt: no page
  web::Readers readers = web::Readers::kWithToken;
  std::string made_by;  ///< the command line, written into the file
};

struct EmulateCommand {
  enum class Device { kPing360, kMicron, kMavlink, kA50 };
  OutputOptions output_options;
  Device device = Device::kPing360;
  std::string line;  ///< to listen at; of kMavlink to send to
  std::string world = "tank";
  Motion motion = Motion::kStill;
  double speed_m_s = 0.25;
  HeadEmulatorOptions head;
  NavEmulatorOptions nav;
  double no_bottom_s = 0.0;   ///< at the end of each minute, of a DVL; 0: it always has the bottom
  std::size_t max_pings = 0;  ///< end after them; 0: never
};

/// Runs the program `pingvox-bench` with these arguments.
struct BenchCommand {
  OutputOptions output_options;
  std::vector<std::string> args;
};

using Command = std::variant<ShowText, MapCommand, InfoCommand, CompareCommand, ConvertCommand, RenderCommand,
                             MosaicCommand, SimulateCommand, SlamCommand, LocateCommand, EvaluateCommand, MergeCommand,
                             QueryCommand, LiveCommand, EmulateCommand, ViewCommand, BenchCommand>;

Result<int> run(const MapCommand& command, Console& console);
Result<int> run(const InfoCommand& command, Console& console);
Result<int> run(const CompareCommand& command, Console& console);
Result<int> run(const ConvertCommand& command, Console& console);
Result<int> run(const RenderCommand& command, Console& console);
Result<int> run(const MosaicCommand& command, Console& console);
Result<int> run(const SimulateCommand& command, Console& console);
Result<int> run(const SlamCommand& command, Console& console);
Result<int> run(const LocateCommand& command, Console& console);
Result<int> run(const EvaluateCommand& command, Console& console);
Result<int> run(const MergeCommand& command, Console& console);
Result<int> run(const QueryCommand& command, Console& console);
Result<int> run(const LiveCommand& command, Console& console);
Result<int> run(const EmulateCommand& command, Console& console);
Result<int> run(const ViewCommand& command, Console& console);
Result<int> run(const BenchCommand& command, Console& console);

}  // namespace pingvox::app
