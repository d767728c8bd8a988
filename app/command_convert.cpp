#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string_view>
#include <utility>

#include "command_files.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "input_kinds.hpp"
#include "map_report.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "origin_fix.hpp"
#include "pingvox/analysis/slice.hpp"
#include "pingvox/analysis/surface_map.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/geojson.hpp"
#include "pingvox/io/glb.hpp"
#include "pingvox/io/grids.hpp"
#include "pingvox/io/las.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/mcap_map.hpp"
#include "pingvox/io/mesh.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/io/points.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/recording/map_origin.hpp"
#include "pingvox/recording/vehicle_path.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/device_profile.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "recording_report.hpp"
#include "step_report.hpp"

namespace pingvox::app {
namespace {

bool is_made_of_maps(Format format) {
  if (format == Format::kMcap) return true;
  const FormatKind kind = kind_of(format);
  return kind == FormatKind::kMap || kind == FormatKind::kCloud || kind == FormatKind::kGrid ||
         kind == FormatKind::kMesh;
}

tl::unexpected<Error> conversion_error(const std::string& name, Format from, Format to) {
  const bool to_map = is_made_of_maps(to);
  const FormatKind kind = kind_of(from);
  const bool is_log = kind == FormatKind::kBeams || kind == FormatKind::kScans || kind == FormatKind::kCloud;
  const std::string_view hint = to_map && is_log             ? ": use 'pingvox map'"
                                : kind == FormatKind::kScans ? ": .ply, .pcd and .xyz hold its points"
                                                             : "";
  return fail(Error::Code::kBadOption, fmt::format("convert: {}: is {}, which cannot be written as .{}{}", name,
                                                   description_of(from), name_of(to), hint));
}

Result<std::string> write_beams(BeamSource& source, std::ostream& out) {
  return write_csv(source, out).map([](std::size_t beams) { return fmt::format("{} beams", beams); });
}

/// A table with a line for each echo (docs/formats.md).
Result<std::string> write_echoes(BeamSource& source, const ConvertCommand& command, std::ostream& out) {
  out << "time_s,bearing_rad,range_m,intensity,first_bin,peak_bin,last_bin,threshold\n";
  std::size_t beams = 0, echoes = 0;
  const auto write_echo = [&](const Beam& beam, const Echo& echo) {
    ++echoes;
    out << fmt::format("{},{},{},{},{},{},{},{}\n", beam.time_s, beam.bearing_rad, echo.range_m, echo.intensity,
                       echo.first, echo.peak, echo.last, echo.threshold);
  };
  const auto write_sweep = [&](const std::optional<Sweep>& sweep) {
    if (!sweep) return;
    const PolarImage image = apply_filter(PolarImage(*sweep), command.filter);
    const std::vector<std::vector<Echo>> all = detect_all_echoes(image, *sweep, command.echo);
    for (std::size_t n = 0; n < all.size(); ++n) {
      const std::size_t count =
          command.echoes == EchoesOfBeam::kAll ? all[n].size() : std::min<std::size_t>(1, all[n].size());
      for (const Echo& echo : std::span(all[n]).first(count)) write_echo(sweep->beams[n], echo);
    }
  };
  SweepAssembler assembler;
  for (;;) {
    Result<std::optional<Beam>> beam = source.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) break;
    ++beams;
    (*beam)->bin_length_m *= command.sound_speed_ratio;
    write_sweep(assembler.add(**std::move(beam)));
    if (!out) break;
  }
  write_sweep(assembler.finish());
  if (!out.flush()) return fail(Error::Code::kIo, "the echoes could not be written");
  return fmt::format("{} of {}", counted(echoes, "echo"), counted(beams, "beam"));
}

/// Writes the beams of a log, or their echoes. @return what was written
Result<std::string> convert_log(ByteStream stream, const ConvertCommand& command) {
  const BeamTopic& topic = command.bag.beams;
  const Result<std::unique_ptr<BeamSource>> source =
      open_beams(std::move(stream), command.damage, topic).and_then([&](std::unique_ptr<BeamSource> beams) {
        return subtract_own_background(std::move(beams), command.input, command.background_m, command.damage, topic);
      });
  if (!source) return tl::unexpected(source.error());
  std::string what;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) -> Result<void> {
    Result<std::string> done = command.echoes ? write_echoes(**source, command, out) : write_beams(**source, out);
    if (!done) return tl::unexpected(done.error());
    what = *std::move(done);
    return {};
  });
  if (!written) return tl::unexpected(written.error());
  const std::size_t skipped = (*source)->skipped();
  if (skipped > 0) what += "; skipped " + damage_text(skipped, (*source)->first_damage());
  const DeviceProfile* device = command.echoes ? nullptr : (*source)->device();
  if (device != nullptr) what += fmt::format(" (CSV names no sonar: map it with --device {})", device->name);
  return what;
}

/// Writes the points of scans. @return what was written
Result<std::string> convert_scans(ByteStream stream, const ConvertCommand& command) {
  Result<std::unique_ptr<ScanSource>> scans = ByteStream::whole(std::move(stream)).and_then([&](FileBytes file) {
    return open_scans(std::move(file), command.damage);
  });
  if (!scans) return tl::unexpected(scans.error());
  std::size_t points = 0;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) -> Result<void> {
    const Result<std::size_t> count = write_points(**scans, command.format, out);
    if (!count) return tl::unexpected(count.error());
    points = *count;
    if (points > 0 || (*scans)->skipped() == 0) return {};
    return fail(Error::Code::kCorrupt, fmt::format("{}: no scan could be read: {}", name_of_input(command.input),
                                                   damage_text((*scans)->skipped(), (*scans)->first_damage())));
  });
  if (!written) return tl::unexpected(written.error());
  std::string what = fmt::format("{} points", points);
  if (const std::size_t skipped = (*scans)->skipped(); skipped > 0) {
    what += "; skipped " + damage_text(skipped, (*scans)->first_damage());
  }
  return what;
}

Result<std::string> convert_nav(ByteStream stream, const ConvertCommand& command, Console& console) {
  const Result<BagContents> contents = read_nav_log(std::move(stream), command.damage, command.bag.nav);
  if (!contents) return tl::unexpected(contents.error());
  const NavFile& nav = contents->nav;
  if (nav.log.sources().empty()) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: has no samples of navigation in {}, {} damaged", name_of_input(command.input),
                            counted(nav.records, "record"), damaged_records(nav)));
  }
  for (const std::string& step : step_texts(nav.log)) {
    console.say(fmt::format("{}: {}: not valid in {}", name_of_input(command.input), step, command.output));
  }
  std::size_t samples = 0;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) -> Result<void> {
    const Result<std::size_t> count = write_nav_csv(nav.log, out);
    if (!count) return tl::unexpected(count.error());
    samples = *count;
    return {};
  });
  if (!written) return tl::unexpected(written.error());
  std::string what = fmt::format("{} samples of {} sources", samples, nav.log.sources().size());
  if (const std::size_t skipped = damaged_records(nav); skipped > 0) {
    what += fmt::format("; {} skipped", counted(skipped, "damaged record"));
  }
  // Samples are written in order of time, where nothing tells it any more.
  if (const auto checked = check_sources(nav.log); !checked) what += "; " + on_one_line(checked.error().message);
  return what;
}

/// A path as GeoJSON.
/// @param of_nav  by the navigation that it is made of
Result<void> write_path_on_earth(const Trajectory& path, GeoJsonOptions options, const std::optional<MapOrigin>& of_nav,
                                 const ConvertCommand& command) {
  const std::optional<Eigen::Vector3d> origin =
      command.origin.fix || !of_nav ? command.origin.fix : std::optional(of_nav->fix);
  if (!origin) {
    return fail(Error::Code::kBadOption,
                fmt::format("{}: has no fixes: --origin LAT,LON says where 0, 0 is", name_of_input(command.input)));
  }
  options.origin_fix = *origin;
  options.name = std::filesystem::path(command.input).filename().string();
  return write_file(command.output, [&](std::ostream& out) -> Result<void> {
    const Result<std::size_t> points = write_geojson(path, options, out);
    if (!points) return tl::unexpected(points.error());
    return {};
  });
}

/// The same of a trajectory in a file.
Result<std::string> convert_trajectory(ByteStream stream, const ConvertCommand& command) {
  const Result<Trajectory> path =
      ByteStream::whole(std::move(stream)).and_then([](const FileBytes& file) { return read_tum(file); });
  if (!path) return tl::unexpected(path.error());
  if (const auto written = write_path_on_earth(*path, {}, std::nullopt, command); !written) {
    return tl::unexpected(written.error());
  }
  return fmt::format("{} poses", path->poses().size());
}

/// Writes the poses of a navigation log. @return what was written
Result<std::string> convert_nav_to_poses(ByteStream stream, const ConvertCommand& command, Console& console) {
  const std::string name = stream.name();
  const Result<BagContents> contents = read_nav_log(std::move(stream), command.damage, command.bag.nav);
  if (!contents) return tl::unexpected(contents.error());
  const NavLog& log = contents->nav.log;
  const Result<VehiclePath> path = positions_of(*contents, name, command.nav_sources);
  if (!path) {
    Error error = path.error();
    if (log.best(NavQuantity::kVelocity) != nullptr) {
      error.message += "; 'pingvox slam --matching none' computes them from velocity and heading";
    }
    return tl::unexpected(std::move(error));
  }
  for (const std::string& step : step_texts(log)) console.say(fmt::format("{}: {}", name, step));
  GeoJsonOptions options;
  options.clock = log.clock();
  options.has_attitude = !path->nav->attitude.empty();
  const auto is_position = [&](const NavSource& source) {
    return source.name == path->nav->position &&
           (source.quantity == NavQuantity::kPosition || source.quantity == NavQuantity::kFix);
  };
  const auto positions = std::ranges::find_if(log.sources(), is_position);
  if (positions != log.sources().end()) options.positions = &*positions;
  const std::optional<MapOrigin> origin = map_origin(*path, log, 0.0);
  const Result<void> written =
      command.format == Format::kGeoJson
          ? write_path_on_earth(path->trajectory, options, origin, command)
          : write_file(command.output, [&](std::ostream& out) { return write_tum(path->trajectory, out); });
  if (!written) return tl::unexpected(written.error());
  const std::string others = pingvox::text_of(path->nav->others);
  return nav_text(*path, damaged_records(contents->nav)) + (others.empty() ? "" : "; others: " + others);
}

Error with_name(Error error, const std::string& name) {
  error.message = fmt::format("{}: {}", name_of_input(name), error.message);
  return error;
}

/// The map of a mesh's surface.
Result<MapFile> map_of_mesh(const FileBytes& file, const ConvertCommand& command) {
  const Result<TriangleMesh> mesh = read_mesh(file);
  if (!mesh) return tl::unexpected(mesh.error());
  MapOptions options;
  options.resolution_m = command.resolution_m;
  Result<OccupancyMap> map = surface_map(*mesh, options);
  if (!map) return tl::unexpected(with_name(map.error(), file.name));
  return MapFile{command.format, *std::move(map), fmt::format("the surface of {}", file.name)};
}

/// Writes a grid for map_server: the image, then its YAML file.
Result<std::string> write_grid(const OccupancyMap& map, const ConvertCommand& command) {
  const Result<Raster<Occupancy>> slice = slice_of(map, command.slice);
  if (!slice) return tl::unexpected(with_name(slice.error(), command.input));
  const auto [picture, about] = grid_files(command.output);
  const std::string name = std::filesystem::path(picture).filename().string();
  auto written = write_file(picture, [&](std::ostream& out) { return write_grid_pgm(*slice, out); });
  if (written) written = write_file(about, [&](std::ostream& out) { return write_grid_yaml(*slice, name, out); });
  if (!written) return tl::unexpected(written.error());
  return fmt::format("{} x {} cells, and its {}", slice->columns, slice->rows,
                     on_one_line(command.output == about ? picture : about));
}

/// Heights or occupancy of columns.
Result<Raster<float>> raster_of(const OccupancyMap& map, const ConvertCommand& command) {
  if (command.raster == RasterValues::kHeights) return heights_of(map, command.slice, command.surface);
  return slice_of(map, command.slice).map(occupancy_numbers);
}

/// Writes a raster for a GIS.
Result<std::string> write_raster(const MapFile& read, const ConvertCommand& command) {
  const Result<std::optional<Eigen::Vector3d>> origin = origin_fix_of(command, read.axes);
  if (!origin) return tl::unexpected(origin.error());
  const Result<Raster<float>> raster = raster_of(read.map, command);
  if (!raster) return tl::unexpected(with_name(raster.error(), command.input));
  const bool has_heights = command.raster == RasterValues::kHeights;
  const std::string_view what = has_heights ? "height [m]" : "occupancy: 1 occupied, 0 free";
  Result<void> written = write_file(command.output, [&](std::ostream& out) {
    return command.format == Format::kTif ? write_geotiff(*raster, *origin, what, out)
                                          : write_heights_asc(*raster, out);
  });
  const std::string prj = prj_file(command.output);
  if (written && command.format == Format::kAsc && *origin) {
    written = write_file(prj, [&](std::ostream& out) { return write_prj(**origin, out); });
  }
  if (!written) return tl::unexpected(written.error());
  std::string text = fmt::format("{} of {} x {} columns{}", has_heights ? "heights" : "occupancy", raster->columns,
                                 raster->rows, place_text(*origin, read.axes));
  std::error_code ignored;
  if (command.format == Format::kAsc && !*origin && std::filesystem::exists(prj, ignored)) {
    text += fmt::format("; the existing {} still places it on the earth: remove it", prj);
  }
  return text;
}

/// Writes the occupied cells as a mesh.
Result<std::string> write_surface(const OccupancyMap& map, const ConvertCommand& command) {
  std::size_t rectangles = 0;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) -> Result<void> {
    const Result<std::size_t> count = write_glb(map, command.colours, out);
    if (!count) {
      Error error = with_name(count.error(), command.input);
      if (error.code == Error::Code::kLimit) error.message += ": --cut-depth coarsens it, --min-z and --max-z cut it";
      return tl::unexpected(std::move(error));
    }
    rectangles = *count;
    return {};
  });
  if (!written) return tl::unexpected(written.error());
  return fmt::format("{} for {}", counted(rectangles, "rectangle"),
                     counted(map.counts().occupied_cells, "occupied cell"));
}

/// Writes the occupied cells as LAS.
Result<std::string> write_laser_points(const MapFile& read, const ConvertCommand& command) {
  const Result<std::optional<Eigen::Vector3d>> origin = origin_fix_of(command, read.axes);
  if (!origin) return tl::unexpected(origin.error());
  std::size_t points = 0;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) -> Result<void> {
    const Result<std::size_t> count = write_las(read.map, *origin, out);
    if (!count) return tl::unexpected(with_name(count.error(), command.input));
    points = *count;
    return {};
  });
  if (!written) return tl::unexpected(written.error());
  return fmt::format("{} for {}, one for each leaf{}", counted(points, "point"),
                     counted(read.map.counts().occupied_cells, "occupied cell"), place_text(*origin, read.axes));
}

/// Writes the map with a path and beams as a recording.
Result<std::string> write_recording(const OccupancyMap& map, const ConvertCommand& command) {
  McapContents contents;
  if (!command.drawn_path.empty()) {
    Result<Trajectory> path = read_trajectory(command.drawn_path);
    if (!path) return tl::unexpected(path.error());
    contents.path = *std::move(path);
  }
  std::unique_ptr<BeamSource> beams;
  if (!command.beams.empty()) {
    Result<std::unique_ptr<BeamSource>> opened = ByteStream::open(command.beams).and_then([&](ByteStream stream) {
      return open_beams(std::move(stream), command.damage, command.bag.beams);
    });
    if (!opened) return tl::unexpected(opened.error());
    beams = *std::move(opened);
    contents.beams = beams.get();
    contents.body_from_sonar = command.body_from_sonar;
  }
  McapCounts counts;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) -> Result<void> {
    const Result<McapCounts> done = write_mcap(map, contents, command.messages, out);
    if (!done) return tl::unexpected(with_name(done.error(), command.input));
    counts = *done;
    return {};
  });
  if (!written) return tl::unexpected(written.error());
  return fmt::format("{}: {}, {}, {}", counted(counts.messages, "message"),
                     counted(map.counts().occupied_cells, "occupied cell"), counted(counts.poses, "pose"),
                     counted(counts.beams, "beam"));
}

Result<std::string> convert_map(MapFile& read, const ConvertCommand& command) {
  Result<OccupancyMap> looked_at = command.occupancy.apply_to(std::move(read.map));
  if (!looked_at) return tl::unexpected(with_name(looked_at.error(), command.input));
  read.map = *std::move(looked_at);
  if (command.format == Format::kGrid) return write_grid(read.map, command);
  if (command.format == Format::kAsc || command.format == Format::kTif) return write_raster(read, command);
  if (command.slice.min_z_m || command.slice.max_z_m) {
    Result<OccupancyMap> layers = map_of_slice(read.map, command.slice);
    if (!layers) return tl::unexpected(with_name(layers.error(), command.input));
    read.map = *std::move(layers);
  }
  if (command.format == Format::kGlb) return write_surface(read.map, command);
  if (command.format == Format::kLas) return write_laser_points(read, command);
  if (command.format == Format::kMcap) return write_recording(read.map, command);
  const Result<void> written = write_map(read.map, command.format, read.made_by, command.output, read.axes);
  if (!written) return tl::unexpected(written.error());
  const MapCounts counts = read.map.counts();
  if (kind_of(command.format) == FormatKind::kCloud) {
    std::size_t points = 0;
    const Thresholds& thresholds = read.map.options().thresholds;
    for_each_leaf(read.map, [&](const Leaf& leaf) {
      points += classify(leaf.belief, thresholds) == Occupancy::kOccupied ? 1 : 0;
    });
    return fmt::format("{} for {}, one for each leaf", counted(points, "point"),
                       counted(counts.occupied_cells, "occupied cell"));
  }
  return fmt::format("{} occupied and {} free cells", counts.occupied_cells, counts.free_cells);
}

Result<std::string> convert(ByteStream stream, Format format, const ConvertCommand& command, Console& console) {
  const FormatKind from = kind_of(format);
  // A recording is made of a map, though bags are logs.
  const FormatKind to = command.format == Format::kMcap ? FormatKind::kMap : kind_of(command.format);
  std::vector<std::string> kinds = {kind_text(from)};
  if (command.echoes) kinds.emplace_back(kEchoTables);
  if (const auto used = check_limited(command.limited, kinds); !used) {
    return fail(used.error().code, fmt::format("convert: {}: {}", stream.name(), used.error().message));
  }
  if (is_bag(format) && to == FormatKind::kTrajectory) return convert_nav_to_poses(std::move(stream), command, console);
  if (is_bag(format) && to == FormatKind::kBeams) {
    const Result<BagContents> bag = bag_contents(stream, command.damage, command.bag.nav);
    if (!bag) return tl::unexpected(bag.error());
    const bool is_for_beams = has(*bag, BagTopicSummary::Use::kBeams) || !command.bag.beams.name.empty();
    if (!is_for_beams && !bag->nav.log.sources().empty()) return convert_nav(std::move(stream), command, console);
  }
  if (from == FormatKind::kBeams && to == FormatKind::kBeams) return convert_log(std::move(stream), command);
  if (from == FormatKind::kScans && to == FormatKind::kCloud) return convert_scans(std::move(stream), command);
  if (from == FormatKind::kNav && to == FormatKind::kBeams) return convert_nav(std::move(stream), command, console);
  if (from == FormatKind::kNav && to == FormatKind::kTrajectory)
    return convert_nav_to_poses(std::move(stream), command, console);
  if (from == FormatKind::kTrajectory && command.format == Format::kGeoJson) {
    return convert_trajectory(std::move(stream), command);
  }
  const bool is_map = from == FormatKind::kMap, is_mesh = from == FormatKind::kMesh;
  if (!is_made_of_maps(command.format) || (!is_map && !is_mesh))
    return conversion_error(stream.name(), format, command.format);
  if (const auto used = command.occupancy.check(format); !used) {
    return fail(used.error().code, fmt::format("convert: {}: {}", stream.name(), used.error().message));
  }
  const Result<FileBytes> file = ByteStream::whole(std::move(stream));
  if (!file) return tl::unexpected(file.error());
  Result<MapFile> map = is_map ? read_map(*file) : map_of_mesh(*file, command);
  if (!map) return tl::unexpected(map.error());
  return convert_map(*map, command);
}

}  // namespace

Result<int> run(const ConvertCommand& command, Console& console) {
  Result<ByteStream> stream = ByteStream::open(command.input);
  if (!stream) return tl::unexpected(stream.error());
  const Result<Format> format = identify_format(*stream);
  if (!format) return tl::unexpected(format.error());

  const Result<std::string> what = convert(std::move(*stream), *format, command, console);
  if (!what) return tl::unexpected(what.error());
  const auto summary = console.summarise(fmt::format("{}: {}\n", on_one_line(command.output), *what), command.output);
  if (!summary) return tl::unexpected(summary.error());
  return 0;
}

}  // namespace pingvox::app
