#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command_files.hpp"
#include "echo_options.hpp"
#include "input_kinds.hpp"
#include "mapping_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"
#include "shell_words.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kPictureViews = {
    Choice<PictureView>{"polar", PictureView::kPolar}, Choice<PictureView>{"cartesian", PictureView::kCartesian},
    Choice<PictureView>{"above", PictureView::kAbove}, Choice<PictureView>{"side", PictureView::kSide},
    Choice<PictureView>{"slice", PictureView::kSlice}};
constexpr std::array kSides = {Choice<MapView>{"right", MapView::kRight}, Choice<MapView>{"left", MapView::kLeft},
                               Choice<MapView>{"front", MapView::kFront}, Choice<MapView>{"behind", MapView::kBehind}};
constexpr std::array kShownImages = {
    Choice<ShownImage>{"raw", ShownImage::kRaw}, Choice<ShownImage>{"filtered", ShownImage::kFiltered},
    Choice<ShownImage>{"background", ShownImage::kBackground}, Choice<ShownImage>{"agreement", ShownImage::kAgreement}};
constexpr std::array kEchoMarks = {Choice<EchoMarks>{"on", EchoMarks::kOn}, Choice<EchoMarks>{"off", EchoMarks::kOff}};
constexpr std::array kBetweens = {Choice<BetweenBeams>{"interpolate", BetweenBeams::kInterpolate},
                                  Choice<BetweenBeams>{"nothing", BetweenBeams::kNothing}};
constexpr std::array kUps = {Choice<MapAxes>{"ahead", MapAxes::kUnknown},
                             Choice<MapAxes>{"north", MapAxes::kEastNorth}};
constexpr std::array kPngOnly = {Choice<Format>{"png", Format::kPng}};

/// The options of one panel. --beside copies them and changes some.
struct PanelArgs {
  PanelCommand panel;
  MapView from = MapView::kRight;
  std::optional<double> slice_z_m;
  std::optional<std::size_t> size_px;
  BuildArgs build;
  std::vector<std::pair<std::string, std::string>> given;  ///< options with their values, in order

  /// Last value of an option; nullopt: not given.
  std::optional<std::string> value_of(std::string_view name) const {
    for (auto it = given.rbegin(); it != given.rend(); ++it) {
      if (it->first == name) return it->second;
    }
    return std::nullopt;
  }
};

/// Makes the options also record their values.
void note_in(std::vector<std::pair<std::string, std::string>>& given, std::vector<OptionTable::Group>& groups) {
  for (auto& group : groups) {
    for (Option& option : group.options) {
      option.take = [&given, name = option.name, take = option.take](const std::string& text) -> Result<void> {
        Result<void> taken = take(text);
        if (taken) given.emplace_back(name, text);
        return taken;
      };
    }
  }
}

/// The options that may differ from panel to panel.
std::vector<OptionTable::Group> panel_groups(PanelArgs& args) {
  PanelCommand& panel = args.panel;
  std::vector<OptionTable::Group> groups = {
      {"Picture",
       {choice("--view", kPictureViews,
               "a log as recorded (polar, cartesian), or a map, also of a log, seen from above, from a side, or one "
               "layer of it",
               panel.view, "polar of a log, above of a map"),
        choice("--from", kSides, "side from which --view side looks, seen from the vehicle", args.from),
        choice("--up", kUps, "what is up in a map from above: north (y), or ahead (x) of a vehicle that stands still",
               panel.axes, "north where the map or --nav has it"),
        {"--z", 0, "M", "height of the layer that --view slice draws", "none",
         within(kFinite, store_optional(args.slice_z_m))},
        {"--min-z", 0, "M", "lowest height of a map that is drawn", "none", store_optional(panel.map_picture.min_z_m)},
        {"--max-z", 0, "M", "greatest height of a map that is drawn", "none",
         store_optional(panel.map_picture.max_z_m)},
        {"--path", 0, "FILE",
         "draw a path over a map, in its frame, at most 5: a trajectory (TUM lines) or a navigation log",
         "of a log, the path of --nav or --poses", store_each(panel.drawn_paths), Repeats::kEachCounts},
        {"--sweep", 0, "N", "draw only this sweep of a log, counted from 1 as in 'pingvox info'",
         "all; cartesian: the fullest one", store_optional(panel.sweep)},
        choice("--show", kShownImages,
               "intensities as recorded, smoothed by --filter, or the background that is subtracted; agreement: a map "
               "of a log, its cells coloured by how held-out echoes agree with them (see 'evaluate')",
               panel.image),
        choice("--echoes", kEchoMarks, "mark the detected echoes", panel.marks),
        choice("--between", kBetweens, "what --view cartesian draws between beams", panel.between),
        {"--size", 0, "PX",
         "size of the drawing without axes and legend, 16..3072: longer side of a map, largest width of a polar "
         "picture, both sides of a Cartesian one",
         "1000; of several pictures 640", within(kPictureSizes_px, store_optional(args.size_px))},
        {"--caption", 0, "TEXT", "text below the picture", "the options that differ between pictures",
         store(panel.caption)}}},
      echo_group(args.build.echoes, WaterOfNav::kYes),
      map_group(args.build),
      sensor_group(args.build)};
  for (Option& option : occupancy_options(panel.occupancy)) groups[0].options.push_back(std::move(option));
  const auto limit = [&](std::string_view name, const std::vector<std::string>& only_for) {
    for (auto& group : groups) {
      for (Option& option : group.options) {
        if (option.name == name) option.only_for = only_for;
      }
    }
  };
  const std::string polar = view_kind(PictureView::kPolar), cartesian = view_kind(PictureView::kCartesian);
  const std::string mapped(kMappedLogs);
  for (const std::size_t mapping : {2U, 3U}) {
    for (Option& option : groups[mapping].options) option.only_for = {mapped};
  }
  limit("--z", {view_kind(PictureView::kSlice)});
  limit("--from", {view_kind(PictureView::kSide)});
  for (const char* name : {"--min-z", "--max-z", "--occupied", "--free", "--cut-depth", "--path", "--up"}) {
    limit(name, {std::string(kDrawnMaps)});
  }
  for (const char* name : {"--sweep", "--echoes"}) limit(name, {polar, cartesian});
  limit("--show", {polar, cartesian, mapped});
  limit("--between", {cartesian});
  limit("--max-range", {std::string(kBeamLogs), mapped});
  limit("--beam-width", {mapped, cartesian});
  limit("--device", {mapped, cartesian});
  for (Option& option : groups[3].options) {
    if (option.name == "--beam-width" || option.name == "--device")
      option.only_with.push_back({"--view", {"cartesian"}});
  }
  note_in(args.given, groups);
  return groups;
}

/// What --show shows says what it is limited to.
std::vector<LimitedOption> limit_show(std::vector<LimitedOption> limited, ShownImage image) {
  for (LimitedOption& option : limited) {
    if (option.name != "--show") continue;
    const bool is_of_map = image == ShownImage::kAgreement;
    option.only_for = is_of_map ? std::vector{std::string(kMappedLogs)}
                                : std::vector{view_kind(PictureView::kPolar), view_kind(PictureView::kCartesian)};
  }
  return limited;
}

/// The options in which this panel differs from the others.
std::string caption_of(const PanelArgs& args, const std::vector<PanelArgs>& all) {
  // A separate table, for names and defaults.
  PanelArgs defaults;
  std::string caption;
  for (const auto& group : panel_groups(defaults)) {
    for (const Option& option : group.options) {
      const auto value = args.value_of(option.name);
      const bool differs = std::any_of(all.begin(), all.end(),
                                       [&](const PanelArgs& other) { return other.value_of(option.name) != value; });
      if (!differs || option.name == "--caption" || option.name == "--size") continue;
      caption +=
          fmt::format("{}{} {}", caption.empty() ? "" : ", ", option.name.substr(2), value.value_or(option.standard));
    }
  }
  return caption;
}

/// Converts the arguments of a panel.
Result<PanelCommand> panel_command(const PanelArgs& args, std::size_t usual_size_px) {
  PanelCommand panel = args.panel;
  if (const auto valid = panel.occupancy.validate(); !valid) return tl::unexpected(valid.error());
  panel.map = args.build.map;
  panel.map.thresholds = panel.occupancy.apply_to(panel.map.thresholds);
  if (const auto valid = args.build.apply_to(panel.recording, panel.map, panel.build); !valid) {
    return tl::unexpected(valid.error());
  }
  if (panel.image == ShownImage::kBackground && !panel.recording.background_m) {
    return usage_error("--show background: needs a range (--background M)");
  }
  panel.map_picture.target_px = panel.echo_picture.target_px = args.size_px.value_or(usual_size_px);
  if (panel.view == PictureView::kSide) panel.map_picture.view = args.from;
  if (panel.view == PictureView::kSlice) {
    if (!args.slice_z_m) return usage_error("--view slice: needs a height (--z M)");
    panel.map_picture.layer_z_m = args.slice_z_m;
  }
  if (panel.drawn_paths.size() > MapPictureOptions::kMaxPaths) {
    return usage_error(fmt::format("--path: at most {} in one picture", MapPictureOptions::kMaxPaths));
  }
  if (panel.sweep == 0U) return usage_error("--sweep: sweeps are counted from 1");
  const auto& [low_m, high_m] = std::pair(panel.map_picture.min_z_m, panel.map_picture.max_z_m);
  if (low_m && high_m && *low_m >= *high_m) {
    return usage_error(
        fmt::format("--min-z must be below --max-z, they are {} and {}", number_text(*low_m), number_text(*high_m)));
  }
  if (panel.view == PictureView::kSlice && (low_m || high_m)) {
    return usage_error("--min-z and --max-z: have no effect on --view slice, which draws the layer at --z");
  }
  if (const auto valid = panel.map_picture.validate(); !valid) return tl::unexpected(valid.error());
  const CartesianPictureOptions cartesian{panel.echo_picture, panel.between, panel.build.model.width_rad};
  if (const auto valid = cartesian.validate(); !valid) return tl::unexpected(valid.error());
  return panel;
}

/// Kinds that options may be limited to, as far as known before reading the file.
std::vector<std::string> possible_kinds(const std::vector<PanelArgs>& panels) {
  std::vector<std::string> kinds;
  const auto add = [&kinds](std::string kind) {
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) kinds.push_back(std::move(kind));
  };
  for (const PanelArgs& args : panels) {
    const auto view =
        args.panel.image == ShownImage::kAgreement ? args.panel.view.value_or(PictureView::kAbove) : args.panel.view;
    add(view_kind(view.value_or(PictureView::kPolar)));
    if (!view) add(view_kind(PictureView::kAbove));
    add(std::string(kBeamLogs));
    if (view == PictureView::kPolar || view == PictureView::kCartesian) continue;
    add(std::string(kDrawnMaps));
    add(std::string(kMappedLogs));
  }
  return kinds;
}

}  // namespace

std::string view_kind(PictureView view) {
  return "--view " + choice_name(kPictureViews, view);
}

Result<Command> render_command(const Args& args) {
  RenderCommand command;
  Args inputs, beside;
  PanelArgs first;
  OptionTable table{
      "render",
      "Draws a PNG picture: the intensities of a log of beams and the echoes detected in it, or a map. A log is drawn\n"
      "as a map, too, built as by 'pingvox map'. Several FILEs, or several settings of one (--beside), are drawn side\n"
      "by side.",
      {{"FILE", Positional::Count::kMany, "a log or a map, recognised by content; - is standard input",
        store_each(inputs)}},
      panel_groups(first),
      {"pingvox render tank.mat -o echoes.png --sweep 3 --threshold 50",
       "pingvox render tank.mat -o sweep.png --view cartesian --show filtered", "pingvox render tank.bt -o map.png",
       "pingvox render tank.bt -o layer.png --view slice --z 0.5",
       "pingvox render world.bt -o paths.png --path true.tum --path slam.tum",
       "pingvox render before.bt after.bt -o both.png --view side --from behind",
       "pingvox render dive.csv --poses dive.tum -o agreement.png --show agreement",
       "pingvox render tank.mat -o thresholds.png --view above --threshold 20 --beside '--threshold 70'"},
      "In maps, a pixel shows the most occupied cell in the line of sight; its shade shows how certain it is. "
      "Pictures\n"
      "are readable in shades of grey, too.\n"
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  auto& options = table.groups.front().options;
  options.insert(options.begin(), output_option(command.output, "the picture, .png; - is standard output"));
  options.push_back({"--beside", 0, "OPTIONS",
                     "draw the same again beside it with these options changed, such as '--filter none'", "none",
                     store_each(beside), Repeats::kEachCounts});
  options.push_back({"--title", 0, "TEXT", "text above the picture", "none", store(command.title)});
  options.push_back(strict_option(command.damage));
  options.push_back(topic_option(command.bag));
  options.push_back(fields_option(command.bag));
  options.push_back(quiet_option(command.output_options));
  options.push_back(config_option());
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    const Result<Format> output_as = output_format(command.output, std::nullopt, kPngOnly);
    if (!output_as) return tl::unexpected(output_as.error());
    command.limited = limit_show(parsed.limited, first.panel.image);
    std::vector<PanelArgs> settings = {first};
    for (const std::string& text : beside) {
      const Result<Args> changed = split_shell_words(text);
      if (!changed) return usage_error("--beside: " + changed.error().message);
      PanelArgs next = first;
      next.panel.caption.clear();
      // Repeated options replace those of the first panel.
      std::vector<std::string> navs = std::exchange(next.build.navs, {});
      std::vector<NamedSource> nav_sources = std::exchange(next.build.nav_sources, {});
      std::vector<std::string> paths = std::exchange(next.panel.drawn_paths, {});
      const Result<Parsed> taken = parse({"render: --beside", "", {}, panel_groups(next), {}, ""}, *changed);
      if (!taken) return tl::unexpected(taken.error());
      std::ranges::move(limit_show(taken->limited, next.panel.image), std::back_inserter(command.limited));
      if (taken->is_help_wanted) return usage_error("--beside: takes no --help");
      if (next.build.navs.empty()) next.build.navs = std::move(navs);
      if (next.build.nav_sources.empty()) next.build.nav_sources = std::move(nav_sources);
      if (next.panel.drawn_paths.empty()) next.panel.drawn_paths = std::move(paths);
      settings.push_back(std::move(next));
    }
    if (const auto used = check_limited(command.limited, possible_kinds(settings)); !used) {
      return tl::unexpected(used.error());
    }
    const std::size_t panels = settings.size() * inputs.size();
    for (const PanelArgs& setting : settings) {
      const Result<PanelCommand> panel = panel_command(setting, panels > 1 ? 640 : 1000);
      if (!panel) return tl::unexpected(panel.error());
      for (const std::string& input : inputs) {
        command.panels.push_back(*panel);
        command.panels.back().input = input;
        std::string& caption = command.panels.back().caption;
        if (!caption.empty()) continue;
        caption = caption_of(setting, settings);
        if (inputs.size() > 1) {
          if (!caption.empty()) caption.insert(0, ": ");
          caption.insert(0, std::filesystem::path(input).filename().string());
        }
      }
    }
    CommandFiles files;
    files.read("FILE", inputs);
    files.read("--fields", command.bag.file);
    files.read("--config", parsed.config);
    for (const PanelArgs& setting : settings) {
      setting.build.name_files(files);
      files.read("--path", setting.panel.drawn_paths);
    }
    files.write("-o", command.output);
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    if (const auto folder = check_folder_of(command.output); !folder) return tl::unexpected(folder.error());
    return command;
  });
}

}  // namespace pingvox::app
