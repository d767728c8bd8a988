#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "command_files.hpp"
#include "echo_options.hpp"
#include "mapping_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "origin_fix.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"
#include "sonar/internal/option_limits.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kPictureFormats = {Choice<Format>{"png", Format::kPng}, Choice<Format>{"tif", Format::kTif}};
constexpr std::array kBlends = {Choice<Blend>{"mean", Blend::kMean}, Choice<Blend>{"maximum", Blend::kMaximum}};
constexpr std::array kPictureUps = {Choice<PictureUp>{"ahead", PictureUp::kX},
                                    Choice<PictureUp>{"north", PictureUp::kY}};

/// The options of these names; of logs of beams only, as all of this command are.
std::vector<Option> options_named(OptionTable::Group group, std::initializer_list<std::string_view> names) {
  std::vector<Option> options;
  for (Option& option : group.options) {
    if (std::ranges::find(names, option.name) == names.end()) continue;
    option.only_for.clear();
    std::erase_if(option.only_with, [](const Condition& condition) { return condition.name == "--beam"; });
    options.push_back(std::move(option));
  }
  return options;
}

}  // namespace

Result<Command> mosaic_command(const Args& args) {
  MosaicCommand command;
  RecordingArgs& recording = command.recording;
  RecordingMosaicOptions& mosaic = command.mosaic;
  std::string output;
  std::optional<Format> asked_format;
  std::optional<double> gamma;
  BuildArgs build;
  OptionTable::Group sensor{
      "Sensor",
      options_named(sensor_group(build), {"--poses", "--nav", "--nav-source", "--nav-offset", "--use-calibration",
                                          "--mount", "--beam-width", "--beam-height", "--device"})};
  OptionTable::Group ranges{
      "Beams",
      {{"--min-range", 0, "M", "leave out what is nearer than M (transducer ringing)", number_text(mosaic.min_range_m),
        within(kNearestRanges_m, store_number(mosaic.min_range_m))},
       {"--max-range", 0, "M", "leave out what is farther than M", "none",
        within(kFarthestRanges_m, store_number(mosaic.max_range_m))}}};
  for (Option& option :
       options_named(echo_group(build.echoes, WaterOfNav::kYes), {"--sound-speed", "--water", "--background"})) {
    ranges.options.push_back(std::move(option));
  }
  const OptionTable table{
      "mosaic",
      "Draws the image of a scanning sonar on the ground, north up, in the frame of the navigation: each bin at its\n"
      "range from the head, over the width of the beam. Ground without beams is transparent.",
      {{"LOG", Positional::Count::kMany, "beams, as for 'map'; - is standard input", store_each(recording.logs)}},
      {{"Output",
        {output_option(output,
                       "the picture: .png in grey, with a world file (.pgw) beside it; .tif (GeoTIFF) of intensities "
                       "for a GIS; - is standard output"),
         choice("--format", kPictureFormats, "format of the picture where its name has none of these suffixes",
                asked_format, "by suffix, png on standard output"),
         json_option(command.output_options), quiet_option(command.output_options),
         choice("--progress", kProgress, "show the progress on standard error; auto: on a terminal",
                command.output_options.progress)}},
       {"Picture",
        {{"--resolution", 0, "M", "edge of a pixel",
          "half a cell of a map: 0.025 up to a range of 10 m, coarser beyond",
          within(MosaicOptions::kResolutions_m, store_optional(mosaic.resolution_m))},
         choice("--blend", kBlends, "what a pixel has where beams overlap: their mean, or the strongest", mosaic.blend),
         choice("--up", kPictureUps, "what is up in a .png: north (y), or ahead (x) of a head that stands still",
                command.up, "ahead without --nav and --poses, else north"),
         {"--gamma", 0, "G", "lightness in a .png is (intensity / 255)^G: less amplifies faint echoes",
          number_text(command.gamma), within(kPositive, store_optional(gamma))},
         {"--origin", 0, "LAT,LON", "where 0, 0 is, x east and y north, for .tif: degrees of WGS 84",
          "the first fix of --nav", store_origin(command.fix)}}},
       std::move(sensor),
       std::move(ranges),
       {"Input",
        {strict_option(recording.damage), topic_option(recording.bag), fields_option(recording.bag), config_option()}}},
      {"pingvox mosaic dive.bin --nav dive.tlog -o dive.png",
       "pingvox mosaic dive.bin --nav dive.tlog -o dive.tif --blend maximum",
       "pingvox mosaic dive.csv --poses dive.tum -o dive.tif --origin 54.3,10.15 --resolution 0.1"},
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    const Result<Format> output_as = output_format(output, asked_format, kPictureFormats);
    if (!output_as) return tl::unexpected(output_as.error());
    command.format = *output_as;
    const bool is_png = command.format == Format::kPng;
    if (!is_png && (command.up || gamma)) {
      return usage_error(fmt::format("{}: has no effect on this output, only on .png", gamma ? "--gamma" : "--up"));
    }
    if (is_png && command.fix) return usage_error("--origin: has no effect on this output, only on .tif");
    command.gamma = gamma.value_or(command.gamma);
    if (!(mosaic.max_range_m > mosaic.min_range_m)) {
      return usage_error(
          fmt::format("--max-range ({}) must be above --min-range ({})", mosaic.max_range_m, mosaic.min_range_m));
    }
    MapOptions map;
    BuildOptions of_build;
    if (const auto valid = build.apply_to(recording, map, of_build); !valid) return tl::unexpected(valid.error());
    mosaic.sound_speed_ratio = of_build.sound_speed_ratio;
    if (const auto valid = mosaic.validate(); !valid) return tl::unexpected(valid.error());
    if (output == "-" && command.output_options.report == Report::kJson) {
      return usage_error("-o - and --json: both write to standard output");
    }
    CommandFiles files;
    files.read("LOG", recording.logs);
    files.read("--config", parsed.config);
    files.read("--fields", recording.bag.file);
    build.name_files(files);
    files.write("-o", output);
    if (is_png && output != "-") files.write("the world file beside the output,", world_file(output));
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    if (const auto folder = check_folder_of(output); !folder) return tl::unexpected(folder.error());
    command.output = output;
    return command;
  });
}

}  // namespace pingvox::app
