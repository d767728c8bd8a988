#include "accuracy/accuracy.hpp"

#include <fmt/core.h>

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "accuracy/draw_accuracy.hpp"
#include "accuracy/echo_score.hpp"
#include "accuracy/ground_truth.hpp"
#include "accuracy/recording.hpp"
#include "accuracy/true_returns.hpp"
#include "paired_timing.hpp"
#include "pingvox/sonar/filters.hpp"

namespace pingvox::bench {
namespace {

/// Where a found echo is taken to be.
enum class RangeFrom { kCrest, kFirstBin };

/// A way to find echoes, and what to call it.
struct Finder {
  std::string_view detector, filter_name;
  FilterOptions filter;
  EchoOptions echo;
  RangeFrom range = RangeFrom::kCrest;
};

Echoes find_echoes(const Recording& recording, const Finder& finder) {
  Echoes echoes = detect(recording, finder.filter, finder.echo);
  if (finder.range == RangeFrom::kCrest) return echoes;
  return at_first_bins(std::move(echoes), recording.sonar.bin_length_m);
}

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

/// The authors' own: smoothed, a rise of 70, the wall where it is reached.
Finder paper() {
  return {"paper", "gaussian 5, 1", filter_of(Filter::kGaussian, 5, 1.0), echo_of(Detector::kRise, 70),
          RangeFrom::kFirstBin};
}

Finder usual() {
  return {"default", "default", {}, {}};
}

std::vector<Finder> finders() {
  const FilterOptions none = filter_of(Filter::kNone, 5, 1.0), mean = filter_of(Filter::kMean, 5, 1.0),
                      median = filter_of(Filter::kMedian, 5, 1.0), gaussian = filter_of(Filter::kGaussian, 5, 1.0),
                      wide = filter_of(Filter::kGaussian, 11, 2.3);
  std::vector<Finder> all = {usual(), paper(), {"rise 70", "gaussian 5, 1", gaussian, echo_of(Detector::kRise, 70)}};
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
      .add("echoes_beyond_cone", share(score.beyond_cone, score.echoes))
      .add("late", share(score.late, score.echoes))
      .add("chance_5cm", score.chance_5cm);
  return row;
}

/// What a map was made of, for its row.
struct MapCase {
  Extent extent;
  std::string_view echoes, beam;
  double resolution_m;
};

Row map_row(const Recording& recording, const MapCase& which, const MapAgreement& score, const MapAgreement& sure,
            double seconds) {
  const auto number = [](const std::optional<double>& share) {
    return share.value_or(std::numeric_limits<double>::quiet_NaN());
  };
  Row row;
  row.add("name", "accuracy-map")
      .add("world", recording.options.world)
      .add("poses", poses_of(recording.options))
      .add("where", which.extent == Extent::kPlane ? "plane" : "space")
      .add("echoes", which.echoes)
      .add("beam", which.beam)
      .add("resolution_m", which.resolution_m)
      .add("occupied", score.occupied_a)
      .add("visible", score.to_find)
      .add("free", score.free_a)
      .add("precision", number(score.precision()))
      .add("recall", number(score.recall()))
      .add("sure_precision", number(sure.precision()))
      .add("sure_recall", number(sure.recall()))
      .add("free_true", number(score.free_true()))
      .add("free_true_1_cell", number(score.free_true_near()))
      .add("seconds", seconds);
  return row;
}

/// What is measured with one recording. Where there are no numbers, nothing is.
struct Plan {
  RecordingOptions recording;
  std::vector<double> plane_m, space_m;  ///< resolutions of the maps in the plane and in space
};

std::vector<Plan> plans() {
  const std::vector<double> both = {0.05, 0.02}, coarse = {0.05};
  return {
      {{.world = "tank", .motion = Motion::kStill, .turns = 10}, both, coarse},
      {{.world = "tank", .motion = Motion::kLoop, .turns = 10}, both, both},
      {{.world = "tank", .motion = Motion::kLoop, .turns = 10, .heave_m = 0.5}, {}, coarse},
      {{.world = "harbour", .motion = Motion::kStill, .turns = 10}, coarse, coarse},
      {{.world = "harbour", .motion = Motion::kLoop, .turns = 20}, both, coarse},
      {{.world = "harbour", .motion = Motion::kLoop, .turns = 20, .heave_m = 0.5}, {}, coarse},
      {{.world = "harbour, no hull", .motion = Motion::kLoop, .turns = 20}, coarse, {}},
      {{.world = "seabed", .motion = Motion::kLoop, .turns = 20}, both, coarse},
      {{.world = "cave", .motion = Motion::kStill, .turns = 10}, {}, coarse},
      {{.world = "cave", .motion = Motion::kLoop, .turns = 20}, both, coarse},
  };
}

/// Measures one recording, stage by stage.
class Measurement {
 public:
  Measurement(const Plan& plan, const BenchOptions& options, Recording recording)
      : plan_(plan), options_(options), recording_(std::move(recording)), truths_(true_returns(recording_)) {}

  void echoes(std::vector<Row>& rows) const {
    const EchoJudge judge{recording_.sonar.bin_length_m, kBlanking_m, recording_.sonar.range_m()};
    for (const Finder& finder : finders()) {
      rows.push_back(echo_row(recording_, finder, score_echoes(find_echoes(recording_, finder), truths_, judge)));
    }
  }

  Result<void> maps(std::vector<Row>& rows) const {
    for (const double resolution_m : plan_.plane_m) {
      if (auto done = maps(Extent::kPlane, resolution_m, rows); !done) return done;
    }
    for (const double resolution_m : plan_.space_m) {
      if (auto done = maps(Extent::kSpace, resolution_m, rows); !done) return done;
    }
    return {};
  }

 private:
  static constexpr double kBlanking_m = EchoOptions::kDefaultBlanking_m;

  Result<void> maps(Extent extent, double resolution_m, std::vector<Row>& rows) const {
    if (options_.say != nullptr) {
      options_.say(fmt::format("  {}, {}: maps of {} m in {}", recording_.options.world, poses_of(recording_.options),
                               resolution_m, extent == Extent::kPlane ? "the plane" : "space"));
    }
    const Result<GroundTruth> world = GroundTruth::make(recording_, extent, resolution_m, kBlanking_m);
    if (!world) return tl::unexpected(world.error());
    const std::array<std::pair<std::string_view, Echoes>, 3> sources = {
        {{"default", find_echoes(recording_, usual())},
         {"paper", find_echoes(recording_, paper())},
         {"true ranges", true_echoes(recording_, truths_, kBlanking_m)}}};
    for (const auto& [name, echoes] : sources) {
      for (const auto& [beam, shape] :
           {std::pair{"ray", BeamShape::kRay}, {"fan", BeamShape::kFan}, {"cone", BeamShape::kCone}}) {
        if (extent == Extent::kSpace && shape != BeamShape::kCone) continue;  // one layer of cells is no space
        if (name == "paper" && shape != BeamShape::kRay) continue;
        BeamModelOptions model;
        model.shape = shape;
        const double before_s = cpu_time_s();
        const Result<OccupancyMap> map = map_echoes(recording_, echoes, model, resolution_m);
        if (!map) return tl::unexpected(map.error());
        const double seconds = cpu_time_s() - before_s;
        const Thresholds sure{.lower = LogOdds(0.0F), .upper = LogOdds::from_probability(0.7)};
        const Result<MapAgreement> score = world->score(*map), of_sure = world->score(*map, sure);
        if (!score) return tl::unexpected(score.error());
        if (!of_sure) return tl::unexpected(of_sure.error());
        rows.push_back(map_row(recording_, {extent, name, beam, resolution_m}, *score, *of_sure, seconds));
      }
    }
    return {};
  }

  const Plan& plan_;
  const BenchOptions& options_;
  Recording recording_;
  std::vector<TrueReturns> truths_;
};

}  // namespace

Result<std::vector<Row>> accuracy(const BenchOptions& options) {
  std::vector<Row> rows, map_rows;
  const std::vector<Plan> all = plans();
  for (const Plan& plan : all) {
    Result<Recording> recording = record(plan.recording);
    if (!recording) return tl::unexpected(recording.error());
    const Measurement measurement(plan, options, *std::move(recording));
    measurement.echoes(rows);
    if (auto done = measurement.maps(map_rows); !done) return tl::unexpected(done.error());
  }
  rows.insert(rows.end(), map_rows.begin(), map_rows.end());
  if (options.pictures) {
    if (auto drawn = draw_accuracy(rows, *options.pictures); !drawn) return tl::unexpected(drawn.error());
  }
  return rows;
}

}  // namespace pingvox::bench
