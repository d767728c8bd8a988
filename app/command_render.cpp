#include <fmt/format.h>

#include <map>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "commands.hpp"
#include "map_log.hpp"
#include "open_log.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "pingvox/viewer/side_by_side.hpp"

namespace pingvox::app {
namespace {

/// A picture, and what is to be seen on it.
struct Drawn {
  Picture picture;
  std::string what;
};

/// A sweep with what was found in it.
struct SeenSweep {
  std::size_t number = 0;  ///< counted from 1
  Sweep sweep;
  PolarImage image;                           ///< as it is to be shown
  std::vector<std::optional<Echo>> echoes{};  ///< empty when they are not to be marked
};

SeenSweep seen(std::size_t number, Sweep sweep, const PanelCommand& panel) {
  PolarImage raw(sweep);
  PolarImage smooth = filtered(raw, panel.build.filter);
  std::vector<std::optional<Echo>> echoes;
  if (panel.marks == EchoMarks::kOn) {
    echoes = detect_echoes(smooth, sweep, panel.build.echo);
  }
  PolarImage& image = panel.image == ShownImage::kRaw ? raw : smooth;
  return {number, std::move(sweep), std::move(image), std::move(echoes)};
}

std::string counted(std::size_t beams, std::span<const std::optional<Echo>> echoes, const PanelCommand& panel,
                    std::size_t skipped) {
  std::size_t found = 0;
  for (const auto& echo : echoes) found += echo ? 1 : 0;
  std::string text = fmt::format("{} beams", beams);
  if (panel.marks == EchoMarks::kOn) text += fmt::format(" with {} echoes", found);
  if (skipped > 0) text += fmt::format("; {} damaged ones left out", skipped);
  return text;
}

/// All beams that a polar picture shows.
class PolarGatherer {
 public:
  explicit PolarGatherer(const PanelCommand& panel) : panel_(panel) {}

  void add(std::size_t number, Sweep sweep) {
    if (panel_.sweep && *panel_.sweep != number) return;
    SeenSweep next = seen(number, std::move(sweep), panel_);
    for (std::size_t i = 0; i < next.sweep.beams.size(); ++i) {
      const auto row = next.image.row(i);
      next.sweep.beams[i].intensities.assign(row.begin(),
                                             row.begin() + static_cast<std::ptrdiff_t>(next.image.bins_in(i)));
    }
    beams_.insert(beams_.end(), next.sweep.beams.begin(), next.sweep.beams.end());
    echoes_.insert(echoes_.end(), next.echoes.begin(), next.echoes.end());
  }

  std::optional<Drawn> draw(std::size_t skipped) const {
    if (beams_.empty()) return std::nullopt;
    return Drawn{render_echoes(beams_, echoes_, panel_.echo_picture), counted(beams_.size(), echoes_, panel_, skipped)};
  }

 private:
  const PanelCommand& panel_;
  std::vector<Beam> beams_;
  std::vector<std::optional<Echo>> echoes_;
};

/// The one sweep that a Cartesian picture shows: that asked for, else the first complete one, else the first one.
class CartesianGatherer {
 public:
  explicit CartesianGatherer(const PanelCommand& panel) : panel_(panel) {}

  void add(std::size_t number, Sweep sweep) {
    const bool is_wanted = panel_.sweep ? *panel_.sweep == number : sweep.extent != Sweep::Extent::kCut;
    if (found_ || !(is_wanted || (!panel_.sweep && !spare_))) return;
    (is_wanted ? found_ : spare_) = std::pair(number, std::move(sweep));
  }

  std::optional<Drawn> draw(std::size_t skipped) const {
    const auto& chosen = found_ ? found_ : spare_;
    if (!chosen) return std::nullopt;
    const SeenSweep shown = seen(chosen->first, chosen->second, panel_);
    const CartesianPictureOptions options{panel_.echo_picture, panel_.between, panel_.build.model.width_rad};
    return Drawn{
        render_cartesian(shown.sweep, shown.image, shown.echoes, options),
        fmt::format("sweep {}, {}", shown.number, counted(shown.sweep.beams.size(), shown.echoes, panel_, skipped))};
  }

 private:
  const PanelCommand& panel_;
  std::optional<std::pair<std::size_t, Sweep>> found_, spare_;
};

template <class Gatherer>
Result<Drawn> draw_sweeps(FileBytes file, const PanelCommand& panel, Damage damage) {
  const std::string name = file.name;
  if (const auto ranges = check_ranges(panel.build); !ranges) return tl::unexpected(ranges.error());
  const Result<std::unique_ptr<BeamSource>> source = open_beams(std::move(file), damage);
  if (!source) return tl::unexpected(source.error());
  PanelCommand of_head = panel;
  of_head.build = panel.head.applied_to(panel.build, (*source)->device());
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
    (*beam)->bin_length_m *= panel.build.sound_speed_ratio;
    take(assembler.add(std::move(**beam)));
  }
  take(assembler.finish());
  std::optional<Drawn> drawn = gatherer.draw((*source)->skipped());
  if (drawn) return std::move(*drawn);
  if (sweeps == 0) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: holds no beams ({} left out)", name, (*source)->skipped()));
  }
  return fail(Error::Code::kBadOption,
              fmt::format("render: {}: there is no sweep {}, only {}", name, panel.sweep.value_or(0), sweeps));
}

Result<OccupancyMap> map_of_log(FileBytes file, const PanelCommand& panel, Damage damage) {
  Result<OccupancyMap> map = OccupancyMap::make(panel.map);
  if (!map) return map;
  const Result<Trajectory> trajectory = trajectory_of(panel.poses);
  if (!trajectory) return tl::unexpected(trajectory.error());
  const std::string name = file.name;
  const Result<Log> log = open_log(std::move(file), damage);
  if (!log) return tl::unexpected(log.error());
  const Result<BuildReport> report = map_log(*log, name, *trajectory, panel.build, panel.head, *map);
  if (!report) return tl::unexpected(report.error());
  return map;
}

/// A map and the side from which it is to be drawn.
struct MapToDraw {
  OccupancyMap map;
  PictureView view;
};

Drawn draw_map(const MapToDraw& shown, const MapPictureOptions& options) {
  const std::string what = shown.view == PictureView::kSlice  ? "a layer of the map"
                           : shown.view == PictureView::kSide ? "the map from the side"
                                                              : "the map from above";
  return {render_map(shown.map, options), what};
}

/// Does a panel's work: a picture is done, a map waits for those that it is compared with.
Result<std::variant<Drawn, MapToDraw>> prepared(FileBytes file, const PanelCommand& panel, Damage damage) {
  using Prepared = std::variant<Drawn, MapToDraw>;
  const Result<Format> format = recognised(file);
  if (!format) return tl::unexpected(format.error());
  const FormatKind kind = kind_of(*format);
  if (kind != FormatKind::kBeams && kind != FormatKind::kScans && kind != FormatKind::kMap) {
    const std::string_view hint = kind == FormatKind::kCloud  ? ": 'pingvox map' makes a map of it"
                                  : kind == FormatKind::kMesh ? ": 'pingvox convert' makes a map of its surface"
                                                              : "";
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: is {}, and only logs and maps can be drawn{}", file.name, described(*format), hint));
  }
  const PictureView view = panel.view.value_or(kind == FormatKind::kBeams ? PictureView::kPolar : PictureView::kAbove);
  const auto to_draw = [&](OccupancyMap map) { return Prepared(MapToDraw{std::move(map), view}); };
  if (view == PictureView::kPolar || view == PictureView::kCartesian) {
    if (kind != FormatKind::kBeams) {
      return fail(Error::Code::kBadOption,
                  fmt::format("render: {}: is {}: only logs of beams have polar and Cartesian pictures", file.name,
                              described(*format)));
    }
    auto drawn = view == PictureView::kPolar ? draw_sweeps<PolarGatherer>(std::move(file), panel, damage)
                                             : draw_sweeps<CartesianGatherer>(std::move(file), panel, damage);
    return std::move(drawn).map([](Drawn done) { return Prepared(std::move(done)); });
  }
  if (kind == FormatKind::kMap) {
    return read_map(file).map([&](MapFile read) { return to_draw(std::move(read.map)); });
  }
  return map_of_log(std::move(file), panel, damage).map(to_draw);
}

Box around(const std::optional<Box>& a, const Box& b) {
  if (!a) return b;
  return {a->min.cwiseMin(b.min), a->max.cwiseMax(b.max)};
}

/// All panels, side by side if there are several. A file that several show is read once; maps of one file that are seen
/// from one side show the same part of the world, so that they can be compared.
Result<Drawn> draw(const RenderCommand& command) {
  std::map<std::string, FileBytes> files;
  std::map<std::pair<std::string, MapView>, std::optional<Box>> parts;
  std::vector<std::variant<Drawn, MapToDraw>> works;
  for (const PanelCommand& panel : command.panels) {
    auto found = files.find(panel.input);
    if (found == files.end()) {
      Result<FileBytes> file = read_file(panel.input);
      if (!file) return tl::unexpected(file.error());
      found = files.emplace(panel.input, std::move(*file)).first;
    }
    auto work = prepared(found->second, panel, command.damage);
    if (!work) return tl::unexpected(work.error());
    if (const auto* shown = std::get_if<MapToDraw>(&*work)) {
      auto& part = parts[{panel.input, panel.map_picture.view}];
      if (const auto box = shown_part(shown->map, panel.map_picture)) part = around(part, *box);
    }
    works.push_back(std::move(*work));
  }

  std::vector<Panel> panels;
  std::string what;
  for (std::size_t i = 0; i < works.size(); ++i) {
    if (const auto* shown = std::get_if<MapToDraw>(&works[i])) {
      MapPictureOptions options = command.panels[i].map_picture;
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
  const Result<Drawn> drawn = draw(command);
  if (!drawn) return tl::unexpected(drawn.error());

  const Picture& picture = drawn->picture;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) { return write_png(picture, out); });
  if (!written) return tl::unexpected(written.error());
  const std::string summary = fmt::format("{}: {}, {} x {} pixels\n", on_one_line(command.output), drawn->what,
                                          picture.width(), picture.height());
  if (const auto told = console.summarise(summary, command.output); !told) return tl::unexpected(told.error());
  return 0;
}

}  // namespace pingvox::app
