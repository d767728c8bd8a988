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

/// CPU time of this process so far [s], all threads: independent of other load.
double cpu_time_s();
/// The same of all its terminated child processes.
double childrens_cpu_time_s();

/// Median; the mean of the middle two of an even number. REQUIRES at least one value.
double median(std::vector<double> values);

/// The value that a share of all (0..1) is not above. REQUIRES at least one value.
double percentile(std::vector<double> values, double share);

/// One side of a comparison. `prepare` (a fresh map, a copy of the input) is not timed; may be empty.
struct Side {
  std::function<void()> prepare;
  std::function<void()> work;
};

/// Times of two sides that did the same work alternately (A B A B ...).
struct PairedTimes {
  double ours_s = 0.0, peer_s = 0.0;  ///< medians
  double ratio = 0.0;                 ///< peer / ours: the median of the pairs
  double ratio_min = 0.0, ratio_max = 0.0;
};

/// Whether both sides run once before the first pair.
enum class WarmUp {
  kOnce,  ///< caches and pages
  kNone,  ///< for long work that already ran for its check
};

struct PairedTimingOptions {
  int pairs = 5;
  /// Shorter work is repeated and the time divided; only for work that needs no prepare() in between.
  double min_s = 0.0;
  double (*clock_s)() = &cpu_time_s;
  WarmUp warm_up = WarmUp::kOnce;
};

/// Runs both sides alternately.
PairedTimes time_in_pairs(const Side& ours, const Side& peer, const PairedTimingOptions& options = {});

/// Resident memory of this process [bytes]; 0 if unknown.
std::uint64_t resident_bytes();

/// Peak growth of resident memory while `work` runs in a child process [bytes]; 0 if unknown. `work` must not use other
/// threads.
std::uint64_t peak_memory_bytes(const std::function<void()>& work);

/// Resident memory of what `build` returns [bytes], measured in a child process after freeing everything else; 0 if
/// unknown. `build` must not use other threads.
std::uint64_t live_memory_bytes(const std::function<std::shared_ptr<const void>()>& build);

/// Memory of the two sides [bytes]; nullopt if the work leaves no result.
struct MemoryOfBoth {
  std::optional<std::uint64_t> ours, peer;
};

/// The row of a benchmark of speed: {name, checked, ours_s, octomap_s, ratio, ratio_min, ratio_max, ours_bytes,
/// octomap_bytes}.
Row speed_row(const std::string& name, const PairedTimes& result, const MemoryOfBoth& bytes);

}  // namespace pingvox::bench
