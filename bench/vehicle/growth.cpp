#include "growth.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <utility>

#include "bench/paired_timing.hpp"
#include "mapping/internal/insonified_volume.hpp"
#include "pingvox/analysis/compare.hpp"
#include "pingvox/geometry/random.hpp"
#include "pingvox/map/scan_update.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.05;
constexpr std::array<std::uint64_t, 5> kSizes = {10'000, 100'000, 1'000'000, 10'000'000, 100'000'000};
/// Maximum ratio of the time in a large map to that in the smallest.
constexpr double kMaxGrowth = 1.3;
constexpr std::size_t kPlaces = 5, kRounds = 100;
/// Edge of a block and centre of the lattice [cells].
constexpr std::uint16_t kEdge = 16, kMiddle = 32768;
constexpr std::uint64_t kBlock = std::uint64_t{kEdge} * kEdge * kEdge;

/// A basin filled block by block. No octant is uniform, so nothing is pruned: the largest memory a cell can take.
class Basin {
 public:
  explicit Basin(OccupancyMap& map) : map_(map) {}

  /// Fills up to at least this many known cells. @return the error of the first block that fails
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
  /// Rows of 100 blocks (80 m), eight rows to a layer: the basin grows sideways, then upwards.
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
  ScanUpdate scan_{map_.lattice()};
  Random random_{15};
  std::uint64_t next_ = 0, filled_ = 0;
};

/// The n-th of many equivalent beams in unknown water, multiples of 128 cells apart.
InsonifiedVolume beam_at(std::size_t n) {
  const double step_m = 128 * kCell_m;
  const std::size_t row = n / 100, column = n % 100;
  InsonifiedVolume beam{.bearing_rad = 0.3, .width_rad = 0.052, .height_rad = 0.61, .range_m = 2.0};
  beam.map_from_sensor.translation() = Eigen::Vector3d(step_m * static_cast<double>(column) + 0.02,
                                                       -step_m * (2.0 + static_cast<double>(row)) + 0.02, 0.02);
  return beam;
}

/// A small scan: the water before an echo at 2 m, in a beam of 3 x 35 degrees: some 1500 cells.
ScanUpdate probe(const Lattice& lattice, std::size_t n) {
  ScanUpdate scan(lattice);
  trace_volume(beam_at(n), scan);
  return scan;
}

/// Reverts the misses of a probe, so that it can be applied again.
ScanUpdate undo_probe(const Lattice& lattice, std::size_t n) {
  ScanUpdate scan(lattice, LogOdds(-ScanUpdate(lattice).miss().value()));
  trace_volume(beam_at(n), scan);
  return scan;
}

/// Wall time, as reading the CPU clock may take as long as a probe.
Result<ApplyReport> time_apply(OccupancyMap& map, const ScanUpdate& scan, std::vector<double>& times_us) {
  const auto started = std::chrono::steady_clock::now();
  auto applied = map.apply(scan);
  times_us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - started).count());
  return applied;
}

/// Applies kPlaces probes, from number `first` on. @return number of updated cells
Result<std::uint64_t> cells_of_probes(OccupancyMap& map, std::size_t first, std::vector<double>& times_us) {
  std::uint64_t cells = 0;
  for (std::size_t n = first; n < first + kPlaces; ++n) {
    const auto applied = time_apply(map, probe(map.lattice(), n), times_us);
    if (!applied) return tl::unexpected(applied.error());
    cells += applied->cells_freed + applied->cells_hit;
  }
  return cells;
}

Result<void> undo_probes(OccupancyMap& map) {
  for (std::size_t n = 0; n < kPlaces; ++n) {
    if (const auto applied = map.apply(undo_probe(map.lattice(), n)); !applied) return tl::unexpected(applied.error());
  }
  return {};
}

struct Known {
  double small_us = 0.0, large_us = 0.0;  ///< medians
};

/// Applies the first kPlaces probes repeatedly, alternating between a small and a large map.
Result<Known> probe_again(OccupancyMap& small, OccupancyMap& large) {
  std::vector<double> small_us, large_us;
  for (std::size_t round = 0; round < kRounds; ++round) {
    for (const auto& [map, times_us] : {std::pair(&small, &small_us), std::pair(&large, &large_us)}) {
      if (const auto back = undo_probes(*map); !back) return tl::unexpected(back.error());
      if (const auto again = cells_of_probes(*map, 0, *times_us); !again) return tl::unexpected(again.error());
    }
  }
  return Known{median(small_us), median(large_us)};
}

std::uint64_t known_cells(const OccupancyMap& map) {
  const MapCounts counts = map.counts();
  return counts.occupied_cells + counts.free_cells + counts.undecided_cells;
}

Result<std::vector<Row>> rows_by_size() {
  const MapOptions options{.resolution_m = kCell_m};
  OccupancyMap small(options), map(options);
  Basin small_basin(small), basin(map);
  std::vector<double> unused_us;
  Result<std::uint64_t> probe_cells = cells_of_probes(small, 0, unused_us);
  if (probe_cells) probe_cells = cells_of_probes(map, 0, unused_us);
  if (!probe_cells) return tl::unexpected(probe_cells.error());
  if (const auto filled = small_basin.fill(kSizes[0] - *probe_cells); !filled) return tl::unexpected(filled.error());

  std::vector<Row> rows;
  std::uint64_t cells_of_places = *probe_cells;
  for (std::size_t i = 0; i < kSizes.size(); ++i) {
    if (const auto filled = basin.fill(kSizes[i] - std::min(kSizes[i], cells_of_places)); !filled) {
      return tl::unexpected(filled.error());
    }
    const std::uint64_t cells = basin.filled() + cells_of_places;
    const std::size_t bytes = map.memory_bytes();
    if (known_cells(map) != cells) {
      return fail(Error::Code::kCorrupt, fmt::format("{} cells are known, {} were filled", known_cells(map), cells));
    }
    const auto known = probe_again(small, map);
    if (!known) return tl::unexpected(known.error());
    std::vector<double> new_us;
    const auto new_cells = cells_of_probes(map, (i + 1) * kPlaces, new_us);
    if (!new_cells) return tl::unexpected(new_cells.error());
    cells_of_places += *new_cells;
    Row row;
    row.add("name", "growth")
        .add_truth("checked", true)
        .add("cells", cells)
        .add("apply_us", known->large_us)
        .add("growth", known->large_us / known->small_us)
        .add_truth("within", known->large_us <= kMaxGrowth * known->small_us)
        .add("apply_new_us", median(new_us))
        .add("memory_bytes", std::uint64_t{bytes})
        .add("bytes_per_cell", static_cast<double>(bytes) / static_cast<double>(cells));
    rows.push_back(row);
  }
  return rows;
}

/// Fills a map in at most `most` steps. @return number of steps before the limit
Result<std::uint64_t> fill_basin(Basin& basin, std::uint64_t most) {
  for (std::uint64_t step = 0; step < most; ++step) {
    const auto filled = basin.fill(basin.filled() + 16 * kBlock);
    if (filled) continue;
    if (filled.error().code != Error::Code::kLimit) return tl::unexpected(filled.error());
    return step;
  }
  return most;
}

/// Fills a map up to its memory limit and checks that the failed update left it unchanged.
Result<Row> row_of_limit() {
  constexpr std::size_t kLimit_bytes = std::size_t{64} << 20U;
  constexpr std::uint64_t kMaxSteps = kSizes.back() / (16 * kBlock);
  const MapOptions options{.resolution_m = kCell_m, .memory_limit_bytes = kLimit_bytes};
  OccupancyMap first(options), map(options);
  Basin first_basin(first), basin(map);
  const auto steps = fill_basin(first_basin, kMaxSteps);
  if (!steps) return tl::unexpected(steps.error());
  if (const auto again = fill_basin(basin, *steps); !again || *again != *steps) {
    return fail(Error::Code::kCorrupt, fmt::format("the limit let {} scans in at first", *steps));
  }
  const OccupancyMap before = map;
  const auto refused = fill_basin(basin, 1);
  if (*steps == kMaxSteps || !refused || *refused != 0) {
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
