#include "accuracy/accuracy.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "accuracy/echo_score.hpp"
#include "accuracy/judged_world.hpp"
#include "accuracy/map_score.hpp"
#include "accuracy/recording.hpp"
#include "accuracy/true_returns.hpp"
#include "duel.hpp"
#include "pingvox/sonar/filters.hpp"

namespace pingvox::bench {
namespace {

/// A way to find echoes, and what to call it.
struct Finder {
  std::string_view detector, filter_name;
  FilterOptions filter;
  EchoOptions echo;
};

FilterOptions filter_of(Filter kind, int kernel, double sigma) {
  FilterOptions filter;
  filter.filter = kind;
  filter.kernel = kernel;
  filter.sigma = sigma;
  return filter;
}

EchoOptions echo_of(Detector detector, std::optional<int> threshold = std::nullopt) {
  EchoOptions echo;
  echo.detector = detector;
  echo.threshold = threshold;
  return echo;
}

const Finder kDefault = {"default", "default", {}, {}};

std::vector<Finder> finders() {
  const FilterOptions none = filter_of(Filter::kNone, 5, 1.0), mean = filter_of(Filter::kMean, 5, 1.0),
                      median = filter_of(Filter::kMedian, 5, 1.0), gaussian = filter_of(Filter::kGaussian, 5, 1.0),
                      wide = filter_of(Filter::kGaussian, 11, 2.3);
  std::vector<Finder> all = {kDefault, {"paper: rise 70", "gaussian 5, 1", gaussian, echo_of(Detector::kRise, 70)}};
  for (const auto& [name, detector] : {std::pair{"rise", Detector::kRise},
                                       {"level", Detector::kLevel},
                                       {"max", Detector::kMax},
                                       {"cfar", Detector::kCfar}}) {
    all.push_back({name, "none", none, echo_of(detector)});
    all.push_back({name, "mean 5", mean, echo_of(detector)});
    all.push_back({name, "median 5", median, echo_of(detector)});
    all.push_back({name, "gaussian 5, 1", gaussian, echo_of(detector)});
  }
  all.push_back({"canny", "gaussian 11, 2.3", wide, echo_of(Detector::kCanny)});
  return all;
}

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string_view name_of(Motion motion) {
  return motion == Motion::kStill ? "still" : motion == Motion::kLoop ? "loop" : "other";
}

std::string poses_of(const RecordingOptions& options) {
  std::string text(name_of(options.motion));
  if (options.heave_m > 0.0) text += fmt::format(", heave {} m", options.heave_m);
  return text;
}

Row echo_row(const Recording& recording, const Finder& finder, const EchoScore& score) {
  Row row;
  row.add("name", "accuracy-echoes")
      .add("world", recording.options.world)
      .add("poses", poses_of(recording.options))
      .add("detector", finder.detector)
      .add("filter", finder.filter_name)
      .add("beams", std::uint64_t{score.beams})
      .add("echoes", std::uint64_t{score.echoes});
  const auto add_counts = [&row](const std::string& against, const EchoCounts& counts) {
    row.add(against + "_beams", std::uint64_t{counts.beams})
        .add(against + "_1_bin", share(counts.within_1_bin, counts.beams))
        .add(against + "_2_bins", share(counts.within_2_bins, counts.beams))
        .add(against + "_5cm", share(counts.within_5cm, counts.beams))
        .add(against + "_10cm", share(counts.within_10cm, counts.beams))
        .add(against + "_missed", share(counts.missed, counts.beams))
        .add(against + "_false", share(counts.wrong, counts.beams));
  };
  add_counts("axis", score.axis);
  add_counts("return", score.returns);
  row.add("silent_beams", std::uint64_t{score.silent_beams})
      .add("silent_false", share(score.silent_echoes, score.silent_beams))
      .add("echoes_5cm", share(score.returns.within_5cm, score.echoes))
      .add("echoes_false", share(score.false_echoes(), score.echoes))
      .add("late", share(score.late, score.echoes))
      .add("chance_5cm", score.chance_5cm);
  return row;
}

Row map_row(const Recording& recording, std::string_view extent, std::string_view echoes, std::string_view beam,
            double resolution_m, const MapScore& score, double seconds) {
  Row row;
  row.add("name", "accuracy-map")
      .add("world", recording.options.world)
      .add("poses", poses_of(recording.options))
      .add("where", extent)
      .add("echoes", echoes)
      .add("beam", beam)
      .add("resolution_m", resolution_m)
      .add("occupied", score.occupied)
      .add("visible", score.visible)
      .add("free", score.free)
      .add("precision", score.precision())
      .add("recall", score.recall())
      .add("free_true", score.free_share())
      .add("free_true_1_cell", score.free_share_near())
      .add("seconds", seconds);
  return row;
}

void say(const BenchOptions& options, const std::string& line) {
  if (options.say != nullptr) options.say(line);
}

/// What is measured with one recording.
struct Plan {
  RecordingOptions recording;
  bool all_finders = false;
  std::vector<double> plane_m, space_m;  ///< resolutions of the maps in the plane and in space
};

std::vector<Plan> plans() {
  return {
      {{.world = "tank", .motion = Motion::kStill, .turns = 10}, true, {0.05, 0.02}, {0.05}},
      {{.world = "tank", .motion = Motion::kLoop, .turns = 10}, false, {0.05, 0.02}, {0.05}},
      {{.world = "harbour", .motion = Motion::kStill, .turns = 5}, false, {0.05}, {}},
      {{.world = "harbour", .motion = Motion::kLoop, .turns = 20}, true, {0.05, 0.02}, {0.05}},
      {{.world = "seabed", .motion = Motion::kLoop, .turns = 10}, true, {0.05, 0.02}, {0.05}},
      {{.world = "cave", .motion = Motion::kLoop, .turns = 10}, true, {0.05, 0.02}, {0.05}},
  };
}

Result<void> measure(const Plan& plan, const BenchOptions& options, std::vector<Row>& echo_rows,
                     std::vector<Row>& map_rows) {
  double t = cpu_time_s();
  const auto lap = [&](std::string_view what) {
    const double now = cpu_time_s();
    say(options, fmt::format("  {} {}: {} {:.1f} s", plan.recording.world, poses_of(plan.recording), what, now - t));
    t = now;
  };
  const Result<Recording> recording = recorded(plan.recording);
  if (!recording) return tl::unexpected(recording.error());
  lap("simulated");
  const std::vector<TrueReturns> truths = true_returns(*recording);
  lap("truth");
  const double blanking_m = *EchoOptions().min_range_m;
  const EchoJudge judge{recording->sonar.bin_length_m, blanking_m, recording->sonar.range_m()};
  for (const Finder& finder : finders()) {
    if (!plan.all_finders && finder.detector != "default" && !finder.detector.starts_with("paper")) continue;
    echo_rows.push_back(
        echo_row(*recording, finder, judged(detected(*recording, finder.filter, finder.echo), truths, judge)));
  }
  lap("echoes");

  const Echoes usual = detected(*recording, {}, {});
  const Echoes paper = detected(*recording, filter_of(Filter::kGaussian, 5, 1.0), echo_of(Detector::kRise, 70));
  const Echoes perfect = true_echoes(*recording, truths, blanking_m);
  const auto add_maps = [&](Extent extent, double resolution_m,
                            const std::vector<Eigen::Vector3d>& visible_m) -> Result<void> {
    const Result<JudgedWorld> world = JudgedWorld::make(*recording, extent, resolution_m, visible_m);
    if (!world) return tl::unexpected(world.error());
    lap("true map");
    const auto add_map = [&](std::string_view name, const Echoes& echoes, std::string_view beam,
                             BeamShape shape) -> Result<void> {
      BeamModelOptions model;
      model.shape = shape;
      const double before = cpu_time_s();
      const Result<OccupancyMap> map = mapped(*recording, echoes, model, resolution_m);
      if (!map) return tl::unexpected(map.error());
      const double seconds = cpu_time_s() - before;
      map_rows.push_back(map_row(*recording, extent == Extent::kPlane ? "plane" : "space", name, beam, resolution_m,
                                 world->judged(*map), seconds));
      lap(fmt::format("{} {} {}", name, beam, resolution_m));
      return {};
    };
    const auto add_beams = [&](std::string_view name, const Echoes& echoes) -> Result<void> {
      for (const auto& [beam, shape] :
           {std::pair{"ray", BeamShape::kRay}, {"fan", BeamShape::kFan}, {"cone", BeamShape::kCone}}) {
        if (extent == Extent::kSpace && shape != BeamShape::kCone) continue;
        if (shape == BeamShape::kCone && resolution_m < 0.05) continue;
        if (auto added = add_map(name, echoes, beam, shape); !added) return added;
      }
      return {};
    };
    if (auto added = add_beams("default", usual); !added) return added;
    if (extent == Extent::kPlane) {
      if (auto added = add_map("paper: rise 70", paper, "ray", BeamShape::kRay); !added) return added;
    }
    return add_beams("true ranges", perfect);
  };
  const std::vector<Eigen::Vector3d> in_plane_m = seen_in_plane_m(*recording, blanking_m);
  for (const double resolution_m : plan.plane_m) {
    if (auto added = add_maps(Extent::kPlane, resolution_m, in_plane_m); !added) return added;
  }
  if (plan.space_m.empty()) return {};
  std::vector<Eigen::Vector3d> in_cones_m;
  for (const TrueReturns& truth : truths) in_cones_m.insert(in_cones_m.end(), truth.seen_m.begin(), truth.seen_m.end());
  for (const double resolution_m : plan.space_m) {
    if (auto added = add_maps(Extent::kSpace, resolution_m, in_cones_m); !added) return added;
  }
  return {};
}

}  // namespace

Result<std::vector<Row>> accuracy(const BenchOptions& options) {
  std::vector<Row> rows, map_rows;
  for (const Plan& plan : plans()) {
    if (auto measured = measure(plan, options, rows, map_rows); !measured) return tl::unexpected(measured.error());
  }
  rows.insert(rows.end(), map_rows.begin(), map_rows.end());
  return rows;
}

}  // namespace pingvox::bench
