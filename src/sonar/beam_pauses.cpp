#include "pingvox/sonar/beam_pauses.hpp"

#include <algorithm>
#include <numeric>

namespace pingvox {

void BeamPauseCounter::add(double time_s) {
  const double step_s = time_s - newest_s_;
  // The first beam has none before it.
  if (newest_s_ == std::numeric_limits<double>::infinity()) {
    newest_s_ = time_s;
    return;
  }
  if (step_s < 0.0) return;
  newest_s_ = time_s;
  if (step_s >= kShortestPause_s) {
    long_steps_s_.push_back(step_s);
  } else {
    ++steps_;
    steps_s_ += step_s;
  }
}

BeamPauses BeamPauseCounter::pauses() const {
  constexpr double kTimesUsual = 10.0;
  std::vector<double> longer = long_steps_s_;
  std::ranges::sort(longer);
  // The usual step is the mean of those that are shorter.
  double rest_s = steps_s_;
  std::size_t rest = steps_;
  auto first = longer.begin();
  for (; first != longer.end(); ++first) {
    if (rest > 0 && *first > kTimesUsual * rest_s / static_cast<double>(rest)) break;
    rest_s += *first;
    ++rest;
  }
  const auto count = static_cast<std::size_t>(longer.end() - first);
  if (count == 0) return {};
  return {count, *(first + static_cast<std::ptrdiff_t>(count / 2)), longer.back(),
          std::accumulate(first, longer.end(), 0.0)};
}

}  // namespace pingvox
