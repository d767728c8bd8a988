#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "report.hpp"

namespace pingvox::bench {

/// CPU time of this process so far [s], all threads together: what else the machine does is left out of it.
double cpu_time_s();
/// The same of all processes that it started and that have ended.
double childrens_cpu_time_s();

/// The value in the middle, the mean of the two there of an even number. REQUIRES at least one.
double median(std::vector<double> values);

/// One side of a comparison. `prepare` is not timed (a fresh map, a copy of what is used up); it may be empty.
struct Side {
  std::function<void()> prepare;
  std::function<void()> work;
};

/// Times of two sides that did the same work by turns (A B A B ...).
struct PairedTimes {
  double ours_s = 0.0, peer_s = 0.0;  ///< medians
  double ratio = 0.0;                 ///< peer / ours: the median of the pairs
  double ratio_min = 0.0, ratio_max = 0.0;
};

/// Whether both sides run once before the first pair.
enum class WarmUp {
  kOnce,  ///< caches and pages
  kNone,  ///< for long work that ran a moment ago, to be checked
};

struct PairedTimingOptions {
  int pairs = 5;
  /// Work shorter than this is done several times in a row and the time divided; only for work that may be repeated
  /// without preparing it again.
  double min_s = 0.0;
  double (*clock_s)() = &cpu_time_s;
  WarmUp warm_up = WarmUp::kOnce;
};

/// Runs both sides by turns.
PairedTimes time_in_pairs(const Side& ours, const Side& peer, const PairedTimingOptions& options = {});

/// By how much the resident memory of a fresh process grows at most while `work` runs in it [bytes]; 0 when that cannot
/// be told. `work` must not need other threads.
std::uint64_t peak_memory_bytes(const std::function<void()>& work);

/// By how much the resident memory of a fresh process is larger [bytes] once `build` has run in it and returned what it
/// built, all else freed and given back; 0 when that cannot be told. `build` must not need other threads.
std::uint64_t live_memory_bytes(const std::function<std::shared_ptr<const void>()>& build);

/// Memory that the two sides took [bytes]; none where the work makes nothing that lasts.
struct MemoryOfBoth {
  std::optional<std::uint64_t> ours, peer;
};

/// The row of a benchmark of speed: {name, checked, ours_s, octomap_s, ratio, ratio_min, ratio_max, ours_bytes,
/// octomap_bytes}.
Row speed_row(const std::string& name, const PairedTimes& result, const MemoryOfBoth& bytes);

}  // namespace pingvox::bench
