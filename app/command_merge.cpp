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
    if (axes && *axes != maps[i].axes) return MapAxes::kUnknown;
    axes = maps[i].axes;
  }
  return axes.value_or(MapAxes::kUnknown);
}

/// The box around a box that is moved.
Box moved_box(const Box& box, const Pose& pose) {
  const Eigen::Vector3d middle = pose * Eigen::Vector3d(0.5 * (box.min + box.max));
  const Eigen::Vector3d half = pose.linear().cwiseAbs() * (0.5 * (box.max - box.min));
  return {middle - half, middle + half};
}

bool overlap(const Box& a, const Box& b) {
  return (a.min.array() < b.max.array()).all() && (a.max.array() > b.min.array()).all();
}

/// What speaks against one frame of the maps, said before they are added.
void say_doubts(const std::vector<MapFile>& maps, const std::vector<Pose>& poses, const MergeCommand& command,
                const Console& console) {
  std::optional<Box> all;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const std::string& name = command.maps[i];
    if (i > 0 && !command.at.contains(name) && !command.at.contains(command.maps[0]) && maps[i].axes != maps[0].axes) {
      console.say(
          fmt::format("{} and {}: one map has x east and y north, the other does not say so: their frames may "
                      "differ (--at)",
                      command.maps[0], name));
    }
    const std::optional<Box> bounds = maps[i].map.bounds();
    if (!bounds) continue;
    const Box box = moved_box(*bounds, poses[i]);
    if (all && !overlap(*all, box)) console.say(name + ": has no place in common with the maps before it (--at)");
    all = all ? Box{all->min.cwiseMin(box.min), all->max.cwiseMax(box.max)} : box;
  }
}

}  // namespace

Result<int> run(const MergeCommand& command, Console& console) {
  std::vector<MapFile> maps;
  for (const std::string& name : command.maps) {
    Result<MapFile> read = read_file(name).and_then([](const FileBytes& file) { return read_map(file); });
    if (!read) return tl::unexpected(read.error());
    maps.push_back(*std::move(read));
  }
  std::vector<Pose> poses;
  for (const std::string& name : command.maps) {
    const auto at = command.at.find(name);
    poses.push_back(at == command.at.end() ? Pose::Identity() : at->second);
  }
  say_doubts(maps, poses, command, console);
  Result<OccupancyMap> sum = OccupancyMap::make(options_of_sum(maps, command.resolution_m));
  if (!sum) return tl::unexpected(sum.error());
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const std::string& name = command.maps[i];
    if (const auto added = add_map(maps[i].map, poses[i], *sum); !added) {
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
