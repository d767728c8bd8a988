#include <fmt/format.h>

#include <array>
#include <optional>

#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kLogAndMapFormats = {
    Word<Format>{"csv", Format::kCsv},  Word<Format>{"bt", Format::kBt},     Word<Format>{"ot", Format::kOt},
    Word<Format>{"pvx", Format::kPvx},  Word<Format>{"ply", Format::kPly},   Word<Format>{"pcd", Format::kPcd},
    Word<Format>{"pgm", Format::kGrid}, Word<Format>{"yaml", Format::kGrid}, Word<Format>{"asc", Format::kAsc}};
constexpr std::array kSurfaces = {Word<Surface>{"highest", Surface::kHighest},
                                  Word<Surface>{"lowest", Surface::kLowest}};

}  // namespace

Result<Command> convert_command(const Words& words) {
  ConvertCommand command;
  std::optional<Format> asked_format;
  const Take format = [&](const std::string& text) -> Result<void> {
    const Result<Format> value = value_of(kLogAndMapFormats, text);
    if (!value) return tl::unexpected(value.error());
    asked_format = *value;
    return {};
  };
  std::optional<double> layer_m;
  std::optional<Surface> surface;
  const Take take_surface = [&](const std::string& text) -> Result<void> {
    const Result<Surface> value = value_of(kSurfaces, text);
    if (!value) return tl::unexpected(value.error());
    surface = *value;
    return {};
  };
  const OptionTable table{
      "convert",
      "Writes a file in another format: a log of beams as CSV; a map as another map, as a cloud of points, as a grid\n"
      "for ROS's map_server, or as heights; a mesh as the map of its surface.",
      {{"IN", Positional::Count::kOne, "a log of beams, a map or a mesh (OFF, PLY, STL); - is standard input",
        into(command.input)}},
      {{"Options",
        {output_option(command.output,
                       "what to write: .csv from a log; .bt .ot .pvx from a map or a mesh, and .ply .pcd (points), "
                       ".yaml with its .pgm (map_server), .asc (ESRI grid of heights); - is standard output"),
         {"--format", 0, words_of(kLogAndMapFormats), "format of the output, whatever its name", "by suffix, else csv",
          format},
         strict_option(command.damage),
         quiet_option(command.manner)}},
       {"Meshes",
        {{"--resolution", 0, "M", "edge of a cell", shown(MapOptions{}.resolution_m),
          into_optional(command.resolution_m)}}},
       {"Grids and heights",
        {{"--z", 0, "M", "only the layer of cells that holds this height", "all layers", into_optional(layer_m)},
         {"--min-z", 0, "M", "no layer below", "none", into_optional(command.slice.min_z_m)},
         {"--max-z", 0, "M", "no layer above", "none", into_optional(command.slice.max_z_m)},
         {"--height", 0, words_of(kSurfaces),
          "which occupied cell of a column gives its height, that of its upper face",
          word_of(kSurfaces, command.surface), take_surface}}}},
      {"pingvox convert tank.mat -o tank.csv", "pingvox convert tank.bt -o tank.ply",
       "pingvox convert harbour.bt -o harbour.yaml --min-z -0.5 --max-z 0.5", "pingvox convert seabed.ot -o seabed.asc",
       "pingvox convert hull.stl -o hull.bt --resolution 0.1"},
      "A column of a grid is occupied when any of its cells is, free when one is and none is occupied, else unknown."};
  return parsed(table, words, [&]() -> Result<Command> {
    if (format_for_writing(command.output) == Format::kPng) {
      return off(fmt::format("{}: pictures are drawn by 'pingvox render'", command.output));
    }
    const Result<Format> output_as = output_format(command.output, asked_format, kLogAndMapFormats);
    if (!output_as) return tl::unexpected(output_as.error());
    command.format = *output_as;
    const bool is_grid = command.format == Format::kGrid, is_heights = command.format == Format::kAsc;
    const bool is_sliced = layer_m || command.slice.min_z_m || command.slice.max_z_m;
    if (is_sliced && !is_grid && !is_heights) {
      return off("--z, --min-z and --max-z: only for grids and heights, .yaml, .pgm and .asc");
    }
    if (surface && !is_heights) return off("--height: only for heights, .asc");
    command.surface = surface.value_or(command.surface);
    if (layer_m && (command.slice.min_z_m || command.slice.max_z_m)) return off("--z is both --min-z and --max-z");
    if (layer_m) command.slice = {layer_m, layer_m};
    if (const auto valid = command.slice.validate(); !valid) return tl::unexpected(valid.error());
    if (command.resolution_m) {
      if (const auto lattice = Lattice::make(*command.resolution_m); !lattice) return tl::unexpected(lattice.error());
    }
    if (is_grid && command.output == "-") return off("-o -: of a grid, two files are written: name the first one");
    if (const auto folder = check_folder_of(command.output); !folder) return tl::unexpected(folder.error());
    return command;
  });
}

}  // namespace pingvox::app
