#include "pingvox/recording/evaluate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/option_errors.hpp"
#include "mapping/internal/held_out_echoes.hpp"
#include "recording/recording_echoes.hpp"

namespace pingvox {
namespace {

constexpr double kNear_m = 0.1;

void count(const JudgedEcho& echo, double cell_m, EchoCounts& counts) {
  ++counts.echoes;
  if (echo.outcome == EchoOutcome::kUnknown) return;
  ++counts.judged;
  switch (echo.outcome) {
    case EchoOutcome::kPredicted:
      ++counts.predicted;
      counts.within_cell += std::abs(echo.error_m) <= cell_m ? 1 : 0;
      counts.within_10cm += std::abs(echo.error_m) <= kNear_m ? 1 : 0;
      break;
    case EchoOutcome::kTooEarly:
      ++counts.too_early;
      break;
    case EchoOutcome::kFromFree:
      ++counts.from_free;
      break;
    case EchoOutcome::kUnknown:
      break;
  }
}

std::vector<Evaluation::Part> parts_by_range(const std::vector<JudgedEcho>& echoes, double cell_m) {
  constexpr std::array kEdges_m = {
      0.0, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, std::numeric_limits<double>::infinity()};
  std::vector<Evaluation::Part> parts;
  for (std::size_t i = 0; i + 1 < kEdges_m.size(); ++i) {
    Evaluation::Part part{kEdges_m[i], kEdges_m[i + 1], {}};
    for (const JudgedEcho& echo : echoes) {
      if (echo.range_m >= part.from && echo.range_m < part.to) count(echo, cell_m, part.counts);
    }
    if (part.counts.echoes > 0) parts.push_back(part);
  }
  return parts;
}

std::vector<Evaluation::Part> parts_by_time(const std::vector<JudgedEcho>& echoes, double cell_m) {
  constexpr std::size_t kParts = 10;
  std::vector<Evaluation::Part> parts;
  if (echoes.empty()) return parts;
  const auto [first, last] = std::ranges::minmax(echoes, {}, &JudgedEcho::time_s);
  const double span_s = last.time_s - first.time_s;
  if (!(span_s > 0.0)) return parts;
  const auto edge_s = [&, from_s = first.time_s](std::size_t part) {
    return from_s + span_s * static_cast<double>(part) / kParts;
  };
  for (std::size_t i = 0; i < kParts; ++i) parts.push_back({edge_s(i), edge_s(i + 1), {}});
  for (const JudgedEcho& echo : echoes) {
    const auto part = static_cast<std::size_t>(kParts * (echo.time_s - first.time_s) / span_s);
    count(echo, cell_m, parts[std::min(part, kParts - 1)].counts);
  }
  return parts;
}

}  // namespace

Result<void> EvaluateOptions::validate() const {
  OptionErrors errors;
  errors.require_within("folds", folds, 2, 1000);
  errors.add(map.validate());
  errors.add(build.validate());
  return errors.result("evaluate");
}

double EchoCounts::coverage() const {
  return echoes == 0 ? 0.0 : static_cast<double>(judged) / static_cast<double>(echoes);
}

bool Evaluation::is_judged() const {
  constexpr std::size_t kFewEchoes = 100;
  constexpr double kHalf = 0.5;
  return all.judged >= kFewEchoes && all.coverage() >= kHalf;
}

Result<Evaluation> evaluate(const Recording& recording, const EvaluateOptions& options,
                            const std::function<void(double)>& progress) {
  const Result<VehiclePath> path = recording.path();
  if (!path) return tl::unexpected(path.error());
  return evaluate(recording, *path, options, progress);
}

Result<Evaluation> evaluate(const Recording& recording, const VehiclePath& path, const EvaluateOptions& options,
                            const std::function<void(double)>& progress) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  const Result<RecordingEchoes> read = recording_echoes(recording, path, options.map, options.build);
  if (!read) return tl::unexpected(read.error());
  const HeldOutEchoes& echoes = read->echoes;
  const double cell_m = read->cell_m;
  Evaluation found;
  found.resolution_m = cell_m;
  found.folds = std::min(options.folds, echoes.sweeps());
  found.tolerance_m = read->tolerance_m();
  found.sweeps = echoes.coverage(path.trajectory, cell_m);
  found.beams = found.sweeps.beams;
  const HeldOutOptions held_out{.folds = options.folds, .tolerance_m = found.tolerance_m, .cells = options.cells};
  Result<JudgedEchoes> judged = echoes.judge(path.trajectory, read->map, held_out, progress);
  if (!judged) return tl::unexpected(judged.error());
  for (const JudgedEcho& echo : judged->echoes) count(echo, cell_m, found.all);
  found.by_range = parts_by_range(judged->echoes, cell_m);
  found.by_time = parts_by_time(judged->echoes, cell_m);
  found.cells = std::move(judged->cells);
  return found;
}

}  // namespace pingvox
