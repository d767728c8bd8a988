#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "report.hpp"

namespace pingvox::bench {

/// CPU time of this process so far [s], all threads together: what else the machine does is left out of it.
double cpu_time_s();

/// One side of a comparison. `prepare` is not timed (a fresh map, a copy of what is used up); it may be empty.
struct Side {
  std::function<void()> prepare;
  std::function<void()> work;
};

/// Times of two sides that did the same work by turns (A B A B ...).
struct DuelResult {
  double ours_s = 0.0, peer_s = 0.0;  ///< medians
  double ratio = 0.0;                 ///< peer / ours: the median of the pairs
  double ratio_min = 0.0, ratio_max = 0.0;
};

struct DuelOptions {
  int pairs = 5;
  /// Work shorter than this is done several times in a row and the time divided; only for work that may be repeated
  /// without preparing it again.
  double least_s = 0.0;
};

/// Runs both sides once untimed (caches, pages), then by turns.
DuelResult duel(const Side& ours, const Side& peer, const DuelOptions& options = {});

/// By how much the resident memory of a fresh process grows at most while `work` runs in it [bytes]; 0 when that cannot
/// be told. `work` must not need other threads.
std::uint64_t peak_memory_bytes(const std::function<void()>& work);

/// The row of a benchmark of speed: {name, checked, ours_s, octomap_s, ratio, ratio_min, ratio_max, ours_bytes,
/// octomap_bytes}.
Row speed_row(std::string name, const DuelResult& result, std::uint64_t ours_bytes, std::uint64_t octomap_bytes);

}  // namespace pingvox::bench
