#include "growth.hpp"

#include <fmt/core.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <numeric>

#include "bench/duel.hpp"
#include "pingvox/map/compare.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/mapping/beam_model.hpp"
#include "pingvox/sim/random.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.05;
constexpr std::array<std::uint64_t, 5> kSizes = {10'000, 100'000, 1'000'000, 10'000'000, 100'000'000};
/// What the time at the largest size may be of that at the smallest.
constexpr double kMostGrowth = 1.3;
constexpr std::size_t kProbes = 25;
/// The smallest map is small, and so is the first block.
constexpr std::uint16_t kEdge = 16, kMiddle = 32768;
constexpr std::uint64_t kBlock = std::uint64_t{kEdge} * kEdge * kEdge;

/// Water and walls of a basin, filled block by block: no eight cells in a cube are the same, so nothing is joined and
/// each cell takes what a cell may take.
class Basin {
 public:
  explicit Basin(OccupancyMap& map) : map_(map) {}

  /// Fills at least up to so many known cells. @return the error of the block that did not go in
  Result<void> fill(std::uint64_t cells) {
    while (filled_ < cells) {
      for (int blocks = 0; blocks < 16 && filled_ < cells; ++blocks) mark_next();
      const auto applied = map_.apply(scan_);
      scan_.clear();
      if (!applied) return tl::unexpected(applied.error());
    }
    return {};
  }
  std::uint64_t filled() const { return filled_; }

 private:
  /// Rows of 100 blocks (80 m), eight rows to a layer more: the basin grows to the side and upwards.
  void mark_next() {
    const std::uint64_t n = next_++;
    const auto place = [](std::uint64_t block) { return static_cast<std::uint16_t>(kMiddle + block * kEdge); };
    const std::uint16_t x0 = place(n % 100), y0 = place(n / 100 % 100), z0 = place(n / 10'000);
    const LogOdds hit = LogOdds::from_probability(0.7);
    for (std::uint16_t x = 0; x < kEdge; ++x) {
      for (std::uint16_t y = 0; y < kEdge; ++y) {
        std::uint64_t bits = random_.bits();
        for (std::uint16_t z = 0; z < kEdge; ++z, bits >>= 1U) {
          const Key key{static_cast<std::uint16_t>(x0 + x), static_cast<std::uint16_t>(y0 + y),
                        static_cast<std::uint16_t>(z0 + z)};
          if ((bits & 1U) != 0) {
            scan_.add_hit(key, hit);
          } else {
            scan_.add_miss(key);
          }
        }
      }
    }
    filled_ += kBlock;
  }

  OccupancyMap& map_;
  ScanUpdate scan_;
  Random random_{15};
  std::uint64_t next_ = 0, filled_ = 0;
};

/// One beam, a cone with its echo at 2 m, heard at the n-th of a row of places in water that is not known yet. All
/// places are alike: a multiple of 128 cells apart.
ScanUpdate probe(const Lattice& lattice, std::size_t n) {
  const double step_m = 128 * kCell_m;
  Pose map_from_sensor = Pose::Identity();
  map_from_sensor.translation() = Eigen::Vector3d(step_m * static_cast<double>(n % 100) + 0.02,
                                                  -step_m * (2.0 + static_cast<double>(n / 100)) + 0.02, 0.02);
  Beam beam;
  beam.bearing_rad = 0.3;
  Echo echo;
  echo.range_m = 2.0;
  echo.intensity = 200;
  ScanUpdate scan;
  trace_beam(lattice, map_from_sensor, beam, echo, {.shape = BeamShape::kCone}, scan);
  return scan;
}

/// Makes the processor's caches forget the map, so that the sizes do not differ by what they happen to remember.
void empty_caches() {
  std::vector<std::uint64_t> other(std::size_t{64} << 17U);
  std::iota(other.begin(), other.end(), std::uint64_t{1});
  volatile std::uint64_t sum = std::accumulate(other.begin(), other.end(), std::uint64_t{0});
  (void)sum;
}

struct Probes {
  double new_us = 0.0;    ///< median time to apply a probe where nothing was known
  double again_us = 0.0;  ///< the same once more, at the places of the smallest map
  std::uint64_t cells = 0;
};

/// Applies kProbes fresh ones, and the first kProbes again. By the wall clock: asking for CPU time may take as long as
/// a probe, and the median leaves out what the machine did meanwhile.
Result<Probes> probed(OccupancyMap& map, std::size_t first) {
  std::vector<double> new_us, again_us;
  Probes result;
  const auto timed = [&](std::size_t n, std::vector<double>& times_us) -> Result<ApplyReport> {
    const ScanUpdate scan = probe(map.lattice(), n);
    const auto started = std::chrono::steady_clock::now();
    auto applied = map.apply(scan);
    times_us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - started).count());
    return applied;
  };
  empty_caches();
  for (std::size_t n = 0; n < kProbes; ++n) {
    if (const auto again = first > 0 ? timed(n, again_us) : ApplyReport{}; !again) {
      return tl::unexpected(again.error());
    }
  }
  empty_caches();
  for (std::size_t n = first; n < first + kProbes; ++n) {
    const auto applied = timed(n, new_us);
    if (!applied) return tl::unexpected(applied.error());
    result.cells += applied->cells_freed + applied->cells_hit;
  }
  result.new_us = median(new_us);
  if (first > 0) result.again_us = median(again_us);
  return result;
}

std::uint64_t known_cells(const OccupancyMap& map) {
  const MapCounts counts = map.counts();
  return counts.occupied_cells + counts.free_cells + counts.undecided_cells;
}

Result<std::vector<Row>> rows_by_size() {
  OccupancyMap map({.resolution_m = kCell_m});
  Basin basin(map);
  std::vector<Row> rows;
  std::uint64_t probe_cells = 0;
  double first_us = 0.0;
  for (std::size_t i = 0; i < kSizes.size(); ++i) {
    if (const auto filled = basin.fill(kSizes[i]); !filled) return tl::unexpected(filled.error());
    const std::uint64_t cells = basin.filled() + probe_cells;
    const std::size_t bytes = map.memory_bytes();
    if (known_cells(map) != cells) {
      return fail(Error::Code::kCorrupt, fmt::format("{} cells are known, {} were filled", known_cells(map), cells));
    }
    const auto probes = probed(map, i * kProbes);
    if (!probes) return tl::unexpected(probes.error());
    probe_cells += probes->cells;
    if (i == 0) first_us = probes->new_us;
    Row row;
    row.add("name", "growth")
        .add_truth("checked", true)
        .add("cells", cells)
        .add("apply_us", probes->new_us)
        .add("growth", probes->new_us / first_us)
        .add_truth("within", probes->new_us <= kMostGrowth * first_us);
    if (i > 0) {
      row.add("apply_again_us", probes->again_us);
    } else {
      row.add_nothing("apply_again_us");
    }
    row.add("memory_bytes", std::uint64_t{bytes})
        .add("bytes_per_cell", static_cast<double>(bytes) / static_cast<double>(cells));
    rows.push_back(row);
  }
  return rows;
}

/// Fills a map step by step, `most` of them at most. @return how many went in before the limit stopped it
Result<std::uint64_t> steps_into(Basin& basin, std::uint64_t most) {
  for (std::uint64_t step = 0; step < most; ++step) {
    const auto filled = basin.fill(basin.filled() + 16 * kBlock);
    if (filled) continue;
    if (filled.error().code != Error::Code::kLimit) return tl::unexpected(filled.error());
    return step;
  }
  return most;
}

/// Fills a map until its limit stops it, and looks whether it is what it was before.
Result<Row> row_of_limit() {
  constexpr std::size_t kLimit_bytes = std::size_t{64} << 20U;
  constexpr std::uint64_t kMostSteps = kSizes.back() / (16 * kBlock);
  const MapOptions options{.resolution_m = kCell_m, .memory_limit_bytes = kLimit_bytes};
  OccupancyMap first(options), map(options);
  Basin into_first(first), into_map(map);
  const auto steps = steps_into(into_first, kMostSteps);
  if (!steps) return tl::unexpected(steps.error());
  if (const auto again = steps_into(into_map, *steps); !again || *again != *steps) {
    return fail(Error::Code::kCorrupt, fmt::format("the limit let {} scans in at first", *steps));
  }
  const OccupancyMap before = map;
  const auto refused = steps_into(into_map, 1);
  if (*steps == kMostSteps || !refused || *refused != 0) {
    return fail(Error::Code::kCorrupt, "the memory limit stopped nothing");
  }
  const auto found = compare_maps(before, map, Sameness::kLogOdds);
  if (!found) return tl::unexpected(found.error());
  if (!found->equal() || found->cells() == 0 || map.memory_bytes() != before.memory_bytes() ||
      map.memory_bytes() > kLimit_bytes) {
    return fail(Error::Code::kCorrupt,
                fmt::format("at its limit of {} bytes the map changed: {} cells differ, {} bytes", kLimit_bytes,
                            found->cells() - found->same, map.memory_bytes()));
  }
  Row row;
  row.add("name", "growth-limit")
      .add_truth("checked", true)
      .add("cells", known_cells(map))
      .add("memory_limit_bytes", std::uint64_t{kLimit_bytes})
      .add("memory_bytes", std::uint64_t{map.memory_bytes()});
  return row;
}

}  // namespace

Result<std::vector<Row>> growth(const BenchOptions&) {
  Result<std::vector<Row>> rows = rows_by_size();
  if (!rows) return rows;
  const Result<Row> limit = row_of_limit();
  if (!limit) return tl::unexpected(limit.error());
  rows->push_back(*limit);
  return rows;
}

}  // namespace pingvox::bench
