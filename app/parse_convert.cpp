#include <fmt/format.h>

#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "command_files.hpp"
#include "mapping_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kLogAndMapFormats = {
    Choice<Format>{"csv", Format::kCsv}, Choice<Format>{"bt", Format::kBt},    Choice<Format>{"ot", Format::kOt},
    Choice<Format>{"pvx", Format::kPvx}, Choice<Format>{"ply", Format::kPly},  Choice<Format>{"pcd", Format::kPcd},
    Choice<Format>{"xyz", Format::kXyz}, Choice<Format>{"pgm", Format::kGrid}, Choice<Format>{"yaml", Format::kGrid},
    Choice<Format>{"asc", Format::kAsc}, Choice<Format>{"tum", Format::kTum}};
constexpr std::array kEchoesOfBeam = {Choice<EchoesOfBeam>{"first", EchoesOfBeam::kFirst},
                                      Choice<EchoesOfBeam>{"all", EchoesOfBeam::kAll}};
constexpr std::array kSurfaces = {Choice<Surface>{"highest", Surface::kHighest},
                                  Choice<Surface>{"lowest", Surface::kLowest}};

}  // namespace

Result<Command> convert_command(const Args& args) {
  ConvertCommand command;
  std::optional<Format> asked_format;
  std::optional<double> layer_m;
  std::optional<Surface> surface;
  EchoArgs echo;
  OptionTable::Group echo_options = echo_group(echo, WaterOfNav::kNo);
  echo_options.title = "Echoes of a log";
  for (Option& option : echo_options.options) {
    option.only_for = {std::string(kEchoTables)};
  }
  Option echoes =
      choice("--echoes", kEchoesOfBeam,
             "write the detected echoes of a log: time, bearing, range, intensity, bins; of each beam the first or all",
             command.echoes, "");
  echoes.implied = choice_name(kEchoesOfBeam, EchoesOfBeam::kFirst);
  echoes.only_for = {std::string(kBeamLogs)};
  echo_options.options.insert(echo_options.options.begin(), std::move(echoes));
  const std::vector<std::string> maps = {std::string(kMaps), std::string(kMeshes)};
  OptionTable table{
      "convert",
      "Writes a file in another format: a log of beams, its echoes or navigation as CSV; navigation as poses;\n"
      "point scans as a cloud; a map as another map, as points, as a grid for ROS's map_server, or as heights; a mesh\n"
      "as the map of its surface.",
      {{"IN", Positional::Count::kOne,
        "a log of beams, of navigation or of point scans (.graph, .log, .xtf), a map or a mesh (OFF, PLY, STL); - is "
        "standard input",
        store(command.input)}},
      {{"Options",
        {output_option(command.output,
                       "the output: .csv from a log; .tum (poses) from a navigation log; .ply .pcd .xyz from point "
                       "scans; .bt .ot .pvx from a map or a "
                       "mesh, .ply .pcd .xyz (occupied cells as points), .yaml with its .pgm (map_server), .asc (ESRI "
                       "grid of heights); - is standard "
                       "output"),
         choice("--format", kLogAndMapFormats, "format of the output where its name has none of these suffixes",
                asked_format, "by suffix, else csv"),
         strict_option(command.damage), topic_option(command.bag), fields_option(command.bag),
         source_option(command.nav_sources), quiet_option(command.output_options)}},
       std::move(echo_options),
       {"Meshes",
        {{"--resolution", 0, "M", "edge length of a cell", number_text(MapOptions::kDefaultResolution_m),
          within(kResolutions, store_optional(command.resolution_m))}}},
       {"Maps and meshes",
        {{"--z", 0, "M", "write only the layer of cells at this height", "all layers", store_optional(layer_m)},
         {"--min-z", 0, "M", "lowest height that is written", "none", store_optional(command.slice.min_z_m)},
         {"--max-z", 0, "M", "greatest height that is written", "none", store_optional(command.slice.max_z_m)},
         choice("--height", kSurfaces,
                "height of a column in .asc: upper face of its highest or its lowest occupied cell", surface,
                choice_name(kSurfaces, command.surface))}}},
      {"pingvox convert tank.mat -o tank.csv", "pingvox convert tank.mat --echoes -o echoes.csv",
       "pingvox convert dive.tlog -o dive.tum", "pingvox convert line.xtf -o line.ply",
       "pingvox convert tank.bt -o tank.ply", "pingvox convert tank.bt -o layer.ply --z 0",
       "pingvox convert harbour.bt -o harbour.yaml --min-z -0.5 --max-z 0.5", "pingvox convert seabed.ot -o seabed.asc",
       "pingvox convert hull.stl -o hull.bt --resolution 0.1"},
      "A column of a grid is occupied if any of its cells is, free if one is free and none is occupied, else unknown."};
  std::vector<Option>& map_options = table.groups[3].options;
  for (Option& option : occupancy_options(command.occupancy)) map_options.push_back(std::move(option));
  for (Option& option : table.groups[2].options) option.only_for = {std::string(kMeshes)};
  for (Option& option : map_options) option.only_for = maps;
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    if (format_for_writing(command.output) == Format::kPng) {
      return usage_error(fmt::format("{}: pictures are drawn by 'pingvox render'", command.output));
    }
    const Result<Format> output_as = output_format(command.output, asked_format, kLogAndMapFormats);
    if (!output_as) return tl::unexpected(output_as.error());
    command.format = *output_as;
    command.limited = parsed.limited;
    command.filter = echo.filter_options();
    command.echo = echo.echo;
    if (const auto valid = echo.validate(); !valid) return tl::unexpected(valid.error());
    command.sound_speed_ratio = echo.sound_speed_ratio();
    command.background_m = echo.background_m;
    if (!command.nav_sources.empty() && command.format != Format::kTum) {
      return usage_error("--nav-source: has an effect only on poses (.tum)");
    }
    if (command.echoes && command.format != Format::kCsv) return usage_error("--echoes: are written as .csv only");
    if (const auto valid = command.filter.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = command.echo.validate(); !valid) return tl::unexpected(valid.error());
    const bool is_grid = command.format == Format::kGrid, is_heights = command.format == Format::kAsc;
    if (surface && !is_heights) return usage_error("--height: has no effect on this output, only on heights (.asc)");
    command.surface = surface.value_or(command.surface);
    if (layer_m && (command.slice.min_z_m || command.slice.max_z_m))
      return usage_error("--z: excludes --min-z and --max-z");
    if (layer_m) command.slice = {layer_m, layer_m};
    if (const auto valid = command.occupancy.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = command.slice.validate(); !valid) return tl::unexpected(valid.error());
    if (command.resolution_m) {
      if (const auto lattice = Lattice::make(*command.resolution_m); !lattice) return tl::unexpected(lattice.error());
    }
    if (is_grid && command.output == "-") return usage_error("-o -: a grid is two files: give the name of one");
    CommandFiles files;
    files.read("IN", command.input);
    files.read("--fields", command.bag.file);
    files.write("-o", command.output);
    if (is_grid) {
      for (const std::string& file : {grid_files(command.output).picture, grid_files(command.output).about}) {
        if (file != command.output) files.write("the other file of the grid,", file);
      }
    }
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    if (const auto folder = check_folder_of(command.output); !folder) return tl::unexpected(folder.error());
    return command;
  });
}

}  // namespace pingvox::app
