#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "evaluation_text.hpp"
#include "input_kinds.hpp"
#include "map_report.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "open_recording.hpp"
#include "pingvox/analysis/slice.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "pingvox/viewer/side_by_side.hpp"
#include "recording_report.hpp"
#include "recording_warnings.hpp"
#include "sweep_pictures.hpp"

namespace pingvox::app {
namespace {

/// A panel's log and its navigation.
RecordingArgs recording_of(const PanelCommand& panel, const RenderCommand& command) {
  RecordingArgs args = panel.recording;
  args.damage = command.damage;
  args.bag = command.bag;
  return args;
}

/// By the options, or by the water that the navigation logs tell of.
Result<double> sound_speed_ratio_of(const PanelCommand& panel, const RenderCommand& command) {
  if (!panel.recording.nav_salinity) return panel.build.sound_speed_ratio;
  RecordingArgs args = recording_of(panel, command);
  args.path.nav_offset_s = 0.0;  // the water is the same at any time
  return open_recording({panel.input}, args).map([](const Recording& recording) {
    return sound_speed_ratio(*recording.water());
  });
}

template <class Gatherer>
Result<Drawn> draw_sweeps(FileBytes file, const PanelCommand& panel, const RenderCommand& command) {
  const std::string name = file.name;
  if (const auto ranges = check_ranges(panel.build); !ranges) return tl::unexpected(ranges.error());
  Result<Log> log = open_input(std::move(file), panel.input, command.damage, command.bag.beams);
  if (!log) return tl::unexpected(log.error());
  Result<std::unique_ptr<BeamSource>> source = only_beams(*std::move(log), name);
  if (!source) return fail(source.error().code, source.error().message + ": --view above draws their map");
  const Result<double> ratio = sound_speed_ratio_of(panel, command);
  if (!ratio) return tl::unexpected(ratio.error());
  PanelCommand of_head = panel;
  of_head.build.model = panel.recording.head.apply_to(panel.build.model, (*source)->device());
  if (panel.recording.background_m && panel.image == ShownImage::kBackground) {
    const Result<Background> background =
        Recording::open({panel.input}, {.damage = command.damage, .topic = command.bag.beams})
            .and_then(
                [&](const Recording& recording) { return learn_background(recording, *panel.recording.background_m); });
    if (!background) return tl::unexpected(background.error());
    source = std::make_unique<BeamsInMemory>(background->beams());
    of_head.marks = EchoMarks::kOff;
  } else {
    source = subtract_own_background(*std::move(source), panel.input, panel.recording.background_m, command.damage,
                                     command.bag.beams);
    if (!source) return tl::unexpected(source.error());
  }
  Gatherer gatherer(of_head);
  SweepAssembler assembler;
  std::size_t sweeps = 0;
  const auto take = [&](std::optional<Sweep> sweep) {
    if (sweep) gatherer.add(++sweeps, std::move(*sweep));
  };
  for (;;) {
    Result<std::optional<Beam>> beam = (*source)->next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) break;
    (*beam)->bin_length_m *= *ratio;
    take(assembler.add(std::move(**beam)));
  }
  take(assembler.finish());
  std::optional<Drawn> drawn = gatherer.draw((*source)->skipped());
  if (drawn) return std::move(*drawn);
  if (sweeps == 0) {
    return fail(Error::Code::kCorrupt,
                fmt::format("{}: no beams (skipped {})", name, counted((*source)->skipped(), "damaged record")));
  }
  return fail(Error::Code::kBadOption,
              fmt::format("render: {}: there is no sweep {}, only {}", name, panel.sweep.value_or(0), sweeps));
}

/// A map to draw, and what is known of its frame.
struct MapToDraw {
  OccupancyMap map;
  MapAxes axes = MapAxes::kUnknown;
  std::optional<MapPath> path = std::nullopt;  ///< of the vehicle that made it
  PictureView view = PictureView::kAbove;
  std::optional<Evaluation> evaluation = std::nullopt;  ///< where it is shown how echoes agree with the map
};

Result<MapToDraw> map_of_log(FileBytes file, const PanelCommand& panel, const RenderCommand& command,
                             Console& console) {
  Result<OpenedRecording> opened =
      open_with_path({input_file(std::move(file), panel.input)}, recording_of(panel, command));
  if (!opened) return tl::unexpected(opened.error());
  auto& [recording, path] = *opened;
  for (const std::string& warning : warnings_of(recording, path)) console.say(warning);
  if (const std::string text = still_vehicle_text(InputFile(panel.input), recording.options()); !text.empty()) {
    console.say(text);
  }
  Result<RecordingMap> mapped = build_map(recording, std::move(path), panel.map, panel.build);
  if (!mapped) return tl::unexpected(mapped.error());
  for (const MappedLog& log : mapped->logs) {
    for (const std::string& warning : warnings_of(recording, mapped->path, log, mapped->map.lattice())) {
      console.say(warning);
    }
  }
  MapToDraw made{std::move(mapped->map), mapped->path.axes};
  if (mapped->path.trajectory.poses().size() > 1) made.path = MapPath{"the vehicle", mapped->path.trajectory};
  if (panel.image == ShownImage::kAgreement) {
    // Cells of the map that is drawn: of the same size.
    EvaluateOptions options_of_map{.map = panel.map, .build = panel.build, .cells = CountCells::kYes};
    options_of_map.map.resolution_m = made.map.lattice().resolution_m();
    Result<Evaluation> found = evaluate(recording, mapped->path, options_of_map);
    if (!found) return tl::unexpected(found.error());
    made.evaluation = *std::move(found);
  }
  return made;
}

Drawn draw_map(const MapToDraw& shown, const MapPictureOptions& options) {
  const std::string what = shown.view == PictureView::kSlice  ? "a layer of the map"
                           : shown.view == PictureView::kSide ? "the map from the side"
                                                              : "the map from above";
  return {render_map(shown.map, options),
          shown.evaluation ? fmt::format("{} (it {})", what, verdict_text(*shown.evaluation)) : what};
}

PictureView view_of(const PanelCommand& panel, FormatKind kind) {
  const bool is_of_sweeps = kind == FormatKind::kBeams && panel.image != ShownImage::kAgreement;
  return panel.view.value_or(is_of_sweeps ? PictureView::kPolar : PictureView::kAbove);
}

/// Adds the kinds that options of a panel may be limited to (PanelCommand).
void add_kinds(const PanelCommand& panel, FormatKind kind, std::vector<std::string>& kinds) {
  const PictureView view = view_of(panel, kind);
  const auto add = [&](bool applies, std::string text) {
    if (applies && std::find(kinds.begin(), kinds.end(), text) == kinds.end()) kinds.push_back(std::move(text));
  };
  const bool is_map = view != PictureView::kPolar && view != PictureView::kCartesian;
  add(true, view_kind(view));
  add(kind == FormatKind::kBeams, std::string(kBeamLogs));
  add(is_map, std::string(kDrawnMaps));
  add(is_map && kind != FormatKind::kMap, std::string(kMappedLogs));
}

/// Prepares a panel: draws a picture, or returns a map to be drawn with those that it is compared with.
Result<std::variant<Drawn, MapToDraw>> prepare_panel(FileBytes file, const PanelCommand& panel,
                                                     const RenderCommand& command, Console& console) {
  using Prepared = std::variant<Drawn, MapToDraw>;
  const Result<Format> format = identify_format(file);
  if (!format) return tl::unexpected(format.error());
  const FormatKind kind = kind_of(*format);
  if (kind != FormatKind::kBeams && kind != FormatKind::kScans && kind != FormatKind::kMap) {
    const std::string_view hint = kind == FormatKind::kCloud        ? ": 'pingvox map' makes a map of it"
                                  : kind == FormatKind::kMesh       ? ": 'pingvox convert' makes a map of its surface"
                                  : kind == FormatKind::kTrajectory ? ": --path draws a trajectory over a map"
                                                                    : "";
    return fail(Error::Code::kUnsupported, fmt::format("{}: is {}, and only logs and maps can be drawn{}", file.name,
                                                       description_of(*format), hint));
  }
  const PictureView view = view_of(panel, kind);
  const auto to_draw = [&](MapToDraw shown) -> Result<Prepared> {
    Result<OccupancyMap> looked_at = panel.occupancy.apply_to(std::move(shown.map));
    if (!looked_at) return fail(looked_at.error().code, fmt::format("render: {}", looked_at.error().message));
    // Leaves that reach beyond the limits end there. Where nothing is known the picture says so.
    const SliceOptions limits{panel.map_picture.min_z_m, panel.map_picture.max_z_m};
    if (limits.min_z_m || limits.max_z_m) {
      Result<OccupancyMap> within = map_of_slice(*looked_at, limits);
      if (within) looked_at = std::move(within);
    }
    return Prepared(MapToDraw{*std::move(looked_at), panel.axes.value_or(shown.axes), std::move(shown.path), view,
                              std::move(shown.evaluation)});
  };
  if (view == PictureView::kPolar || view == PictureView::kCartesian) {
    if (kind != FormatKind::kBeams) {
      return fail(Error::Code::kBadOption,
                  fmt::format("render: {}: is {}: only logs of beams have polar and Cartesian pictures", file.name,
                              description_of(*format)));
    }
    auto drawn = view == PictureView::kPolar ? draw_sweeps<PolarCollector>(std::move(file), panel, command)
                                             : draw_sweeps<CartesianCollector>(std::move(file), panel, command);
    return std::move(drawn).map([](Drawn done) { return Prepared(std::move(done)); });
  }
  if (kind == FormatKind::kMap) {
    if (const auto used = panel.occupancy.check(*format); !used) {
      return fail(used.error().code, fmt::format("render: {}: {}", file.name, used.error().message));
    }
    return read_map(file).and_then([&](MapFile read) { return to_draw({std::move(read.map), read.axes}); });
  }
  return map_of_log(std::move(file), panel, command, console).and_then(to_draw);
}

/// The poses of a file: a trajectory, or a navigation log on its own clock.
Result<Trajectory> path_in(const std::string& file, const RenderCommand& command) {
  Result<ByteStream> stream = ByteStream::open(file);
  if (!stream) return tl::unexpected(stream.error());
  const Result<Format> format = identify_format(*stream);
  const bool is_nav = format && (kind_of(*format) == FormatKind::kNav || is_bag(*format));
  if (!is_nav) return read_trajectory(file);
  return read_nav_log(*std::move(stream), command.damage, command.bag.nav)
      .and_then([&](const BagContents& contents) { return positions_of(contents, file, {}); })
      .map([](const VehiclePath& path) { return path.trajectory; });
}

Result<std::vector<MapPath>> read_paths(const PanelCommand& panel, const MapToDraw& shown,
                                        const RenderCommand& command) {
  std::vector<MapPath> paths;
  for (const std::string& file : panel.drawn_paths) {
    Result<Trajectory> path = path_in(file, command);
    if (!path) return tl::unexpected(path.error());
    paths.push_back({std::filesystem::path(file).filename().string(), *std::move(path)});
  }
  if (paths.empty() && shown.path) paths.push_back(*shown.path);
  return paths;
}

/// Refuses a slice without known cells, since an empty picture would not tell why.
Result<void> check_layer(const MapToDraw& shown, const PanelCommand& panel) {
  const auto z_m = panel.map_picture.layer_z_m;
  if (shown.view != PictureView::kSlice || !z_m) return {};
  if (const auto layer = check_slice(shown.map, {z_m, z_m}); !layer) {
    return fail(layer.error().code, fmt::format("{}: {}", name_of_input(panel.input), layer.error().message));
  }
  return {};
}

Box around(const std::optional<Box>& a, const Box& b) {
  if (!a) return b;
  return {a->min.cwiseMin(b.min), a->max.cwiseMax(b.max)};
}

/// Draws all panels, side by side if there are several. A file is read once; maps of one file and viewpoint show the
/// same box, for comparison.
Result<Drawn> draw(const RenderCommand& command, Console& console) {
  std::map<std::string, FileBytes> files;
  std::map<std::pair<std::string, MapView>, std::optional<Box>> parts;
  std::vector<std::variant<Drawn, MapToDraw>> works;
  std::vector<std::string> kinds;
  for (const PanelCommand& panel : command.panels) {
    auto found = files.find(panel.input);
    if (found == files.end()) {
      Result<FileBytes> file = read_input(panel.input);
      if (!file) return tl::unexpected(file.error());
      found = files.emplace(panel.input, std::move(*file)).first;
    }
    const Result<Format> format = identify_format(found->second);
    if (!format) return tl::unexpected(format.error());
    add_kinds(panel, kind_of(*format), kinds);
  }
  if (const auto used = check_limited(command.limited, kinds); !used) {
    return fail(used.error().code, "render: " + used.error().message);
  }
  std::vector<MapPictureOptions> pictures;
  for (const PanelCommand& panel : command.panels) {
    auto work = prepare_panel(files.at(panel.input), panel, command, console);
    if (!work) return tl::unexpected(work.error());
    MapPictureOptions& picture = pictures.emplace_back(panel.map_picture);
    if (const auto* shown = std::get_if<MapToDraw>(&*work)) {
      if (const auto layer = check_layer(*shown, panel); !layer) return tl::unexpected(layer.error());
      Result<std::vector<MapPath>> paths = read_paths(panel, *shown, command);
      if (!paths) return tl::unexpected(paths.error());
      picture.paths = *std::move(paths);
      picture.axes = shown->axes;
      if (shown->evaluation) picture.agreement = shown->evaluation->cells;
      auto& part = parts[{panel.input, picture.view}];
      if (const auto box = shown_part(shown->map, picture)) part = around(part, *box);
    }
    works.push_back(std::move(*work));
  }

  std::vector<Panel> panels;
  std::string what;
  for (std::size_t i = 0; i < works.size(); ++i) {
    if (const auto* shown = std::get_if<MapToDraw>(&works[i])) {
      MapPictureOptions& options = pictures[i];
      options.at_least = parts[{command.panels[i].input, options.view}];
      works[i] = draw_map(*shown, options);
    }
    Drawn& drawn = std::get<Drawn>(works[i]);
    what = drawn.what;
    panels.push_back({std::move(drawn.picture), command.panels[i].caption});
  }
  if (panels.size() > 1) what = fmt::format("{} pictures", panels.size());
  if (panels.size() == 1 && panels[0].caption.empty() && command.title.empty()) {
    return Drawn{std::move(panels[0].picture), what};
  }
  Result<Picture> all = side_by_side(panels, command.title);
  if (!all) return fail(all.error().code, "render: " + all.error().message);
  return Drawn{std::move(*all), what};
}

}  // namespace

Result<int> run(const RenderCommand& command, Console& console) {
  const Result<Drawn> drawn = draw(command, console);
  if (!drawn) return tl::unexpected(drawn.error());

  const Picture& picture = drawn->picture;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) { return write_png(picture, out); });
  if (!written) return tl::unexpected(written.error());
  const std::string summary = fmt::format("{}: {}, {} x {} pixels\n", on_one_line(command.output), drawn->what,
                                          picture.width(), picture.height());
  if (const auto printed = console.summarise(summary, command.output); !printed) return tl::unexpected(printed.error());
  return 0;
}

}  // namespace pingvox::app
