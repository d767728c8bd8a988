#include "startup.hpp"

#include <algorithm>

#include "bench/paired_timing.hpp"
#include "bench/process.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"

namespace pingvox::bench {
namespace {

constexpr int kStarts = 20;

/// A box of 10 x 10 x 10 occupied cells.
OccupancyMap small_map() {
  OccupancyMap map({.resolution_m = 0.05});
  Editor editor = map.edit();
  for (std::uint16_t x = 0; x < 10; ++x) {
    for (std::uint16_t y = 0; y < 10; ++y) {
      for (std::uint16_t z = 0; z < 10; ++z) {
        editor.update(Key{static_cast<std::uint16_t>(32768 + x), static_cast<std::uint16_t>(32768 + y),
                          static_cast<std::uint16_t>(32768 + z)},
                      LogOdds::from_probability(0.7));
      }
    }
  }
  editor.synchronize();
  return map;
}

}  // namespace

Result<std::vector<Row>> startup(const BenchOptions&) {
  const Result<std::string> program = pingvox_program();
  if (!program) return tl::unexpected(program.error());
  const Result<Scratch> scratch = Scratch::make();
  if (!scratch) return tl::unexpected(scratch.error());
  const std::string path = scratch->path("small.bt");
  const OccupancyMap map = small_map();
  const auto written = write_file(path, [&](std::ostream& out) { return write_map(map, Format::kBt, "", out); });
  if (!written) return tl::unexpected(written.error());
  std::vector<double> wall_ms;
  for (int i = 0; i < kStarts; ++i) {
    const auto run = run_or_fail({*program, "info", path, "--json"});
    if (!run) return tl::unexpected(run.error());
    if (run->said.find("\"occupied_cells\":1000") == std::string::npos &&
        run->said.find("\"occupied_cells\": 1000") == std::string::npos) {
      return fail(Error::Code::kCorrupt, "pingvox info does not see the 1000 occupied cells: " + run->said);
    }
    wall_ms.push_back(1e3 * run->wall_s);
  }
  const auto [min, max] = std::minmax_element(wall_ms.begin(), wall_ms.end());
  Row row;
  row.add("name", "startup")
      .add_truth("checked", true)
      .add("wall_ms", median(wall_ms))
      .add("wall_ms_min", *min)
      .add("wall_ms_max", *max);
  return std::vector{row};
}

}  // namespace pingvox::bench
