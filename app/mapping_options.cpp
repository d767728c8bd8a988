#include "mapping_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "option_values.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kFilters = {Word<Filter>{"none", Filter::kNone}, Word<Filter>{"mean", Filter::kMean},
                                 Word<Filter>{"median", Filter::kMedian}, Word<Filter>{"gaussian", Filter::kGaussian}};
constexpr std::array kDetectors = {Word<Detector>{"rise", Detector::kRise}, Word<Detector>{"level", Detector::kLevel},
                                   Word<Detector>{"max", Detector::kMax}, Word<Detector>{"canny", Detector::kCanny},
                                   Word<Detector>{"cfar", Detector::kCfar}};
constexpr std::array kCfars = {Word<CfarOptions::Noise>{"ca", CfarOptions::Noise::kCellAveraging},
                               Word<CfarOptions::Noise>{"so", CfarOptions::Noise::kSmallestOf},
                               Word<CfarOptions::Noise>{"os", CfarOptions::Noise::kOrdered}};
constexpr std::array kShapes = {Word<BeamShape>{"ray", BeamShape::kRay}, Word<BeamShape>{"fan", BeamShape::kFan},
                                Word<BeamShape>{"cone", BeamShape::kCone}};
constexpr std::array kRays = {Word<RayAlgorithm>{"dda", RayAlgorithm::kDda},
                              Word<RayAlgorithm>{"bresenham", RayAlgorithm::kBresenham}};
constexpr std::array kVotes = {Word<Vote>{"sweep", Vote::kPerSweep}, Word<Vote>{"beam", Vote::kPerBeam}};
constexpr std::array kHitsFrom = {Word<HitFrom>{"fixed", HitFrom::kFixed},
                                  Word<HitFrom>{"intensity", HitFrom::kIntensity}};
constexpr std::array kSilents = {Word<Silent>{"nothing", Silent::kNothing}, Word<Silent>{"free", Silent::kFree}};

Take into_sound_speed_ratio(double& ratio) {
  return [&ratio](const std::string& text) -> Result<void> {
    const Result<double> speed = number_from<double>(text);
    if (!speed) return tl::unexpected(speed.error());
    if (!(*speed > 0.0) || !std::isfinite(*speed)) return off(fmt::format("{} is no speed above 0", text));
    ratio = *speed / kAssumedSoundSpeed_m_s;
    return {};
  };
}

Take into_min_range(std::optional<double>& target) {
  return [&target](const std::string& text) -> Result<void> {
    if (text != "auto") return into_optional(target)(text);
    target.reset();
    return {};
  };
}

Take into_degrees(std::optional<double>& target_rad) {
  return [&target_rad](const std::string& text) -> Result<void> {
    const Result<double> degrees = number_from<double>(text);
    if (!degrees) return tl::unexpected(degrees.error());
    target_rad = *degrees * kDegree_rad;
    return {};
  };
}

/// A default that a log's device may change.
std::string of_device(double angle_rad) {
  return fmt::format("that of the device, else {}", shown(angle_rad / kDegree_rad));
}

std::string device_names(std::string_view between) {
  Words names;
  for (const DeviceProfile& profile : device_profiles()) names.emplace_back(profile.name);
  return fmt::format("{}", fmt::join(names, between));
}

Take into_device(const DeviceProfile*& target) {
  return [&target](const std::string& text) -> Result<void> {
    target = device_named(text);
    if (target == nullptr) return off(fmt::format("must be {}, not '{}'", device_names(" or "), text));
    return {};
  };
}

Take into_kernel(std::optional<int>& target) {
  const Take take = within({1.0, 99.0}, into_optional(target));
  return [&target, take](const std::string& text) -> Result<void> {
    if (auto taken = take(text); !taken) return taken;
    if (*target % 2 == 0) return off(fmt::format("must be odd, is {}", text));
    return {};
  };
}

Take into_clamp(Clamp& target) {
  return [&target](const std::string& text) -> Result<void> {
    const auto p = numbers_from<2>(text);
    if (!p) return tl::unexpected(p.error());
    const auto& [lowest, highest] = *p;
    if (!(lowest > 0.0 && lowest < highest && highest < 1.0)) {
      return off(fmt::format("'{}': must be two probabilities between 0 and 1, the smaller one first", text));
    }
    target = {LogOdds::from_probability(lowest), LogOdds::from_probability(highest)};
    return {};
  };
}

Take into_mount(Pose& target) {
  return [&target](const std::string& text) -> Result<void> {
    const auto n = numbers_from<6>(text);
    if (!n) return off(n.error().message + ": x,y,z in metres and roll,pitch,yaw in degrees");
    if (!std::all_of(n->begin(), n->end(), [](double v) { return std::isfinite(v); })) {
      return off(fmt::format("'{}': must be finite", text));
    }
    const auto& [x, y, z, roll, pitch, yaw] = *n;
    target = pose_from_rpy({x, y, z}, roll * kDegree_rad, pitch * kDegree_rad, yaw * kDegree_rad);
    return {};
  };
}

}  // namespace

Result<void> check_options(BuildOptions options) {
  options.echo.max_range_m = std::numeric_limits<double>::infinity();
  return options.validate();
}

OptionTable::Group echo_group(EchoWords& words, double& sound_speed_ratio) {
  EchoOptions& echo = words.echo;
  return {
      "Echoes",
      {{"--min-range", 0, "M|auto", "nearer bins are the head's own ringing, and no evidence; auto: as it is found",
        shown(EchoOptions::kUsualBlanking_m),
        within({0.0, kAnyHigh, Limits::Ends::kHighOut}, into_min_range(echo.min_range_m))},
       {"--min-bin", 0, "N", "ignore bins before bin N (the first is 0)", fmt::format("{}", echo.min_bin),
        into_number(echo.min_bin)},
       {"--max-range", 0, "M",
        "farther echoes and cells do not count; a beam that heard only such echoes frees up to there", "none",
        within({0.0, kAnyHigh, Limits::Ends::kLowOut}, into_number(echo.max_range_m))},
       {"--sound-speed", 0, "M/S", "in this water; devices assume 1500 m/s", shown(kAssumedSoundSpeed_m_s),
        within({0.1 * kAssumedSoundSpeed_m_s, 10.0 * kAssumedSoundSpeed_m_s, Limits::Ends::kBothOut},
               into_sound_speed_ratio(sound_speed_ratio))},
       choice("--filter", kFilters,
              "how sweeps are smoothed before echoes are looked for; with none their noise leaves more beams silent",
              words.filter),
       {"--kernel", 0, "N", "edge of the filter's window in beams and bins, odd", "5, canny: 11",
        into_kernel(words.kernel)},
       {"--sigma", 0, "S", "standard deviation of the Gaussian in beams and bins", "1, canny: 2.3",
        within({0.0, 1000.0, Limits::Ends::kLowOut}, into_optional(words.sigma))},
       choice("--detect", kDetectors, "how echoes are found", echo.detector),
       {"--threshold", 0, "T", "the rise, level or gradient (canny) that makes an echo",
        "automatic, from the contrast of nearby beams", into_optional(echo.threshold)},
       choice("--cfar", kCfars, "noise of cfar: cell-averaging, smallest-of or ordered-statistic", echo.cfar.noise)}};
}

OptionTable::Group map_group(BuildWords& words) {
  MapOptions& map = words.map;
  BeamModelOptions& model = words.build.model;
  return {
      "Map",
      {{"--resolution", 0, "M", "edge length of a cell", shown(map.resolution_m), into_number(map.resolution_m)},
       {"--depth", 0, "N", "levels of the octree, 1..128; .bt and .ot hold 16", fmt::format("{}", map.depth),
        into_number(map.depth)},
       {"--hit", 0, "P", "probability that a cell is occupied after one echo in it", shown(model.hit.probability()),
        within({0.5, 1.0, Limits::Ends::kBothOut}, into_probability(model.hit))},
       {"--miss", 0, "P", "probability that a cell is occupied after one beam passed through it",
        shown(words.build.miss.probability()),
        within({0.0, 0.5, Limits::Ends::kBothOut}, into_probability(words.build.miss))},
       {"--clamp", 0, "P,P", "lowest and highest probability a cell can reach",
        shown(map.clamp.lowest.probability()) + "," + shown(map.clamp.highest.probability()), into_clamp(map.clamp)},
       choice("--vote", kVotes, "one vote a cell and sweep (a hit beats a miss), or one a beam", words.build.vote),
       {"--memory-limit", 0, "BYTES", "stop before the map grows larger; also 512M, 2G", "none",
        into_bytes(map.memory_limit_bytes)}}};
}

OptionTable::Group sensor_group(BuildWords& words) {
  BeamModelOptions& model = words.build.model;
  return {"Sensor",
          {{"--poses", 0, "FILE", "where the vehicle was, as TUM lines 't x y z qx qy qz qw'", "it stood still",
            into(words.poses)},
           {"--mount", 0, "X,Y,Z,R,P,Y", "the head on the vehicle: metres, then roll, pitch, yaw in degrees",
            "0,0,0,0,0,0", into_mount(words.build.body_from_sensor)},
           choice("--beam", kShapes, "what a beam fills: its axis, its width, or its width and height", model.shape),
           {"--beam-width", 0, "DEG", "horizontally, full angle", of_device(model.width_rad),
            within({0.0, 180.0, Limits::Ends::kLowOut}, into_degrees(words.head.beam_width_rad))},
           {"--beam-height", 0, "DEG", "vertically, full angle", of_device(model.height_rad),
            within({0.0, 180.0, Limits::Ends::kBothOut}, into_degrees(words.head.beam_height_rad))},
           {"--device", 0, device_names("|"), "the sonar's head, which says how wide and high its beam is",
            "as the log says", into_device(words.head.device)},
           {"--free-share", 0, "S", "central fraction of the beam (0..1) that marks cells free",
            shown(model.free_share), within({0.0, 1.0, Limits::Ends::kLowOut}, into_number(model.free_share))},
           choice("--ray", kRays, "traversal of cells along a ray", model.ray),
           choice("--hit-from", kHitsFrom, "every echo counts the same, or by its intensity", model.hit_from),
           choice("--silent", kSilents, "how to treat a beam without echo: ignore it, or mark it free", model.silent)}};
}

}  // namespace pingvox::app
