#include "paired_timing.hpp"

#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace pingvox::bench {
namespace {

/// Sorts the free chunks that the other side left, which would slow down the first large allocations of this one: joins
/// them (malloc_trim), then makes glibc sort them by size, at most 10,000 in each allocation that fits none.
void sort_heap() {
  constexpr int kMaxAllocations = 10000;
  constexpr std::size_t kLarge = 100000;
  malloc_trim(0);
  for (int i = 0; i < kMaxAllocations; ++i) {
    void* volatile chunk = std::malloc(kLarge);
    std::free(chunk);
  }
}

double time_side(const Side& side, int times, double (*clock_s)()) {
  if (side.prepare) side.prepare();
  sort_heap();
  const double started = clock_s();
  for (int i = 0; i < times; ++i) side.work();
  return (clock_s() - started) / times;
}

/// A line of /proc/self/status in bytes; 0 when it is not there.
std::uint64_t status_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    std::uint64_t kilobytes = 0;
    if (word == name + ":" && status >> kilobytes) return kilobytes * 1024;
  }
  return 0;
}

std::uint64_t peak_growth(const std::function<void()>& work) {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5" << std::flush;  // resets the peak
  const std::uint64_t before = resident_bytes();
  work();
  const std::uint64_t peak = status_bytes("VmHWM");
  return before != 0 && peak > before ? peak - before : 0;
}

std::uint64_t live_growth(const std::function<std::shared_ptr<const void>()>& build) {
  malloc_trim(0);
  const std::uint64_t before = resident_bytes();
  const std::shared_ptr<const void> object = build();
  malloc_trim(0);
  const std::uint64_t after = resident_bytes();
  return before != 0 && after > before ? after - before : 0;
}

/// Result of `measure` in a child process; 0 on failure.
std::uint64_t measure_in_child(const std::function<std::uint64_t()>& measure) {
  int ends[2] = {};
  if (pipe(ends) != 0) return 0;
  const pid_t child = fork();
  if (child == 0) {
    const std::uint64_t measured = measure();
    const bool told = write(ends[1], &measured, sizeof measured) == static_cast<ssize_t>(sizeof measured);
    _exit(told ? 0 : 1);
  }
  close(ends[1]);
  std::uint64_t measured = 0;
  if (child < 0 || read(ends[0], &measured, sizeof measured) != static_cast<ssize_t>(sizeof measured)) measured = 0;
  close(ends[0]);
  if (child > 0) waitpid(child, nullptr, 0);
  return measured;
}

}  // namespace

std::uint64_t resident_bytes() {
  return status_bytes("VmRSS");
}

double cpu_time_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double childrens_cpu_time_s() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

PairedTimes time_in_pairs(const Side& ours, const Side& peer, const PairedTimingOptions& options) {
  const auto times_for = [&](const Side& side) {
    if (options.warm_up == WarmUp::kNone) return 1;
    const double once = time_side(side, 1, options.clock_s);
    return std::clamp(static_cast<int>(std::ceil(options.min_s / std::max(once, 1e-7))), 1, 100'000);
  };
  const int ours_times = times_for(ours), peer_times = times_for(peer);
  std::vector<double> ours_s, peer_s, ratios;
  for (int pair = 0; pair < options.pairs; ++pair) {
    ours_s.push_back(time_side(ours, ours_times, options.clock_s));
    peer_s.push_back(time_side(peer, peer_times, options.clock_s));
    ratios.push_back(peer_s.back() / ours_s.back());
  }
  const auto [min, max] = std::minmax_element(ratios.begin(), ratios.end());
  return {median(ours_s), median(peer_s), median(ratios), *min, *max};
}

std::uint64_t peak_memory_bytes(const std::function<void()>& work) {
  return measure_in_child([&] { return peak_growth(work); });
}

std::uint64_t live_memory_bytes(const std::function<std::shared_ptr<const void>()>& build) {
  return measure_in_child([&] { return live_growth(build); });
}

Row speed_row(const std::string& name, const PairedTimes& result, const MemoryOfBoth& bytes) {
  Row row;
  row.add("name", name)
      .add_truth("checked", true)
      .add("ours_s", result.ours_s)
      .add("octomap_s", result.peer_s)
      .add("ratio", result.ratio)
      .add("ratio_min", result.ratio_min)
      .add("ratio_max", result.ratio_max);
  const auto add = [&](const char* field, const std::optional<std::uint64_t>& value) {
    if (value) {
      row.add(field, *value);
    } else {
      row.add_nothing(field);
    }
  };
  add("ours_bytes", bytes.ours);
  add("octomap_bytes", bytes.peer);
  return row;
}

}  // namespace pingvox::bench
