#include "map_files.hpp"

#include <fmt/core.h>

#include <optional>
#include <sstream>
#include <string>

#include "bench/paired_timing.hpp"
#include "pingvox/io/maps.hpp"
#include "same_map.hpp"
#include "silent_stderr.hpp"
#include "tank_maps.hpp"

namespace pingvox::bench {
namespace {

Result<std::string> bt_of(const OccupancyMap& map) {
  std::ostringstream out;
  if (const auto written = write_map(map, Format::kBt, "", out); !written) return tl::unexpected(written.error());
  return std::move(out).str();
}

/// Time to write a map and keep it: liboctomap rounds and prunes the map that it writes, so it needs a copy.
double cpu_of_whole_write_s(const octomap::OcTree& tree) {
  std::vector<double> times;
  for (int run = 0; run < 5; ++run) {
    octomap::OcTree copy(tree);
    std::ostringstream out;
    const double started = cpu_time_s();
    copy.writeBinary(out);
    times.push_back(cpu_time_s() - started);
  }
  return median(times);
}

}  // namespace

Result<std::vector<Row>> bt_write(const BenchOptions&) {
  const Result<TankMaps> maps = tank_maps();
  if (!maps) return tl::unexpected(maps.error());
  const SilentStderr silent_stderr;
  const double whole_s = cpu_of_whole_write_s(*maps->peer);
  // Rounded before, so that its faster writeBinaryConst gives the same bytes. Ours rounds as it writes.
  maps->peer->toMaxLikelihood();
  maps->peer->prune();
  std::ostringstream ours_out, peer_out;
  const Side ours{[&] { ours_out = std::ostringstream(); },
                  [&] { (void)write_map(maps->ours, Format::kBt, "", ours_out); }};
  const Side peer{[&] { peer_out = std::ostringstream(); }, [&] { maps->peer->writeBinaryConst(peer_out); }};
  const PairedTimes result = time_in_pairs(ours, peer, {.pairs = 21});
  if (ours_out.view().empty() || ours_out.view() != peer_out.view()) {
    return fail(Error::Code::kCorrupt, fmt::format("{} bytes are not the {} bytes that liboctomap writes",
                                                   ours_out.view().size(), peer_out.view().size()));
  }
  Row row = speed_row("bt-write", result, {});
  row.add("input", maps->input)
      .add_truth("same_bytes", true)
      .add("bytes", std::uint64_t{ours_out.view().size()})
      .add("octomap_write_binary_s", whole_s);
  return std::vector{row};
}

Result<std::vector<Row>> bt_read(const BenchOptions&) {
  const Result<TankMaps> maps = tank_maps();
  if (!maps) return tl::unexpected(maps.error());
  const SilentStderr silent_stderr;
  const Result<std::string> bytes = bt_of(maps->ours);
  if (!bytes) return tl::unexpected(bytes.error());
  const FileBytes file{"tank.bt", {bytes->begin(), bytes->end()}};
  std::optional<Result<MapFile>> map;
  std::unique_ptr<octomap::OcTree> tree;
  std::istringstream in;
  const Side ours{[&] { map.reset(); }, [&] { map.emplace(read_map(file)); }};
  const Side peer{[&] {
                    tree = std::make_unique<octomap::OcTree>(0.1);
                    in = std::istringstream(*bytes);
                  },
                  [&] { tree->readBinary(in); }};
  const PairedTimes result = time_in_pairs(ours, peer, {.pairs = 21});
  if (!*map) return tl::unexpected(map->error());
  if (const auto same = check_identical(map->value().map, *tree); !same) return tl::unexpected(same.error());
  Row row = speed_row("bt-read", result, {});
  row.add("input", maps->input).add("bytes", std::uint64_t{bytes->size()});
  return std::vector{row};
}

}  // namespace pingvox::bench
