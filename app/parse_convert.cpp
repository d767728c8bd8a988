#include <fmt/format.h>

#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "command_files.hpp"
#include "echo_options.hpp"
#include "input_kinds.hpp"
#include "mapping_options.hpp"
#include "nav_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "origin_fix.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"

namespace pingvox::app {
namespace {

Option mount_of_beams(Pose& target) {
  Option option = mount_option(target);
  option.only_with = {{"--beams"}};
  return option;
}

constexpr std::array kLogAndMapFormats = {
    Choice<Format>{"csv", Format::kCsv},   Choice<Format>{"bt", Format::kBt},
    Choice<Format>{"ot", Format::kOt},     Choice<Format>{"pvx", Format::kPvx},
    Choice<Format>{"ply", Format::kPly},   Choice<Format>{"pcd", Format::kPcd},
    Choice<Format>{"xyz", Format::kXyz},   Choice<Format>{"pgm", Format::kGrid},
    Choice<Format>{"yaml", Format::kGrid}, Choice<Format>{"asc", Format::kAsc},
    Choice<Format>{"tum", Format::kTum},   Choice<Format>{"las", Format::kLas},
    Choice<Format>{"glb", Format::kGlb},   Choice<Format>{"tif", Format::kTif},
    Choice<Format>{"tiff", Format::kTif},  Choice<Format>{"geojson", Format::kGeoJson},
    Choice<Format>{"mcap", Format::kMcap}};
constexpr std::array kEchoesOfBeam = {Choice<EchoesOfBeam>{"first", EchoesOfBeam::kFirst},
                                      Choice<EchoesOfBeam>{"all", EchoesOfBeam::kAll}};
constexpr std::array kSurfaces = {Choice<Surface>{"highest", Surface::kHighest},
                                  Choice<Surface>{"lowest", Surface::kLowest}};
constexpr std::array kRasterValues = {Choice<RasterValues>{"heights", RasterValues::kHeights},
                                      Choice<RasterValues>{"occupancy", RasterValues::kOccupancy}};
constexpr std::array kMeshColours = {Choice<MeshColours>{"height", MeshColours::kHeight},
                                     Choice<MeshColours>{"probability", MeshColours::kProbability}};
constexpr std::array kMcapMessages = {Choice<McapMessages>{"foxglove", McapMessages::kFoxglove},
                                      Choice<McapMessages>{"ros2", McapMessages::kRos2}};

}  // namespace

Result<Command> convert_command(const Args& args) {
  ConvertCommand command;
  std::optional<Format> asked_format;
  std::optional<double> layer_m;
  std::optional<Surface> surface;
  std::optional<RasterValues> raster;
  std::optional<MeshColours> colours;
  std::optional<McapMessages> messages;
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
      "point scans as a cloud; a map as another map, as points, as a mesh, as a grid for ROS's map_server, or as a\n"
      "raster of heights or occupancy for a GIS; a mesh as the map of its surface; a path on the earth.",
      {{"IN", Positional::Count::kOne,
        "a log of beams, of navigation or of point scans (.graph, .log, .xtf), a trajectory (TUM), a map or a mesh "
        "(OFF, "
        "PLY, STL); - is standard input",
        store(command.input)}},
      {{"Options",
        {output_option(command.output,
                       "the output: .csv from a log; .tum (poses) from a navigation log, .geojson from that or a "
                       "trajectory; .ply .pcd .xyz from point scans; from a map or a mesh .bt .ot .pvx, .ply .pcd .xyz "
                       ".las (occupied cells as points), .glb (their surface), .mcap (for Foxglove or ROS 2), .yaml "
                       "with its .pgm (map_server), .tif "
                       ".asc (GeoTIFF, ESRI grid); - is standard output"),
         choice("--format", kLogAndMapFormats, "format of the output where its name has none of these suffixes",
                asked_format, "by suffix, csv on standard output"),
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
                "height of a column in .tif and .asc: upper face of its highest or its lowest occupied cell", surface,
                choice_name(kSurfaces, command.surface)),
         choice("--values", kRasterValues,
                "what .tif and .asc hold: heights, or occupancy of columns: 1 occupied, 0 free, else no data", raster,
                choice_name(kRasterValues, command.raster)),
         choice("--colours", kMeshColours, "what the colours of .glb show", colours,
                choice_name(kMeshColours, command.colours))}},
       {"Recordings of a map (.mcap)",
        {choice("--messages", kMcapMessages, "whose messages: of Foxglove as Protobuf, or of ROS 2 as CDR", messages,
                choice_name(kMcapMessages, command.messages)),
         {"--path", 0, "FILE", "trajectory (TUM) that is written with its transforms", "none",
          store(command.drawn_path)},
         {"--beams", 0, "LOG", "log of beams, each of which is written as points at its time", "none",
          store(command.beams)},
         mount_of_beams(command.body_from_sonar)}},
       {"On the earth",
        {{"--origin", 0, "LAT,LON",
          "where 0, 0 is, x east and y north: degrees of WGS 84; for .tif, .asc (writes a .prj beside it), .las, "
          ".geojson",
          "none, or the first fix of a navigation log that is converted", store_origin(command.origin.fix)},
         nav_option(command.origin.navs, "navigation log that the map was made with, which has the place of 0, 0")}}},
      {"pingvox convert tank.mat -o tank.csv", "pingvox convert tank.mat --echoes -o echoes.csv",
       "pingvox convert dive.tlog -o dive.tum", "pingvox convert line.xtf -o line.ply",
       "pingvox convert tank.bt -o tank.ply", "pingvox convert tank.bt -o layer.ply --z 0",
       "pingvox convert harbour.bt -o harbour.yaml --min-z -0.5 --max-z 0.5",
       "pingvox convert seabed.ot -o seabed.tif --origin 54.3,10.15",
       "pingvox convert wreck.bt -o wreck.glb --colours probability", "pingvox convert dive.tlog -o dive.geojson",
       "pingvox convert harbour.bt -o harbour.mcap --path dive.tum --beams dive.bin",
       "pingvox convert hull.stl -o hull.bt --resolution 0.1"},
      "A column of a grid is occupied if any of its cells is, free if one is free and none is occupied, else unknown."};
  std::vector<Option>& map_options = table.groups[3].options;
  for (Option& option : occupancy_options(command.occupancy)) map_options.push_back(std::move(option));
  for (Option& option : table.groups[2].options) option.only_for = {std::string(kMeshes)};
  for (Option& option : map_options) option.only_for = maps;
  for (Option& option : table.groups[4].options) option.only_for = maps;
  table.groups[5].options[1].only_for = maps;
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
    const bool is_path = command.format == Format::kTum || command.format == Format::kGeoJson;
    if (!command.nav_sources.empty() && !is_path && command.origin.navs.empty()) {
      return usage_error("--nav-source: has an effect only on poses (.tum, .geojson) and with --nav");
    }
    if (command.echoes && command.format != Format::kCsv) return usage_error("--echoes: are written as .csv only");
    if (const auto valid = command.filter.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = command.echo.validate(); !valid) return tl::unexpected(valid.error());
    const bool is_grid = command.format == Format::kGrid, is_mesh = command.format == Format::kGlb;
    const bool is_raster = command.format == Format::kAsc || command.format == Format::kTif;
    if (raster && !is_raster) return usage_error("--values: has no effect on this output, only on .tif and .asc");
    command.raster = raster.value_or(command.raster);
    if (surface && (!is_raster || command.raster != RasterValues::kHeights)) {
      return usage_error("--height: has no effect on this output, only on heights (.tif, .asc)");
    }
    command.surface = surface.value_or(command.surface);
    if (colours && !is_mesh) return usage_error("--colours: has no effect on this output, only on .glb");
    command.colours = colours.value_or(command.colours);
    const bool is_recording = command.format == Format::kMcap;
    if ((messages || !command.drawn_path.empty() || !command.beams.empty()) && !is_recording) {
      return usage_error(fmt::format("{}: has no effect on this output, only on .mcap", messages ? "--messages"
                                                                                        : !command.drawn_path.empty()
                                                                                            ? "--path"
                                                                                            : "--beams"));
    }
    command.messages = messages.value_or(command.messages);
    const bool is_placed = is_raster || command.format == Format::kLas;
    if (command.origin.fix && !is_placed && command.format != Format::kGeoJson) {
      return usage_error("--origin: has no effect on this output, only on .tif, .asc, .las and .geojson");
    }
    if (!command.origin.navs.empty() && !is_placed) {
      return usage_error("--nav: has no effect on this output, only on .tif, .asc and .las");
    }
    if (command.origin.fix && !command.origin.navs.empty())
      return usage_error("--origin and --nav: exclude each other");
    const bool has_prj = command.format == Format::kAsc && !command.origin.empty();
    if (has_prj && command.output == "-") return usage_error("-o -: a placed .asc is two files: give a name");
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
    files.read("--nav", command.origin.navs);
    files.read("--path", command.drawn_path);
    files.read("--beams", command.beams);
    files.write("-o", command.output);
    if (has_prj) files.write("the .prj beside the output,", prj_file(command.output));
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
