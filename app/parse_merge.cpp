#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include "command_files.hpp"
#include "nav_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"
#include "shell_words.hpp"

namespace pingvox::app {

Result<Command> merge_command(const Args& args) {
  MergeCommand command;
  std::optional<Format> asked_format;
  const OptionTable table{
      "merge",
      "Adds maps: the log-odds of each cell, clamped. A map that is moved (--at), or whose cells are larger or "
      "smaller\n"
      "than those of the result, is resampled: no wall gets lost, and nothing becomes free that was not.",
      {{"MAP", Positional::Count::kMany, ".bt, .ot or .pvx; - is standard input", store_each(command.maps)}},
      {{"Output",
        {output_option(command.output, "the map: .bt or .ot (OctoMap), .pvx (any depth), .ply, .pcd or .xyz"),
         choice("--format", kMapFormats, "format of the map where its name has none of these suffixes", asked_format,
                "by suffix, bt on standard output"),
         json_option(command.output_options), quiet_option(command.output_options)}},
       {"Maps",
        {{"--at", 0, "MAP=X,Y,Z,R,P,Y",
          "where the origin of MAP, named as above, lies in the result: metres, and roll, pitch, yaw in degrees",
          "all maps are in one frame", store_pose_of(command.at, "MAP"), Repeats::kEachCounts},
         {"--resolution", 0, "M", "edge of a cell of the result", "that of the map with the largest cells",
          within(kResolutions, store_optional(command.resolution_m))},
         config_option()}}},
      {"pingvox merge monday.ot tuesday.ot -o harbour.ot",
       "pingvox merge north.pvx south.pvx --at south.pvx=12.5,-3,0,0,0,90 -o quay.bt --resolution 0.1"},
      "A .bt has no log-odds: its occupied cells count as 0.971, its free ones as 0.1192.\n"
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    const Result<Format> output_as = output_format(command.output, asked_format, kMapFormats);
    if (!output_as) return tl::unexpected(output_as.error());
    command.format = *output_as;
    for (const auto& [name, pose] : command.at) {
      if (std::ranges::find(command.maps, name) == command.maps.end()) {
        return usage_error(fmt::format("--at: '{}' is not one of the maps ({})", name, fmt::join(command.maps, ", ")));
      }
    }
    CommandFiles files;
    files.read("MAP", command.maps);
    files.read("--config", parsed.config);
    files.write("-o", command.output);
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    if (const auto folder = check_folder_of(command.output); !folder) return tl::unexpected(folder.error());
    command.made_by = command_text("merge", args);
    return command;
  });
}

}  // namespace pingvox::app
