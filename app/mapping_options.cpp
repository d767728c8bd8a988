#include "mapping_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "geometry/internal/mount_text.hpp"
#include "mapping/internal/option_limits.hpp"
#include "option_values.hpp"
#include "pingvox/analysis/cut_tree.hpp"
#include "pingvox/analysis/map_agreement.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/sonar/device_profile.hpp"
#include "sonar/internal/option_limits.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kFilters = {Choice<Filter>{"none", Filter::kNone}, Choice<Filter>{"mean", Filter::kMean},
                                 Choice<Filter>{"median", Filter::kMedian},
                                 Choice<Filter>{"gaussian", Filter::kGaussian}};
constexpr std::array kDetectors = {Choice<Detector>{"rise", Detector::kRise},
                                   Choice<Detector>{"level", Detector::kLevel}, Choice<Detector>{"max", Detector::kMax},
                                   Choice<Detector>{"canny", Detector::kCanny},
                                   Choice<Detector>{"cfar", Detector::kCfar}};
constexpr std::array kCfars = {Choice<CfarOptions::Noise>{"ca", CfarOptions::Noise::kCellAveraging},
                               Choice<CfarOptions::Noise>{"so", CfarOptions::Noise::kSmallestOf},
                               Choice<CfarOptions::Noise>{"go", CfarOptions::Noise::kGreatestOf},
                               Choice<CfarOptions::Noise>{"os", CfarOptions::Noise::kOrdered}};
constexpr std::array kShapes = {Choice<BeamShape>{"ray", BeamShape::kRay}, Choice<BeamShape>{"fan", BeamShape::kFan},
                                Choice<BeamShape>{"cone", BeamShape::kCone}};
constexpr std::array kRays = {Choice<RayAlgorithm>{"dda", RayAlgorithm::kDda},
                              Choice<RayAlgorithm>{"bresenham", RayAlgorithm::kBresenham}};
constexpr std::array kVotes = {Choice<Vote>{"sweep", Vote::kPerSweep}, Choice<Vote>{"beam", Vote::kPerBeam}};
constexpr std::array kHitsFrom = {Choice<HitFrom>{"fixed", HitFrom::kFixed},
                                  Choice<HitFrom>{"intensity", HitFrom::kIntensity}};
constexpr std::array kParents = {Choice<Parents>{"max", Parents::kMax}, Choice<Parents>{"mean", Parents::kMean}};
constexpr std::array kMatchings = {Choice<Matching>{"pairs", Matching::kPairs},
                                   Choice<Matching>{"none", Matching::kNone}};
constexpr std::array kSilents = {Choice<Silent>{"nothing", Silent::kNothing}, Choice<Silent>{"free", Silent::kFree}};

/// "T,S", "T,S,D" or "nav,S".
Take store_water(EchoArgs& args, WaterOfNav of_nav) {
  return [&args, of_nav](const std::string& text) -> Result<void> {
    constexpr std::string_view kOfNav = "nav,";
    std::array<double, 3> n{};
    args.water.reset();
    args.nav_salinity.reset();
    if (text.starts_with(kOfNav)) {
      const auto salinity = numbers_from<1>(text.substr(kOfNav.size()));
      if (!salinity) return tl::unexpected(salinity.error());
      if (const auto valid = Water{.salinity = (*salinity)[0]}.validate(); !valid) return tl::unexpected(valid.error());
      args.nav_salinity = (*salinity)[0];
      return {};
    }
    const auto three = numbers_from<3>(text);
    const auto two = numbers_from<2>(text);
    if (three) n = *three;
    if (two) n = {(*two)[0], (*two)[1], 0.0};
    if (!two && !three) {
      return usage_error(
          fmt::format("'{}': must be temperature and salinity, and the depth if it matters: T,S or T,S,D{}", text,
                      of_nav == WaterOfNav::kYes ? "; or nav,S" : ""));
    }
    const Water given{.temperature_c = n[0], .salinity = n[1], .depth_m = n[2]};
    if (const auto valid = given.validate(); !valid) return tl::unexpected(valid.error());
    args.water = given;
    return {};
  };
}

/// A number, or 'auto' for none.
template <class Number>
Take store_or_auto(std::optional<Number>& target) {
  return [&target](const std::string& text) -> Result<void> {
    if (text != "auto") return store_optional(target)(text);
    target.reset();
    return {};
  };
}

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

Take store_kernel(std::optional<int>& target) {
  const Take take = within(kFilterKernels, store_optional(target));
  return [&target, take](const std::string& text) -> Result<void> {
    if (auto taken = take(text); !taken) return taken;
    if (*target % 2 == 0) return usage_error(fmt::format("must be odd, is {}", text));
    return {};
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

/// "anywhere", or x, y, yaw, and optionally their standard deviations: metres and degrees.
Take store_start(std::optional<StartPose>& target) {
  return [&target](const std::string& text) -> Result<void> {
    target.reset();
    if (text == "anywhere") return {};
    StartPose start;
    const auto commas = std::ranges::count(text, ',');
    if (commas == 4) {
      const auto numbers = numbers_from<5>(text);
      if (!numbers) return tl::unexpected(numbers.error());
      const auto& n = *numbers;
      start = {n[0], n[1], n[2] * kDegree_rad, n[3], n[4] * kDegree_rad};
    } else if (commas == 2) {
      const auto numbers = numbers_from<3>(text);
      if (!numbers) return tl::unexpected(numbers.error());
      const auto& n = *numbers;
      start.x_m = n[0];
      start.y_m = n[1];
      start.yaw_rad = n[2] * kDegree_rad;
    } else {
      return usage_error(fmt::format("'{}': must be anywhere, X,Y,YAW or X,Y,YAW,SIGMA_M,SIGMA_DEG", text));
    }
    constexpr double kFar_m = 1e6;
    const bool is_good = std::abs(start.x_m) <= kFar_m && std::abs(start.y_m) <= kFar_m &&
                         std::isfinite(start.yaw_rad) && start.deviation_m >= 0.0 && start.deviation_m <= kFar_m &&
                         start.deviation_rad >= 0.0 && std::isfinite(start.deviation_rad);
    if (!is_good) return usage_error(fmt::format("'{}': a number is out of range", text));
    target = start;
    return {};
  };
}

}  // namespace

Take store_mount(Pose& target) {
  return [&target](const std::string& text) -> Result<void> {
    const Result<Pose> mount = mount_from(text);
    if (!mount) return tl::unexpected(mount.error());
    target = *mount;
    return {};
  };
}

Take store_pose_of(std::map<std::string, Pose>& target, std::string name) {
  return [&target, name = std::move(name)](const std::string& text) -> Result<void> {
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0) {
      return usage_error(fmt::format("'{}': must be {}=X,Y,Z,R,P,Y", text, name));
    }
    Pose pose;
    if (auto taken = store_mount(pose)(text.substr(equals + 1)); !taken) return taken;
    if (!target.emplace(text.substr(0, equals), pose).second) {
      return usage_error(fmt::format("'{}' is given twice", text.substr(0, equals)));
    }
    return {};
  };
}

Option mount_option(Pose& target) {
  return {
      "--mount",
      0,
      "X,Y,Z,R,P,Y",
      "pose of the sonar head on the vehicle: metres ahead, to port and up; roll, pitch and yaw (to port) in degrees",
      "0,0,0,0,0,0",
      store_mount(target)};
}

Option mount_option(Pose& target, bool& is_given) {
  Option option = mount_option(target);
  option.take = [take = option.take, &is_given](const std::string& text) {
    is_given = true;
    return take(text);
  };
  return option;
}

Option nav_option(Args& targets, std::string help) {
  return {"--nav", 0, "FILE", std::move(help), "", store_each(targets), Repeats::kEachCounts};
}

Option source_option(std::vector<NamedSource>& targets) {
  const Take take = [&targets](const std::string& text) -> Result<void> {
    if (text.empty()) return usage_error("must be NAME or QUANTITY=NAME");
    const std::size_t equals = text.find('=');
    const auto quantity =
        equals == std::string::npos ? std::nullopt : nav_quantity_of(std::string_view(text).substr(0, equals));
    targets.push_back(quantity ? NamedSource{text.substr(equals + 1), quantity} : NamedSource{text});
    return {};
  };
  return {"--nav-source",
          0,
          "[QUANTITY=]NAME",
          "source of navigation to use instead of others, for all its quantities or for one (position, fix, attitude, "
          "heading, velocity, depth ...); 'pingvox info' lists the sources",
          "chosen by kind and by the times they cover",
          take,
          Repeats::kEachCounts};
}

Option nav_source_option(std::vector<NamedSource>& targets) {
  Option option = source_option(targets);
  option.only_with = {{"--nav"}};
  return option;
}

Option nav_offset_option(std::optional<double>& target_s) {
  Option option{"--nav-offset",
                0,
                "S",
                "seconds to add to the times of --nav to get those of the sonar log",
                "estimated",
                within(RecordingOptions::kNavOffsets_s, store_optional(target_s))};
  option.only_with = {{"--nav"}};
  return option;
}

Option nav_mount_option(std::map<std::string, Pose>& body_from_source) {
  Option option{"--nav-mount",
                0,
                "SOURCE=X,Y,Z,R,P,Y",
                "pose of a navigation source on the vehicle, in the form of --mount; 'pingvox info' lists the sources",
                "0,0,0,0,0,0",
                store_pose_of(body_from_source, "SOURCE"),
                Repeats::kEachCounts};
  option.only_with = {{"--nav"}};
  return option;
}

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

std::vector<Option> slam_options(SlamOptions& slam, Estimation& estimation) {
  Option seed{"--seed", 0,
              "N",      "seed of the random choice of sweeps that a sweep is matched with",
              "1",      store_number(slam.seed)};
  seed.only_with = {{"--matching", {"pairs"}}};
  return {choice("--matching", kMatchings, "match pairs of echoes of different sweeps; none: dead reckoning only",
                 slam.matching),
          flag("--causal", "estimate each pose only from what was recorded before it, as on board", estimation,
               Estimation::kCausal),
          std::move(seed)};
}

Option folds_option(std::size_t& folds) {
  return {"--folds", 0,
          "N",       "parts that sweeps are dealt into; each is compared with the map of the others, 2..1000",
          "5",       within({2.0, 1000.0}, store_number(folds))};
}

std::vector<Option> locate_options(LocalizerOptions& localizer, Estimation& estimation) {
  return {flag("--causal", "estimate each pose only from what was recorded before it, as on board", estimation,
               Estimation::kCausal),
          {"--seed", 0, "N", "seed of the random numbers", "1", store_number(localizer.seed)}};
}

std::vector<Option> height_options(std::optional<double>& min_z_m, std::optional<double>& max_z_m) {
  return {{"--min-z", 0, "M", "lowest height of the map that is used", "0.5 below the sonar at the first beam",
           store_optional(min_z_m)},
          {"--max-z", 0, "M", "highest height of the map that is used", "0.5 above the sonar at the first beam",
           store_optional(max_z_m)}};
}

Option start_option(std::optional<StartPose>& start) {
  return {"--start",
          0,
          "X,Y,YAW[,SIGMA_M,SIGMA_DEG]",
          "first pose of the vehicle in metres and degrees, with standard deviations (0.5,10); or anywhere",
          "anywhere",
          store_start(start)};
}

Option use_calibration_option(std::string& target, std::string help) {
  Option option{"--use-calibration", 0, "FILE", std::move(help), "", store(target)};
  option.only_with = {{"--nav"}};
  return option;
}

Result<void> check_options(BuildOptions options) {
  options.echo.max_range_m = std::numeric_limits<double>::infinity();
  return options.validate();
}

double EchoArgs::sound_speed_ratio() const {
  if (water) return ::pingvox::sound_speed_ratio(*water);
  return sound_speed_m_s.value_or(kAssumedSoundSpeed_m_s) / kAssumedSoundSpeed_m_s;
}

Result<void> EchoArgs::validate(const std::vector<std::string>& navs) const {
  if ((water || nav_salinity) && sound_speed_m_s) return usage_error("--sound-speed and --water: exclude each other");
  if (nav_salinity && navs.empty()) {
    return usage_error("--water nav,S: needs a navigation log (--nav of 'map', 'render', 'slam' and 'locate')");
  }
  return {};
}

OptionTable::Group echo_group(EchoArgs& args, WaterOfNav water) {
  EchoOptions& echo = args.echo;
  const std::vector<std::string> beams = {std::string(kBeamLogs)};
  OptionTable::Group group = {
      "Echoes",
      {{"--min-range", 0, "M|auto", "ignore echoes nearer than M (transducer ringing); auto: measured per sweep",
        number_text(EchoOptions::kDefaultBlanking_m), within(kNearestRanges_m, store_or_auto(echo.min_range_m))},
       number("--min-bin", "N", "ignore bins before bin N (the first is 0)", echo.min_bin),
       {"--max-range", 0, "M",
        "ignore echoes and cells farther than M; a beam whose only echoes are farther marks cells up to M free", "none",
        within(kFarthestRanges_m, store_number(echo.max_range_m))},
       {"--sound-speed", 0, "M/S", "speed of sound in this water; devices assume 1500 m/s",
        number_text(kAssumedSoundSpeed_m_s),
        within(in_units_of(1.0 / kAssumedSoundSpeed_m_s, kSoundSpeedRatios), store_optional(args.sound_speed_m_s))},
       {"--water", 0, water == WaterOfNav::kYes ? "T,S[,D]|nav,S" : "T,S[,D]",
        std::string("speed of sound from temperature in degrees C, salinity (0 fresh, 35 ocean) and depth in m") +
            (water == WaterOfNav::kYes ? "; nav: temperature and depth from --nav" : ""),
        "none", store_water(args, water)},
       choice("--filter", kFilters,
              "smoothing of sweeps before echoes are detected; without it fewer beams have an echo", args.filter),
       {"--kernel", 0, "N", "size of the filter's window in beams and bins, odd", "5, canny: 11",
        store_kernel(args.kernel)},
       {"--sigma", 0, "SIGMA", "standard deviation of the Gaussian in beams and bins", "1, canny: 2.3",
        within(kFilterSigmas, store_optional(args.sigma))},
       choice("--detect", kDetectors,
              "echo detector: the first rise, the first bin above a level, the strongest bin, the first edge in the "
              "image (canny), or the first bin above the noise around it (cfar)",
              echo.detector),
       {"--threshold", 0, "T|auto", "lowest rise, level or gradient (canny) of the intensity that is an echo",
        "automatic, from the contrast of nearby beams", store_or_auto(echo.threshold)},
       choice("--cfar", kCfars, "noise estimate of cfar: cell-averaging, smallest-of, greatest-of or ordered-statistic",
              echo.cfar.noise),
       {"--background", 0, "M",
        "subtract what is the same in all sweeps up to M: echoes of the vehicle itself, and all others if it stands "
        "still; reads the logs twice",
        "off", within(kBackgroundRanges_m, store_optional(args.background_m))}}};
  for (Option& option : group.options) {
    if (option.name != "--max-range") option.only_for = beams;
    if (option.name == "--kernel") option.only_with = {{"--filter", {"mean", "median", "gaussian"}}};
    if (option.name == "--sigma") option.only_with = {{"--filter", {"gaussian"}}};
    if (option.name == "--cfar") option.only_with = {{"--detect", {"cfar"}}};
  }
  return group;
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
      {{"--poses", 0, "FILE", "trajectory of the vehicle, TUM lines 't x y z qx qy qz qw'", "the vehicle stands still",
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
