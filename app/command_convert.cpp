#include <fmt/core.h>

#include <filesystem>
#include <utility>

#include "commands.hpp"
#include "map_report.hpp"
#include "open_log.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/grids.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/mesh.hpp"
#include "pingvox/map/slice.hpp"
#include "pingvox/map/surface_map.hpp"
#include "write_map_file.hpp"

namespace pingvox::app {
namespace {

bool is_made_of_maps(FormatKind kind) {
  return kind == FormatKind::kMap || kind == FormatKind::kCloud || kind == FormatKind::kGrid;
}

tl::unexpected<Error> does_not_become(const std::string& name, Format from, Format to) {
  const bool to_map = is_made_of_maps(kind_of(to));
  const FormatKind kind = kind_of(from);
  const bool is_log = kind == FormatKind::kBeams || kind == FormatKind::kScans || kind == FormatKind::kCloud;
  return fail(Error::Code::kBadOption,
              fmt::format("convert: {}: is {}, which does not become .{}{}", name, described(from), name_of(to),
                          to_map && is_log ? ": 'pingvox map' does that" : ""));
}

/// What is written from a log, and how much of it there was.
Result<std::string> convert_log(ByteStream stream, const ConvertCommand& command) {
  const Result<std::unique_ptr<BeamSource>> source = open_beams(std::move(stream), command.damage);
  if (!source) return tl::unexpected(source.error());
  std::size_t beams = 0;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) -> Result<void> {
    const Result<std::size_t> count = write_csv(**source, out);
    if (!count) return tl::unexpected(count.error());
    beams = *count;
    return {};
  });
  if (!written) return tl::unexpected(written.error());
  const std::size_t skipped = (*source)->skipped();
  return fmt::format("{} beams{}", beams, skipped > 0 ? fmt::format("; {} damaged ones left out", skipped) : "");
}

Error with_name(Error error, const std::string& name) {
  error.message = fmt::format("{}: {}", name, error.message);
  return error;
}

/// The map of a mesh's surface, as if it had been read.
Result<MapFile> map_of_mesh(const FileBytes& file, const ConvertCommand& command) {
  const Result<TriangleMesh> mesh = read_mesh(file);
  if (!mesh) return tl::unexpected(mesh.error());
  MapOptions options;
  options.resolution_m = command.resolution_m.value_or(options.resolution_m);
  Result<OccupancyMap> map = surface_map(*mesh, options);
  if (!map) return tl::unexpected(with_name(map.error(), file.name));
  return MapFile{command.format, *std::move(map), fmt::format("the surface of {}", file.name)};
}

/// A grid for map_server: the picture, then the file that names it.
Result<std::string> write_grid(const OccupancyMap& map, const ConvertCommand& command) {
  const Result<Raster<Occupancy>> slice = slice_of(map, command.slice);
  if (!slice) return tl::unexpected(with_name(slice.error(), command.input));
  const std::filesystem::path picture = std::filesystem::path(command.output).replace_extension(".pgm");
  const std::filesystem::path about = std::filesystem::path(command.output).replace_extension(".yaml");
  auto written =
      write_file(picture.string(), [&](std::ostream& out) { return write_grid_pgm(*slice, out); }).and_then([&] {
        return write_file(about.string(),
                          [&](std::ostream& out) { return write_grid_yaml(*slice, picture.filename().string(), out); });
      });
  if (!written) return tl::unexpected(written.error());
  return fmt::format("{} x {} cells, and its {}", slice->columns, slice->rows,
                     on_one_line((command.output == about.string() ? picture : about).string()));
}

Result<std::string> write_heights(const OccupancyMap& map, const ConvertCommand& command) {
  const Result<Raster<float>> heights = heights_of(map, command.slice, command.surface);
  if (!heights) return tl::unexpected(with_name(heights.error(), command.input));
  const Result<void> written =
      write_file(command.output, [&](std::ostream& out) { return write_heights_asc(*heights, out); });
  if (!written) return tl::unexpected(written.error());
  return fmt::format("heights of {} x {} columns", heights->columns, heights->rows);
}

Result<std::string> convert_map(const MapFile& read, const ConvertCommand& command) {
  if (command.format == Format::kGrid) return write_grid(read.map, command);
  if (command.format == Format::kAsc) return write_heights(read.map, command);
  const Result<void> written = write_map_file(command.output, read.map, command.format, read.made_by);
  if (!written) return tl::unexpected(written.error());
  const MapCounts counts = read.map.counts();
  if (kind_of(command.format) == FormatKind::kCloud) {
    return fmt::format("{} occupied cells as points, joined ones as one", counts.occupied_cells);
  }
  return fmt::format("{} occupied and {} free cells", counts.occupied_cells, counts.free_cells);
}

Result<std::string> convert(ByteStream stream, Format format, const ConvertCommand& command) {
  const FormatKind from = kind_of(format), to = kind_of(command.format);
  if (command.resolution_m && from != FormatKind::kMesh) {
    return fail(Error::Code::kBadOption,
                fmt::format("convert: --resolution: only for meshes, and {} is {}", stream.name(), described(format)));
  }
  if (from == FormatKind::kBeams && to == FormatKind::kBeams) return convert_log(std::move(stream), command);
  const bool is_map = from == FormatKind::kMap, is_mesh = from == FormatKind::kMesh;
  if (!is_made_of_maps(to) || (!is_map && !is_mesh)) {
    return does_not_become(stream.name(), format, command.format);
  }
  const Result<FileBytes> file = ByteStream::whole(std::move(stream));
  if (!file) return tl::unexpected(file.error());
  const Result<MapFile> map = is_map ? read_map(*file) : map_of_mesh(*file, command);
  if (!map) return tl::unexpected(map.error());
  return convert_map(*map, command);
}

}  // namespace

Result<int> run(const ConvertCommand& command, Console& console) {
  Result<ByteStream> stream = ByteStream::open(command.input);
  if (!stream) return tl::unexpected(stream.error());
  const Result<Format> format = recognised(*stream);
  if (!format) return tl::unexpected(format.error());

  const Result<std::string> what = convert(std::move(*stream), *format, command);
  if (!what) return tl::unexpected(what.error());
  const auto told = console.summarise(fmt::format("{}: {}\n", on_one_line(command.output), *what), command.output);
  if (!told) return tl::unexpected(told.error());
  return 0;
}

}  // namespace pingvox::app
