#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mapping_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"
#include "shell_words.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kPictureViews = {
    Word<PictureView>{"polar", PictureView::kPolar}, Word<PictureView>{"cartesian", PictureView::kCartesian},
    Word<PictureView>{"above", PictureView::kAbove}, Word<PictureView>{"side", PictureView::kSide},
    Word<PictureView>{"slice", PictureView::kSlice}};
constexpr std::array kSides = {Word<MapView>{"right", MapView::kRight}, Word<MapView>{"left", MapView::kLeft},
                               Word<MapView>{"front", MapView::kFront}, Word<MapView>{"behind", MapView::kBehind}};
constexpr std::array kShownImages = {Word<ShownImage>{"raw", ShownImage::kRaw},
                                     Word<ShownImage>{"filtered", ShownImage::kFiltered}};
constexpr std::array kEchoMarks = {Word<EchoMarks>{"on", EchoMarks::kOn}, Word<EchoMarks>{"off", EchoMarks::kOff}};
constexpr std::array kBetweens = {Word<BetweenBeams>{"interpolate", BetweenBeams::kInterpolate},
                                  Word<BetweenBeams>{"nothing", BetweenBeams::kNothing}};
constexpr std::array kPngOnly = {Word<Format>{"png", Format::kPng}};

/// What one panel of a picture shows, as the call says it. A copy with some options changed is the panel beside it.
struct PanelWords {
  PanelCommand panel;
  MapView from = MapView::kRight;
  std::optional<double> slice_z_m;
  std::optional<std::size_t> size_px;
  BuildWords build;
  std::vector<std::pair<std::string, std::string>> given;  ///< options with their values, those given later behind

  /// What an option was given, last of all; nullopt: nothing.
  std::optional<std::string> given_to(std::string_view name) const {
    for (auto it = given.rbegin(); it != given.rend(); ++it) {
      if (it->first == name) return it->second;
    }
    return std::nullopt;
  }
};

/// Makes the options also note what they are given.
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
std::vector<OptionTable::Group> panel_groups(PanelWords& words) {
  PanelCommand& panel = words.panel;
  const Take view = [&panel](const std::string& text) -> Result<void> {
    const Result<PictureView> value = value_of(kPictureViews, text);
    if (!value) return tl::unexpected(value.error());
    panel.view = *value;
    return {};
  };
  std::vector<OptionTable::Group> groups = {
      {"Picture",
       {{"--view", 0, words_of(kPictureViews),
         "a log as it was heard; or a map, also that of a log, from one of its sides, or one layer of cells",
         "polar of a log, above of a map", view},
        choice("--from", kSides, "of --view side: where one stands, as seen from the vehicle", words.from),
        {"--z", 0, "M", "of --view slice: a height in the layer", "none",
         within({-kAnyHigh, kAnyHigh, Limits::Ends::kBothOut}, into_optional(words.slice_z_m))},
        {"--min-z", 0, "M", "of a map, draw nothing below", "none", into_optional(panel.map_picture.min_z_m)},
        {"--max-z", 0, "M", "of a map, draw nothing above", "none", into_optional(panel.map_picture.max_z_m)},
        {"--sweep", 0, "N", "of a log, draw only this sweep, counted from 1", "all; cartesian: the first complete one",
         into_optional(panel.sweep)},
        choice("--show", kShownImages, "the intensities as heard, or as --filter makes them", panel.image),
        choice("--echoes", kEchoMarks, "a mark on each echo", panel.marks),
        choice("--between", kBetweens, "of --view cartesian: what is drawn between the beams", panel.between),
        {"--size", 0, "PX",
         "16..3072, of the drawing itself, without axes and legend: about the longer side of a map, at most the "
         "width of a polar picture (its height goes by the beams), both sides of a Cartesian one",
         "1000; of several 640", within({16.0, 3072.0}, into_optional(words.size_px))},
        {"--caption", 0, "TEXT", "below the picture", "what differs from those beside it", into(panel.caption)}}},
      echo_group(words.build.echoes, words.build.build.sound_speed_ratio),
      map_group(words.build),
      sensor_group(words.build)};
  note_in(words.given, groups);
  return groups;
}

/// What of the options that differ between panels this one has.
std::string caption_of(const PanelWords& words, const std::vector<PanelWords>& all) {
  // Its own table says how its options are called and what they are when they are not given.
  PanelWords defaults;
  std::string caption;
  for (const auto& group : panel_groups(defaults)) {
    for (const Option& option : group.options) {
      const auto value = words.given_to(option.name);
      const bool differs = std::any_of(all.begin(), all.end(),
                                       [&](const PanelWords& other) { return other.given_to(option.name) != value; });
      if (!differs || option.name == "--caption" || option.name == "--size") continue;
      caption +=
          fmt::format("{}{} {}", caption.empty() ? "" : ", ", option.name.substr(2), value.value_or(option.standard));
    }
  }
  return caption;
}

/// The panel with everything in its place.
Result<PanelCommand> panel_command(const PanelWords& words, std::size_t usual_size_px) {
  PanelCommand panel = words.panel;
  panel.map = words.build.map;
  panel.build = words.build.build_options();
  panel.head = words.build.head;
  if (!words.build.poses.empty()) panel.poses = words.build.poses;
  panel.map_picture.target_px = panel.echo_picture.target_px = words.size_px.value_or(usual_size_px);
  if (panel.view == PictureView::kSide) panel.map_picture.view = words.from;
  if (panel.view == PictureView::kSlice) {
    if (!words.slice_z_m) return off("--view slice: at which height? (--z M)");
    panel.map_picture.layer_z_m = words.slice_z_m;
  }
  if (panel.sweep == 0U) return off("--sweep: counts from 1");
  const auto& [low_m, high_m] = std::pair(panel.map_picture.min_z_m, panel.map_picture.max_z_m);
  if (low_m && high_m && *low_m >= *high_m) {
    return off(fmt::format("--min-z must be below --max-z, they are {} and {}", shown(*low_m), shown(*high_m)));
  }
  if (panel.view == PictureView::kSlice && (low_m || high_m)) {
    return off("--view slice: is one layer, the one at --z: it has no --min-z and --max-z");
  }
  if (const auto valid = panel.map_picture.validate(); !valid) return tl::unexpected(valid.error());
  if (const auto valid = panel.map.validate(); !valid) return tl::unexpected(valid.error());
  if (const auto valid = check_options(panel.build); !valid) return tl::unexpected(valid.error());
  const CartesianPictureOptions cartesian{panel.echo_picture, panel.between, panel.build.model.width_rad};
  if (const auto valid = cartesian.validate(); !valid) return tl::unexpected(valid.error());
  return panel;
}

/// An option that no panel has use for would silently change nothing.
Result<void> check_use(const std::vector<PanelWords>& panels, std::string_view option, PictureView view) {
  const auto any = [&](auto&& says) { return std::any_of(panels.begin(), panels.end(), says); };
  if (!any([&](const PanelWords& words) { return words.given_to(option).has_value(); })) return {};
  if (any([&](const PanelWords& words) { return words.panel.view == view; })) return {};
  return off(fmt::format("{}: is of --view {}", option, word_of(kPictureViews, view)));
}

}  // namespace

Result<Command> render_command(const Words& words) {
  RenderCommand command;
  Words inputs, beside;
  PanelWords first;
  const auto into_list = [](Words& list) -> Take {
    return [&list](const std::string& text) -> Result<void> {
      list.push_back(text);
      return {};
    };
  };
  OptionTable table{
      "render",
      "Draws a PNG: of a log of beams what was heard, with a mark on each echo; of a map (or a log, mapped as by\n"
      "'pingvox map') what is where. Several FILEs, and several settings of one, stand side by side.",
      {{"FILE", Positional::Count::kMany, "a log or a map, told by content; - is standard input", into_list(inputs)}},
      panel_groups(first),
      {"pingvox render tank.mat -o echoes.png --sweep 3 --threshold 50",
       "pingvox render tank.mat -o sweep.png --view cartesian --show filtered", "pingvox render tank.bt -o map.png",
       "pingvox render tank.bt -o layer.png --view slice --z 0.5",
       "pingvox render before.bt after.bt -o both.png --view side --from behind",
       "pingvox render tank.mat -o thresholds.png --view above --threshold 20 --beside '--threshold 70'"},
      "Beams, echoes and cells differ in lightness, not only in colour.\n"
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  auto& options = table.groups.front().options;
  options.insert(options.begin(), output_option(command.output, "the picture, .png; - is standard output"));
  options.push_back({"--beside", 0, "OPTIONS",
                     "the same again beside it with these options changed, as in '--filter none'; may be repeated",
                     "none", into_list(beside), Repeats::kEachCounts});
  options.push_back({"--title", 0, "TEXT", "above the picture", "none", into(command.title)});
  options.push_back(strict_option(command.damage));
  options.push_back(quiet_option(command.manner));
  options.push_back(config_option());
  return parsed(table, words, [&]() -> Result<Command> {
    const Result<Format> output_as = output_format(command.output, std::nullopt, kPngOnly);
    if (!output_as) return tl::unexpected(output_as.error());
    std::vector<PanelWords> settings = {first};
    for (const std::string& text : beside) {
      const Result<Words> changed = split_words(text);
      if (!changed) return off("--beside: " + changed.error().message);
      PanelWords next = first;
      next.panel.caption.clear();
      const Result<Parsed> taken = parse({"render: --beside", "", {}, panel_groups(next), {}, ""}, *changed);
      if (!taken) return tl::unexpected(taken.error());
      if (*taken == Parsed::kHelpWanted) return off("--beside: takes no --help");
      settings.push_back(std::move(next));
    }
    for (const auto& [option, view] :
         {std::pair("--z", PictureView::kSlice), std::pair("--from", PictureView::kSide)}) {
      if (const auto used = check_use(settings, option, view); !used) return tl::unexpected(used.error());
    }
    const std::size_t panels = settings.size() * inputs.size();
    for (const PanelWords& setting : settings) {
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
    Words files = inputs;
    for (const PanelWords& setting : settings) {
      if (setting.build.poses == "-") files.emplace_back("-");
    }
    if (const auto once = check_standard_input(files); !once) return tl::unexpected(once.error());
    if (const auto folder = check_folder_of(command.output); !folder) return tl::unexpected(folder.error());
    return command;
  });
}

}  // namespace pingvox::app
