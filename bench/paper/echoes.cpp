#include "echoes.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <string>

#include "claim.hpp"
#include "paper_detector.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "tank_logs.hpp"

namespace pingvox::bench {
namespace {

constexpr std::array kThresholds = {20, 40, 70, 140};

std::string in_words(const EchoJudgement& judgement) {
  return fmt::format("{}% elsewhere, {}% without an echo", per_cent(judgement.wrong, judgement.judged),
                     per_cent(judgement.missed, judgement.judged));
}

Row echo_row(const TankLog& log, const std::string& name, const char* section, Value paper,
             const EchoJudgement& judgement, Holds holds) {
  return row_of({.name = fmt::format("{}-{}", name, log.name),
                 .section = section,
                 .unit = "% within 10 cm",
                 .paper = std::move(paper),
                 .ours = per_cent(judgement.right, judgement.judged),
                 .octomap = {},
                 .holds = holds,
                 .checked = judgement.judged > 0,
                 .why = in_words(judgement)});
}

/// Counts of the paper's detector over a log.
struct PaperCount {
  EchoJudgement judgement;
  std::size_t beams = 0, silent = 0, falling = 0;
};

std::size_t first_bin_of(const Beam& beam) {
  return static_cast<std::size_t>(std::ceil(EchoOptions::kDefaultBlanking_m / beam.bin_length_m));
}

/// In the authors' program: 0.3 m.
std::size_t authors_first_bin(const Beam&) {
  return 24;
}

PaperCount paper_count(const TankLog& log, const FilterOptions& filter, int threshold,
                       std::size_t (*first_bin)(const Beam&) = &first_bin_of) {
  PaperCount count;
  for (const Sweep& sweep : log.sweeps) {
    const PolarImage image = apply_filter(PolarImage(sweep), filter);
    for (std::size_t n = 0; n < sweep.beams.size(); ++n) {
      const Beam& beam = sweep.beams[n];
      const auto edge = paper_edge(image.row(n).first(image.bins_in(n)), first_bin(beam), threshold);
      ++count.beams;
      count.silent += edge ? 0U : 1U;
      count.falling += edge && edge->is_falling ? 1U : 0U;
      count.judgement.add(
          log.wall_m(beam.bearing_rad),
          edge ? std::optional((static_cast<double>(edge->bin) + 0.5) * beam.bin_length_m) : std::nullopt);
    }
  }
  return count;
}

FilterOptions no_filter() {
  return {.filter = Filter::kNone};
}

/// The first of the four with the most correct echoes.
template <class RightAt>
int best_threshold(RightAt&& right_at) {
  int best = kThresholds.front();
  for (const int threshold : kThresholds) {
    if (right_at(threshold) > right_at(best)) best = threshold;
  }
  return best;
}

/// Occupied cells more than `range_m` from the head, where the tank has no wall.
std::uint64_t count_occupied_beyond(const OccupancyMap& map, double range_m) {
  std::uint64_t cells = 0;
  for_each_leaf(map, [&](const Leaf& leaf) {
    if (classify(leaf.belief) != Occupancy::kOccupied) return;
    if (leaf.centre_m().norm() > range_m) ++cells;
  });
  return cells;
}

/// A map of beam axes only, as in the paper. Silent beams are walls in their last bin, or ignored.
enum class SilentBeam { kWall, kNothing };
OccupancyMap map_as_in_paper(const TankLog& log, const FilterOptions& filter, int threshold, SilentBeam silent_beam) {
  OccupancyMap map;
  ScanUpdate scan(map.lattice());
  const BeamModelOptions model{.shape = BeamShape::kRay, .hit_from = HitFrom::kFixed};
  for (const Sweep& sweep : log.sweeps) {
    const PolarImage image = apply_filter(PolarImage(sweep), filter);
    scan.clear();
    for (std::size_t n = 0; n < sweep.beams.size(); ++n) {
      const Beam& beam = sweep.beams[n];
      const auto edge = paper_edge(image.row(n).first(image.bins_in(n)), first_bin_of(beam), threshold);
      if (!edge && silent_beam == SilentBeam::kNothing) continue;
      const std::size_t bin = edge ? edge->bin : beam.intensities.size() - 1;
      Echo echo{.first = bin, .peak = bin, .last = bin, .range_m = 0.0, .intensity = 255};
      echo.range_m = (static_cast<double>(bin) + 0.5) * beam.bin_length_m;
      trace_beam(Pose::Identity(), beam, echo, model, scan);
    }
    if (!map.apply(scan)) break;  // never fails without a limit
  }
  return map;
}

void add_thresholds(const TankLog& log, std::vector<Row>& rows) {
  const auto rise = [&](int threshold) { return judge_echoes(log, {}, EchoOptions{.threshold = threshold}); };
  const int best_rise = best_threshold([&](int threshold) { return rise(threshold).right; });
  const int best_of_paper =
      best_threshold([&](int threshold) { return paper_count(log, {}, threshold).judgement.right; });
  const int best_raw =
      best_threshold([&](int threshold) { return paper_count(log, no_filter(), threshold).judgement.right; });
  for (const int threshold : kThresholds) {
    const Value paper = threshold == 70 ? Value("best") : Value();
    rows.push_back(echo_row(log, fmt::format("threshold-{}-rise", threshold), "8.2", paper, rise(threshold),
                            threshold != 70   ? Holds::kNotJudged
                            : best_rise == 70 ? Holds::kYes
                                              : Holds::kNo));
    rows.push_back(echo_row(log, fmt::format("threshold-{}-paper", threshold), "8.2", paper,
                            paper_count(log, {}, threshold).judgement,
                            threshold != 70       ? Holds::kNotJudged
                            : best_of_paper == 70 ? Holds::kYes
                                                  : Holds::kNo));
    rows.push_back(echo_row(log, fmt::format("threshold-{}-paper-unsmoothed", threshold), "8.2", paper,
                            paper_count(log, no_filter(), threshold).judgement,
                            threshold != 70  ? Holds::kNotJudged
                            : best_raw == 70 ? Holds::kYes
                                             : Holds::kNo));
  }
}

/// The authors' published program sets bins up to 128 to 0 before it looks for a difference of 40, and so finds the
/// first bin above 128.
Row row_of_authors_program(const TankLog& log) {
  const EchoJudgement level = judge_echoes(log, {}, EchoOptions{.detector = Detector::kLevel, .threshold = 129});
  return row_of({.name = "threshold-their-program-" + log.name,
                 .section = "8.2",
                 .unit = "% within 10 cm",
                 .paper = {},
                 .ours = per_cent(level.right, level.judged),
                 .checked = level.judged > 0,
                 .why = "a level of 129, smoothed: " + in_words(level)});
}

void add_falling(const TankLog& log, std::vector<Row>& rows) {
  const auto row = [&](const char* what, int threshold, const PaperCount& count, const char* where) {
    const std::size_t found = count.beams - count.silent;
    rows.push_back(row_of({.name = fmt::format("falling-edges-{}-{}", what, log.name),
                           .section = "8.2",
                           .unit = "% of its echoes",
                           .paper = std::uint64_t{0},
                           .ours = per_cent(count.falling, found),
                           .holds = count.falling == 0 ? Holds::kYes : Holds::kNo,
                           .checked = found > 0,
                           .why = fmt::format("a difference of {} either way, {}", threshold, where)}));
  };
  row("smoothed", 20, paper_count(log, {}, 20), "behind 0.75 m: where it gets quieter there is no wall");
  row("unsmoothed", 70, paper_count(log, no_filter(), 70), "behind 0.75 m");
  row("of-the-ringing", 20, paper_count(log, {}, 20, &authors_first_bin),
      "smoothed, behind 24 bins as in their program: the ringing falls");
}

void add_silent(const TankLog& log, std::vector<Row>& rows) {
  const PaperCount count = paper_count(log, {}, 70);
  const double beyond_m = 4.9;  // the corners are nearer
  const auto walls = count_occupied_beyond(map_as_in_paper(log, {}, 70, SilentBeam::kWall), beyond_m);
  const auto nothing = count_occupied_beyond(map_as_in_paper(log, {}, 70, SilentBeam::kNothing), beyond_m);
  rows.push_back(row_of({.name = fmt::format("silent-beams-{}", log.name),
                         .section = "8.2",
                         .unit = "% of beams",
                         .ours = per_cent(count.silent, count.beams),
                         .checked = count.beams > 0,
                         .why = "the paper's at 70, smoothed, finds nothing in them"}));
  rows.push_back(row_of({.name = fmt::format("silent-as-walls-{}", log.name),
                         .section = "8.2",
                         .unit = "cells at 5 m",
                         .paper = std::uint64_t{0},
                         .ours = walls,
                         .holds = walls == 0 ? Holds::kYes : Holds::kNo,
                         .checked = nothing == 0,
                         .why = "occupied if a silent beam is an echo in its last bin, as in their program"}));
  rows.push_back(row_of({.name = fmt::format("silent-says-nothing-{}", log.name),
                         .section = "8.2",
                         .unit = "cells at 5 m",
                         .paper = std::uint64_t{0},
                         .ours = nothing,
                         .holds = nothing == 0 ? Holds::kYes : Holds::kNo,
                         .checked = true,
                         .why = "occupied if it says nothing: our default"}));
}

}  // namespace

Result<std::vector<Row>> paper_smoothing(const BenchOptions&) {
  const auto logs = tank_logs();
  if (!logs) return tl::unexpected(logs.error());
  std::vector<Row> rows;
  for (const TankLog& log : *logs) {
    const auto at = [&](Filter filter) {
      return judge_echoes(log, {.filter = filter, .kernel = 5, .sigma = 1.0}, EchoOptions{.threshold = 70});
    };
    const EchoJudgement none = at(Filter::kNone), mean = at(Filter::kMean), median = at(Filter::kMedian),
                        gaussian = at(Filter::kGaussian);
    const auto holds = [](bool it_does) { return it_does ? Holds::kYes : Holds::kNo; };
    rows.push_back(echo_row(log, "smoothing-none", "8.1", "false positives", none, holds(none.wrong > gaussian.wrong)));
    rows.push_back(echo_row(log, "smoothing-mean", "8.1", "worse", mean,
                            holds(mean.right < median.right && mean.right < gaussian.right)));
    rows.push_back(echo_row(log, "smoothing-median", "8.1", "satisfactory", median, holds(median.right > none.right)));
    rows.push_back(echo_row(log, "smoothing-gaussian", "8.1", "best", gaussian, holds(gaussian.right > median.right)));
  }
  return rows;
}

Result<std::vector<Row>> paper_thresholds(const BenchOptions&) {
  const auto logs = tank_logs();
  if (!logs) return tl::unexpected(logs.error());
  std::vector<Row> rows;
  for (const TankLog& log : *logs) {
    add_thresholds(log, rows);
    rows.push_back(row_of_authors_program(log));
    add_falling(log, rows);
    add_silent(log, rows);
  }
  return rows;
}

Result<std::vector<Row>> paper_canny(const BenchOptions&) {
  const auto logs = tank_logs();
  if (!logs) return tl::unexpected(logs.error());
  std::vector<Row> rows;
  for (const TankLog& log : *logs) {
    const EchoJudgement canny = judge_echoes(log, default_filter(Detector::kCanny),
                                             EchoOptions{.detector = Detector::kCanny, .threshold = 113});
    const EchoJudgement rise = judge_echoes(log, {}, EchoOptions{.threshold = 70});
    rows.push_back(echo_row(log, "figure-21-canny", "9", "interesting", canny, Holds::kNotJudged));
    rows.push_back(echo_row(log, "figure-21-rise-beside", "9", {}, rise, Holds::kNotJudged));
  }
  return rows;
}

}  // namespace pingvox::bench
