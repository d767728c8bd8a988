#include "accuracy/echo_score.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace pingvox::bench {
namespace {

void count(const std::optional<double>& off_m, const EchoJudge& judge, EchoCounts& counts) {
  ++counts.beams;
  if (!off_m) {
    ++counts.missed;
    return;
  }
  counts.within_1_bin += *off_m <= judge.bin_length_m;
  counts.within_2_bins += *off_m <= 2.0 * judge.bin_length_m;
  counts.within_5cm += *off_m <= 0.05;
  counts.within_10cm += *off_m <= EchoJudge::kFalse_m;
  counts.wrong += *off_m > EchoJudge::kFalse_m;
}

/// The returns between the blanking range and the last bin.
TrueReturns audible(const TrueReturns& truth, const EchoJudge& judge) {
  TrueReturns heard;
  if (truth.axis_m && *truth.axis_m >= judge.min_range_m) heard.axis_m = truth.axis_m;
  for (const Span& span : truth.returns) {
    if (span.last_m < judge.min_range_m || span.first_m > judge.range_m) continue;
    heard.returns.push_back({std::max(span.first_m, judge.min_range_m), std::min(span.last_m, judge.range_m)});
  }
  return heard;
}

double share_within_5cm(const std::vector<Span>& returns, const EchoJudge& judge) {
  std::vector<Span> wider;
  for (const Span& span : returns) {
    wider.push_back({std::max(span.first_m - 0.05, judge.min_range_m), std::min(span.last_m + 0.05, judge.range_m)});
  }
  double covered = 0.0;
  for (const Span& span : join(std::move(wider))) covered += span.last_m - span.first_m;
  return covered / (judge.range_m - judge.min_range_m);
}

}  // namespace

EchoScore score_echoes(std::span<const std::optional<Echo>> echoes, std::span<const TrueReturns> truths,
                       const EchoJudge& judge) {
  assert(echoes.size() == truths.size());
  EchoScore score;
  for (std::size_t n = 0; n < echoes.size(); ++n) {
    const std::optional<Echo>& echo = echoes[n];
    const TrueReturns truth = audible(truths[n], judge);
    ++score.beams;
    score.echoes += echo.has_value();
    if (truth.axis_m) {
      count(echo ? std::optional(std::abs(echo->range_m - *truth.axis_m)) : std::nullopt, judge, score.axis);
    }
    if (echo && distance_m(echo->range_m, truth.returns).value_or(1.0) > EchoJudge::kFalse_m) {
      score.beyond_cone += distance_m(echo->range_m, truths[n].lobe).value_or(1.0) <= EchoJudge::kFalse_m;
    }
    if (truth.returns.empty()) {
      ++score.silent_beams;
      score.silent_echoes += echo.has_value();
      continue;
    }
    count(echo ? distance_m(echo->range_m, truth.returns) : std::nullopt, judge, score.returns);
    score.late += echo && echo->range_m > truth.returns.front().first_m + EchoJudge::kFalse_m;
    score.chance_5cm += share_within_5cm(truth.returns, judge);
  }
  if (score.returns.beams > 0) score.chance_5cm /= static_cast<double>(score.returns.beams);
  return score;
}

}  // namespace pingvox::bench
