#include "duel.hpp"

#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace pingvox::bench {
namespace {

double timed(const Side& side, int times) {
  if (side.prepare) side.prepare();
  const double started = cpu_time_s();
  for (int i = 0; i < times; ++i) side.work();
  return (cpu_time_s() - started) / times;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
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

std::uint64_t growth_while(const std::function<void()>& work) {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5" << std::flush;  // the peak starts anew
  const std::uint64_t before = status_bytes("VmRSS");
  work();
  const std::uint64_t peak = status_bytes("VmHWM");
  return before != 0 && peak > before ? peak - before : 0;
}

}  // namespace

double cpu_time_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

DuelResult duel(const Side& ours, const Side& peer, const DuelOptions& options) {
  const auto times_for = [&](const Side& side) {
    const double once = timed(side, 1);
    return std::clamp(static_cast<int>(std::ceil(options.least_s / std::max(once, 1e-7))), 1, 100'000);
  };
  const int ours_times = times_for(ours), peer_times = times_for(peer);
  std::vector<double> ours_s, peer_s, ratios;
  for (int pair = 0; pair < options.pairs; ++pair) {
    ours_s.push_back(timed(ours, ours_times));
    peer_s.push_back(timed(peer, peer_times));
    ratios.push_back(peer_s.back() / ours_s.back());
  }
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  return {median(ours_s), median(peer_s), median(ratios), *least, *most};
}

std::uint64_t peak_memory_bytes(const std::function<void()>& work) {
  int ends[2] = {};
  if (pipe(ends) != 0) return 0;
  const pid_t child = fork();
  if (child == 0) {
    const std::uint64_t grown = growth_while(work);
    const bool told = write(ends[1], &grown, sizeof grown) == static_cast<ssize_t>(sizeof grown);
    _exit(told ? 0 : 1);
  }
  close(ends[1]);
  std::uint64_t grown = 0;
  if (child < 0 || read(ends[0], &grown, sizeof grown) != static_cast<ssize_t>(sizeof grown)) grown = 0;
  close(ends[0]);
  if (child > 0) waitpid(child, nullptr, 0);
  return grown;
}

Row speed_row(std::string name, const DuelResult& result, std::uint64_t ours_bytes, std::uint64_t octomap_bytes) {
  Row row;
  row.add("name", name)
      .add_truth("checked", true)
      .add("ours_s", result.ours_s)
      .add("octomap_s", result.peer_s)
      .add("ratio", result.ratio)
      .add("ratio_min", result.ratio_min)
      .add("ratio_max", result.ratio_max)
      .add("ours_bytes", ours_bytes)
      .add("octomap_bytes", octomap_bytes);
  return row;
}

}  // namespace pingvox::bench
