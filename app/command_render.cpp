#include <fmt/format.h>

#include <algorithm>
#include <bitset>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <set>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "evaluation_text.hpp"
#include "map_report.hpp"
#include "mapping_options.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "pingvox/analysis/slice.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "pingvox/viewer/side_by_side.hpp"
#include "recording_report.hpp"
#include "threshold_range.hpp"

namespace pingvox::app {
namespace {

/// A picture and its description.
struct Drawn {
  Picture picture;
  std::string what;
};

/// A sweep with its echoes.
struct ProcessedSweep {
  std::size_t number = 0;  ///< counted from 1
  Sweep sweep;
  PolarImage image;                           ///< the image to be shown
  std::vector<std::optional<Echo>> echoes{};  ///< empty when they are not marked
};

/// Keeps the bins of a beam that begin within a range.
void cut_beam(Beam& beam, double range_m) {
  const double bins = std::ceil(range_m / beam.bin_length_m);
  if (bins < static_cast<double>(beam.intensities.size())) {
    beam.intensities.resize(std::max<std::size_t>(static_cast<std::size_t>(bins), 1));
  }
}

ProcessedSweep process_sweep(std::size_t number, Sweep sweep, const PanelCommand& panel) {
  const PolarImage raw(sweep);
  const PolarImage smooth = apply_filter(raw, panel.build.filter);
  std::vector<std::optional<Echo>> echoes;
  if (panel.marks == EchoMarks::kOn) {
    echoes = detect_echoes(smooth, sweep, panel.build.echo);
  }
  for (std::size_t i = 0; i < sweep.beams.size(); ++i) {
    Beam& beam = sweep.beams[i];
    if (panel.image == ShownImage::kFiltered) {
      const auto row = smooth.row(i);
      beam.intensities.assign(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(smooth.bins_in(i)));
    }
    cut_beam(beam, panel.build.echo.max_range_m);
  }
  PolarImage image(sweep);
  return {number, std::move(sweep), std::move(image), std::move(echoes)};
}

std::string count_text(std::size_t beams, std::span<const std::optional<Echo>> echoes, const PanelCommand& panel,
                       std::size_t skipped) {
  std::size_t found = 0;
  for (const auto& echo : echoes) found += echo ? 1 : 0;
  std::string text = fmt::format("{} beams", beams);
  if (panel.marks == EchoMarks::kOn) {
    text += fmt::format(" with {} echoes", found);
    ThresholdRange thresholds;
    thresholds.add(echoes);
    if (found > 0) text += fmt::format(", threshold {}", thresholds.text(panel.build.echo.threshold));
  }
  if (skipped > 0) text += fmt::format("; skipped {}", counted(skipped, "damaged record"));
  return text;
}

double longest_range_m(std::span<const Beam> beams) {
  double longest_m = 0.0;
  for (const Beam& beam : beams) {
    longest_m = std::max(longest_m, static_cast<double>(beam.intensities.size()) * beam.bin_length_m);
  }
  return longest_m;
}

/// Where nearly all echoes fill less than half of the picture: the range that shows them larger. nullopt: all of it,
/// also where the range is asked for.
std::optional<double> zoomed_range_m(std::span<const Beam> beams, std::span<const std::optional<Echo>> echoes,
                                     const PanelCommand& panel) {
  if (std::isfinite(panel.build.echo.max_range_m)) return std::nullopt;
  std::vector<double> ranges_m;
  for (const auto& echo : echoes) {
    if (echo) ranges_m.push_back(echo->range_m);
  }
  if (ranges_m.empty()) return std::nullopt;
  // A single echo far away must not count.
  const auto last = ranges_m.begin() + static_cast<std::ptrdiff_t>((ranges_m.size() - 1) * 99 / 100);
  std::ranges::nth_element(ranges_m, last);
  const double wanted_m = std::ceil(1.2 * *last);
  return 2.0 * wanted_m < longest_range_m(beams) ? std::optional(wanted_m) : std::nullopt;
}

/// "; drawn to 5 m of 50 m, where nearly all echoes are (--max-range 50 draws all)"
std::string zoom_text(double drawn_m, double longest_m) {
  return fmt::format("; drawn to {:g} m of {:.3g} m, where nearly all echoes are (--max-range {:g} draws all)", drawn_m,
                     longest_m, std::ceil(longest_m));
}

/// Shortens beams, and removes the echoes beyond.
void cut_beams(std::vector<Beam>& beams, std::vector<std::optional<Echo>>& echoes, double range_m) {
  for (Beam& beam : beams) cut_beam(beam, range_m);
  for (auto& echo : echoes) {
    if (echo && echo->range_m > range_m) echo.reset();
  }
}

/// Collects the beams of a polar picture.
class PolarCollector {
 public:
  explicit PolarCollector(const PanelCommand& panel) : panel_(panel) {}

  void add(std::size_t number, Sweep sweep) {
    if (panel_.sweep && *panel_.sweep != number) return;
    ProcessedSweep next = process_sweep(number, std::move(sweep), panel_);
    beams_.insert(beams_.end(), next.sweep.beams.begin(), next.sweep.beams.end());
    echoes_.insert(echoes_.end(), next.echoes.begin(), next.echoes.end());
  }

  std::optional<Drawn> draw(std::size_t skipped) {
    if (beams_.empty()) return std::nullopt;
    std::string what = count_text(beams_.size(), echoes_, panel_, skipped);
    if (const auto zoomed_m = zoomed_range_m(beams_, echoes_, panel_)) {
      what += zoom_text(*zoomed_m, longest_range_m(beams_));
      cut_beams(beams_, echoes_, *zoomed_m);
    }
    return Drawn{render_echoes(beams_, echoes_, panel_.echo_picture), what};
  }

 private:
  const PanelCommand& panel_;
  std::vector<Beam> beams_;
  std::vector<std::optional<Echo>> echoes_;
};

/// Selects the sweep of a Cartesian picture: as requested, else the one that shows most: directions times range. A head
/// that begins with some short pings before a dive is not drawn by these.
class CartesianCollector {
 public:
  explicit CartesianCollector(const PanelCommand& panel) : panel_(panel) {}

  void add(std::size_t number, Sweep sweep) {
    if (panel_.sweep && *panel_.sweep != number) return;
    const auto fullness = std::pair(static_cast<double>(directions_in(sweep)) * range_m(sweep), sweep.beams.size());
    if (chosen_ && fullness <= fullness_) return;
    fullness_ = fullness;
    chosen_ = std::pair(number, std::move(sweep));
  }

  std::optional<Drawn> draw(std::size_t skipped) const {
    if (!chosen_) return std::nullopt;
    ProcessedSweep shown = process_sweep(chosen_->first, chosen_->second, panel_);
    std::vector<Beam>& beams = shown.sweep.beams;
    std::string what =
        fmt::format("sweep {}, {}", shown.number, count_text(beams.size(), shown.echoes, panel_, skipped));
    if (const auto zoomed_m = zoomed_range_m(beams, shown.echoes, panel_)) {
      what += zoom_text(*zoomed_m, longest_range_m(beams));
      cut_beams(beams, shown.echoes, *zoomed_m);
      shown.image = PolarImage(shown.sweep);
    }
    const CartesianPictureOptions options{panel_.echo_picture, panel_.between, panel_.build.model.width_rad};
    return Drawn{render_cartesian(shown.sweep, shown.image, shown.echoes, options), what};
  }

 private:
  /// Number of whole degrees in which the sweep has a beam.
  static std::size_t directions_in(const Sweep& sweep) {
    std::bitset<360> seen;
    for (const Beam& beam : sweep.beams) {
      seen.set(static_cast<std::size_t>(beam.bearing_rad / std::numbers::pi * 180.0) % seen.size());
    }
    return seen.count();
  }

  static double range_m(const Sweep& sweep) {
    double range_m = 0.0;
    for (const Beam& beam : sweep.beams) {
      range_m = std::max(range_m, static_cast<double>(beam.intensities.size()) * beam.bin_length_m);
    }
    return range_m;
  }

  const PanelCommand& panel_;
  std::optional<std::pair<std::size_t, Sweep>> chosen_;
  std::pair<double, std::size_t> fullness_;  ///< directions times range, and beams, of the chosen one
};

/// A panel's log and its navigation.
Result<RecordingOptions> panel_options(const PanelCommand& panel, const RenderCommand& command) {
  return recording_options(panel.path, command.bag, command.damage).map([&](RecordingOptions options) {
    options.head = panel.head;
    options.body_from_sonar = panel.build.body_from_sensor;
    options.nav_salinity = panel.nav_salinity;
    options.background_m = panel.background_m;
    return options;
  });
}

/// By the options, or by the water that the navigation logs tell of.
Result<double> sound_speed_ratio_of(const PanelCommand& panel, const RenderCommand& command) {
  if (!panel.nav_salinity) return panel.build.sound_speed_ratio;
  Result<RecordingOptions> options = panel_options(panel, command);
  if (!options) return tl::unexpected(options.error());
  options->nav_offset_s = 0.0;  // the water is the same at any time
  return open_recording({panel.input}, *std::move(options)).map([](const Recording& recording) {
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
  of_head.build.model = panel.head.apply_to(panel.build.model, (*source)->device());
  if (panel.background_m && panel.image == ShownImage::kBackground) {
    const Result<Background> background =
        Recording::open({panel.input}, {.damage = command.damage, .topic = command.bag.beams})
            .and_then([&](const Recording& recording) { return learn_background(recording, *panel.background_m); });
    if (!background) return tl::unexpected(background.error());
    source = std::make_unique<BeamsInMemory>(background->beams());
    of_head.marks = EchoMarks::kOff;
  } else {
    source =
        subtract_own_background(*std::move(source), panel.input, panel.background_m, command.damage, command.bag.beams);
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
  MapAxes axes = MapAxes::kNotTold;
  std::optional<MapPath> path = std::nullopt;  ///< of the vehicle that made it
  PictureView view = PictureView::kAbove;
  std::optional<Evaluation> evaluation = std::nullopt;  ///< where it is shown how echoes agree with the map
};

Result<MapToDraw> map_of_log(FileBytes file, const PanelCommand& panel, const RenderCommand& command,
                             Console& console) {
  Result<RecordingOptions> options = panel_options(panel, command);
  if (!options) return tl::unexpected(options.error());
  const Result<Recording> recording = open_recording({input_file(std::move(file), panel.input)}, *std::move(options));
  if (!recording) return tl::unexpected(recording.error());
  Result<VehiclePath> path = path_of(*recording);
  if (!path) return tl::unexpected(path.error());
  for (const std::string& warning : warnings_of(*recording, *path)) console.say(warning);
  if (const std::string text = still_vehicle_text(InputFile(panel.input), panel.path); !text.empty()) console.say(text);
  Result<RecordingMap> mapped = build_map(*recording, *std::move(path), panel.map, panel.build);
  if (!mapped) return tl::unexpected(mapped.error());
  MapToDraw made{std::move(mapped->map), mapped->path.axes};
  if (mapped->path.trajectory.poses().size() > 1) made.path = MapPath{"the vehicle", mapped->path.trajectory};
  if (panel.image == ShownImage::kAgreement) {
    // Cells of the map that is drawn: of the same size.
    EvaluateOptions options_of_map{.map = panel.map, .build = panel.build, .cells = CountCells::kYes};
    options_of_map.map.resolution_m = made.map.lattice().resolution_m();
    Result<Evaluation> found = evaluate(*recording, mapped->path, options_of_map);
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
