#include "mapping_options.hpp"

#include <fmt/format.h>

#include <array>
#include <limits>
#include <string>
#include <utility>

#include "input_kinds.hpp"
#include "mapping/internal/option_limits.hpp"
#include "nav_options.hpp"
#include "option_values.hpp"
#include "pingvox/analysis/cut_tree.hpp"
#include "pingvox/analysis/map_agreement.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kShapes = {Choice<BeamShape>{"ray", BeamShape::kRay}, Choice<BeamShape>{"fan", BeamShape::kFan},
                                Choice<BeamShape>{"cone", BeamShape::kCone}};
constexpr std::array kRays = {Choice<RayAlgorithm>{"dda", RayAlgorithm::kDda},
                              Choice<RayAlgorithm>{"bresenham", RayAlgorithm::kBresenham}};
constexpr std::array kVotes = {Choice<Vote>{"sweep", Vote::kPerSweep}, Choice<Vote>{"beam", Vote::kPerBeam}};
constexpr std::array kHitsFrom = {Choice<HitFrom>{"fixed", HitFrom::kFixed},
                                  Choice<HitFrom>{"intensity", HitFrom::kIntensity}};
constexpr std::array kParents = {Choice<Parents>{"max", Parents::kMax}, Choice<Parents>{"mean", Parents::kMean}};
constexpr std::array kSilents = {Choice<Silent>{"nothing", Silent::kNothing}, Choice<Silent>{"free", Silent::kFree}};

Take store_degrees(std::optional<double>& target_rad) {
  return [&target_rad](const std::string& text) -> Result<void> {
    const Result<double> degrees = number_from<double>(text);
    if (!degrees) return tl::unexpected(degrees.error());
    target_rad = *degrees * kDegree_rad;
    return {};
  };
}

/// Text of a default that depends on the device of the log.
std::string of_device(double angle_rad) {
  return fmt::format("that of the device, else {}", number_text(angle_rad / kDegree_rad));
}

Args device_names() {
  Args names;
  for (const DeviceProfile& profile : device_profiles()) names.emplace_back(profile.name);
  return names;
}

Take store_device(const DeviceProfile*& target) {
  return [&target](const std::string& text) -> Result<void> {
    target = find_device(text);
    if (target != nullptr) return {};
    const Args known = device_names();
    return usage_error(
        fmt::format("must be {}, not '{}'{}", fmt::join(known, " or "), text, did_you_mean(text, known)));
  };
}

Take store_clamp(Clamp& target) {
  return [&target](const std::string& text) -> Result<void> {
    const auto p = numbers_from<2>(text);
    if (!p) return tl::unexpected(p.error());
    const auto& [lowest, highest] = *p;
    if (!(lowest > 0.0 && lowest < highest && highest < 1.0)) {
      return usage_error(fmt::format("'{}': must be two probabilities between 0 and 1, the smaller one first", text));
    }
    target = {LogOdds::from_probability(lowest), LogOdds::from_probability(highest)};
    return {};
  };
}

/// As in "ping360 2 x 25, micron 3 x 35": width and height of the beam of each device [degrees].
std::string beam_sizes() {
  std::string sizes;
  for (const DeviceProfile& device : device_profiles()) {
    sizes += fmt::format("{}{} {:.3g} x {:.3g}", sizes.empty() ? "" : ", ", device.name,
                         device.beam_width_rad / kDegree_rad, device.beam_height_rad / kDegree_rad);
  }
  return sizes;
}

}  // namespace

Option origin_option(std::optional<Eigen::Vector3d>& target_m) {
  const Take take = [&target_m](const std::string& text) -> Result<void> {
    const auto n = numbers_from<3>(text);
    if (!n) return tl::unexpected(n.error());
    const Eigen::Vector3d place(n->data());
    if (!place.allFinite()) return usage_error(fmt::format("'{}': must be finite", text));
    target_m = place;
    return {};
  };
  Option option{
      "--origin", 0, "X,Y,Z", "position from which a cloud was recorded, in the map frame", "0,0,0; PCD: its VIEWPOINT",
      take};
  option.only_for = {std::string(kClouds)};
  return option;
}

Option folds_option(std::size_t& folds) {
  return {"--folds", 0,
          "N",       "parts that sweeps are dealt into; each is compared with the map of the others, 2..1000",
          "5",       within({2.0, 1000.0}, store_number(folds))};
}

Result<void> check_options(BuildOptions options) {
  options.echo.max_range_m = std::numeric_limits<double>::infinity();
  return options.validate();
}

Result<void> OccupancyArgs::check(Format format) const {
  if (format != Format::kBt || (!occupied_from && !free_below)) return {};
  return usage_error(fmt::format("{}: has no effect on a .bt, which holds no probabilities, only on .ot and .pvx",
                                 occupied_from ? "--occupied" : "--free"));
}

Result<void> OccupancyArgs::validate() const {
  if (occupied_from && free_below && *free_below > *occupied_from) {
    return usage_error(fmt::format("--free: must be at most --occupied ({}), is {}", number_text(*occupied_from),
                                   number_text(*free_below)));
  }
  // It would make walls free: the usual threshold for occupied follows.
  if (free_below > 0.5 && !occupied_from) {
    return usage_error(
        fmt::format("--free: above 0.5 needs --occupied, at least as high, is {}", number_text(*free_below)));
  }
  return {};
}

Thresholds OccupancyArgs::apply_to(const Thresholds& usual) const {
  Thresholds thresholds = usual;
  if (occupied_from) thresholds.upper = LogOdds::from_probability(*occupied_from);
  if (free_below) thresholds.lower = LogOdds::from_probability(*free_below);
  if (thresholds.lower <= thresholds.upper) return thresholds;
  return occupied_from ? Thresholds{thresholds.upper, thresholds.upper}
                       : Thresholds{thresholds.lower, thresholds.lower};
}

Result<OccupancyMap> OccupancyArgs::apply_to(OccupancyMap map) const {
  const int levels = map.lattice().depth();
  if (cut_depth && *cut_depth > levels) {
    return usage_error(fmt::format("--cut-depth: must be in 1..{}, the levels of the map, is {}", levels, *cut_depth));
  }
  if (occupied_from || free_below) map = with_thresholds(map, apply_to(map.options().thresholds));
  if (cut_depth) map = cut_tree(map, *cut_depth);
  return map;
}

std::vector<Option> occupancy_options(OccupancyArgs& args) {
  return {{"--occupied", 0, "P", "lowest probability of an occupied cell", "0.5; .pvx: its own",
           within(kProbabilities, store_optional(args.occupied_from))},
          {"--free", 0, "P", "a cell is free below this probability, and unknown between the two", "0.5; .pvx: its own",
           within(kProbabilities, store_optional(args.free_below))},
          {"--cut-depth", 0, "N", "keep only the upper N levels of the octree; one less doubles the edge of a cell",
           "all", within({1.0, static_cast<double>(kMaxDepth)}, store_optional(args.cut_depth))}};
}

Result<void> BuildArgs::apply_to(RecordingArgs& recording, MapOptions& of_map, BuildOptions& of_build) const {
  if (const auto valid = echoes.validate(navs); !valid) return valid;
  const BuildOptions all = build_options();
  if (const auto valid = of_map.validate(); !valid) return valid;
  if (const auto valid = check_options(all); !valid) return valid;
  if (!poses.empty() && !navs.empty()) return usage_error("--poses and --nav: exclude each other");
  if (!poses.empty()) recording.path.poses = poses;
  recording.path.navs = navs;
  recording.path.nav_offset_s = nav_offset_s;
  recording.path.nav_sources = nav_sources;
  if (!calibration.empty()) recording.path.calibration = calibration;
  recording.body_from_sonar = all.body_from_sensor;
  recording.has_mount = has_mount;
  recording.head = head;
  recording.background_m = echoes.background_m;
  recording.nav_salinity = echoes.nav_salinity;
  of_build = all;
  return {};
}

Result<void> BuildArgs::apply_to(RecordingArgs& recording, const OccupancyArgs& occupancy, MapOptions& of_map,
                                 BuildOptions& of_build) const {
  if (const auto valid = occupancy.validate(); !valid) return valid;
  if (occupancy.cut_depth > map.depth) {
    return usage_error(
        fmt::format("--cut-depth: must be in 1..{}, the levels of the map, is {}", map.depth, *occupancy.cut_depth));
  }
  of_map = map;
  of_map.thresholds = occupancy.apply_to(map.thresholds);
  return apply_to(recording, of_map, of_build);
}

void BuildArgs::name_files(CommandFiles& files) const {
  files.read("--poses", poses);
  files.read("--nav", navs);
  files.read("--use-calibration", calibration);
}

OptionTable::Group map_group(BuildArgs& args) {
  MapOptions& map = args.map;
  BeamModelOptions& model = args.build.model;
  OptionTable::Group group = {
      "Map",
      {{"--resolution", 0, "M", "edge length of a cell",
        fmt::format("{} up to a range of 10 m, coarser beyond by the width of the beam",
                    number_text(MapOptions::kDefaultResolution_m)),
        within(kResolutions, store_optional(map.resolution_m))},
       {"--depth", 0, "N", "levels of the octree, 1..128; .bt and .ot need 16", fmt::format("{}", map.depth),
        within({1.0, static_cast<double>(kMaxDepth)}, store_number(map.depth))},
       {"--hit", 0, "P",
        "probability that a cell is occupied after one echo in it, the strongest one with --hit-from intensity",
        number_text(model.hit.probability()), within(kHits, store_probability(model.hit))},
       {"--miss", 0, "P", "probability that a cell is occupied after one beam passed through it",
        number_text(args.build.miss.probability()), within(kMisses, store_probability(args.build.miss))},
       {"--clamp", 0, "P,P", "lowest and highest probability a cell can reach",
        number_text(map.clamp.lowest.probability()) + "," + number_text(map.clamp.highest.probability()),
        store_clamp(map.clamp)},
       choice("--vote", kVotes,
              "update a cell once per sweep, at its end (a hit beats a miss), or once per beam, at once",
              args.build.vote),
       {"--memory-limit", 0, "BYTES", "fail before the map takes more memory than this, as in 512M or 2G", "none",
        store_bytes(map.memory_limit_bytes)}}};
  for (Option& option : group.options) {
    if (option.name == "--vote") option.only_for = {std::string(kBeamLogs)};
  }
  return group;
}

Option threads_option(std::size_t& target) {
  const Take take = [&target](const std::string& text) -> Result<void> {
    int threads = 0;
    if (auto taken = store_number(threads)(text); !taken) return taken;
    if (threads < 1 || threads > 256) return usage_error(fmt::format("{} is not in 1..256", text));
    target = static_cast<std::size_t>(threads);
    return {};
  };
  return {"--threads", 0, "N", "threads for tracing, 1..256; the map does not depend on it", "1", take};
}

std::vector<Option> tree_options(BuildArgs& args) {
  return {choice("--parents", kParents, "value of an inner node: maximum or mean of its children; only .pvx keeps it",
                 args.map.parents),
          threads_option(args.build.threads)};
}

OptionTable::Group sensor_group(BuildArgs& args) {
  BeamModelOptions& model = args.build.model;
  OptionTable::Group group = {
      "Sensor",
      {{"--poses", 0, "FILE", "trajectory of the vehicle, TUM lines 't x y z qx qy qz qw'", "the vehicle does not move",
        store(args.poses)},
       nav_option(args.navs,
                  "navigation log of the vehicle (MAVLink .tlog, DataFlash .BIN, NMEA, A50, ROS bag, CSV), instead of "
                  "--poses"),
       nav_source_option(args.nav_sources),
       nav_offset_option(args.nav_offset_s),
       use_calibration_option(args.calibration,
                              "correct the dead reckoning of --nav with a file of 'slam --calibration'"),
       mount_option(args.build.body_from_sensor, args.has_mount),
       choice("--beam", kShapes, "volume of a beam: its axis (2D), its width (2D), or its width and height (3D)",
              model.shape),
       {"--beam-width", 0, "DEG", "horizontal beam width, full angle", of_device(model.width_rad),
        within(in_units_of(kDegree_rad, kBeamWidths_rad), store_degrees(args.head.beam_width_rad))},
       {"--beam-height", 0, "DEG", "vertical beam width, full angle", of_device(model.height_rad),
        within(in_units_of(kDegree_rad, kBeamHeights_rad), store_degrees(args.head.beam_height_rad))},
       {"--device", 0, fmt::format("{}", fmt::join(device_names(), "|")),
        "sonar head, for the width and height of its beam in degrees: " + beam_sizes(), "as in the log",
        store_device(args.head.device)},
       {"--free-share", 0, "F", "central fraction of the beam's width and height (0..1) that marks cells free",
        number_text(model.free_share), within(kFreeShares, store_number(model.free_share))},
       choice("--ray", kRays, "traversal of cells along a ray (beams as rays, point scans)", model.ray),
       choice("--hit-from", kHitsFrom, "evidence of an echo: --hit, or half to all of it depending on the intensity",
              model.hit_from),
       choice("--silent", kSilents, "how to treat a beam without echo: ignore it, or mark it free", model.silent)}};
  for (Option& option : group.options) {
    option.only_for = {std::string(kBeamLogs)};
    if (option.name == "--poses" || option.name == "--nav" || option.name == "--nav-source" ||
        option.name == "--nav-offset" || option.name == "--use-calibration" || option.name == "--mount")
      option.only_for.emplace_back(kBagScans);
    if (option.name == "--ray")
      option.only_for = {std::string(kRayBeams), std::string(kPointLogs), std::string(kClouds)};
    if (option.name == "--beam-width" || option.name == "--free-share" || option.name == "--device")
      option.only_with = {{"--beam", {"fan", "cone"}}};
    if (option.name == "--beam-height") option.only_with = {{"--beam", {"cone"}}};
  }
  return group;
}

}  // namespace pingvox::app
