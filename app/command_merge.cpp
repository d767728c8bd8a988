#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "map_report.hpp"
#include "pingvox/analysis/resample.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"

namespace pingvox::app {
namespace {

/// As the first map, but for the cells.
MapOptions options_of_sum(const std::vector<MapFile>& maps, std::optional<double> resolution_m) {
  MapOptions options = maps.front().map.options();
  for (const MapFile& file : maps) {
    const Lattice& lattice = file.map.lattice();
    options.depth = std::max(options.depth, lattice.depth());
    options.resolution_m = std::max(options.resolution_m.value_or(0.0), lattice.resolution_m());
  }
  if (resolution_m) options.resolution_m = resolution_m;
  options.memory_limit_bytes = 0;
  return options;
}

/// Those that all have; a map that was moved has those of the others.
MapAxes axes_of_sum(const std::vector<MapFile>& maps, const MergeCommand& command) {
  std::optional<MapAxes> axes;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (command.at.contains(command.maps[i])) continue;
    if (axes && *axes != maps[i].axes) return MapAxes::kNotTold;
    axes = maps[i].axes;
  }
  return axes.value_or(MapAxes::kNotTold);
}

}  // namespace

Result<int> run(const MergeCommand& command, Console& console) {
  std::vector<MapFile> maps;
  for (const std::string& name : command.maps) {
    Result<MapFile> read = read_file(name).and_then([](const FileBytes& file) { return read_map(file); });
    if (!read) return tl::unexpected(read.error());
    maps.push_back(*std::move(read));
  }
  Result<OccupancyMap> sum = OccupancyMap::make(options_of_sum(maps, command.resolution_m));
  if (!sum) return tl::unexpected(sum.error());
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const std::string& name = command.maps[i];
    const auto at = command.at.find(name);
    const Pose pose = at == command.at.end() ? Pose::Identity() : at->second;
    if (const auto added = add_map(maps[i].map, pose, *sum); !added) {
      return fail(added.error().code, fmt::format("{}: {}", name_of_input(name), added.error().message));
    }
  }
  const auto written = write_map(*sum, command.format, command.made_by, command.output, axes_of_sum(maps, command));
  if (!written) return tl::unexpected(written.error());
  if (sum->empty()) console.say(empty_map_text(command.output));
  const MapCounts counts = sum->counts();
  if (command.output_options.report == Report::kJson) {
    JsonObject json;
    json.add("maps", std::uint64_t{maps.size()}).add("map", map_json(*sum, counts));
    if (const auto printed = console.print(json.text() + "\n"); !printed) return tl::unexpected(printed.error());
    return 0;
  }
  const auto printed = console.summarise(
      fmt::format("{}: {} added\n", command.output, counted(maps.size(), "map")) + map_text(*sum, counts),
      command.output);
  if (!printed) return tl::unexpected(printed.error());
  return 0;
}

}  // namespace pingvox::app
