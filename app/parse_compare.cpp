#include <fmt/core.h>

#include <string>
#include <utility>

#include "command_files.hpp"
#include "input_kinds.hpp"
#include "nav_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "pingvox/geometry/degree.hpp"
#include "shared_options.hpp"

namespace pingvox::app {

namespace {

/// An option that needs --visible-from.
Option seen(Option option) {
  option.only_with = {{"--visible-from"}};
  return option;
}

Option for_maps(Option option) {
  option.only_for = {std::string(kMaps)};
  return option;
}

}  // namespace

Result<Command> compare_command(const Args& args) {
  CompareCommand command;
  ViewOptions& view = command.view;
  std::string visible_from;
  const OptionTable table{
      "compare",
      "Compares two maps cell by cell, at the finest resolution. Cells are the same if their log-odds are equal; if\n"
      "A or B is a .bt, which has no log-odds, if both cells are free or both are occupied. 'only in A' counts cells\n"
      "that are unknown in B. With B as ground truth: precision is the share of A's occupied cells that lie within\n"
      "one cell of an occupied cell of B, recall the reverse, and 'free' the share of A's free cells that are free in\n"
      "B.\n"
      "Two trajectories (TUM): the horizontal error of A at the times of B, after aligning the first fix, the mean "
      "and\n"
      "the best rigid fit, and the relative error per metre. Headings of B are not used: B may be GPS fixes.",
      {{"A", Positional::Count::kOne, "a map or trajectory; - is standard input", store(command.a)},
       {"B", Positional::Count::kOne,
        "one of the same kind, such as ground truth: maps of the same resolution and depth", store(command.b)}},
      {{"Options",
        {for_maps({"--layer", 0, "M", "compare only the layer of cells at this height", "all layers",
                   within(kFinite, store_optional(command.layer_z_m))}),
         for_maps({"--occupied", 0, "P", "lowest probability of an occupied cell of A", "0.5",
                   within(kProbabilities, store_optional(command.occupied_probability))}),
         json_option(command.output_options), quiet_option(command.output_options)}},
       {"Only cells that could be seen",
        {for_maps({"--visible-from", 0, "FILE",
                   "compare only what could be seen of B from the poses in FILE (TUM), and leave out what lies beyond "
                   "a side of B "
                   "without a wall",
                   "all of B", store(visible_from)}),
         seen({"--min-range", 0, "M", "nearest range at which a cell is seen", number_text(view.min_range_m),
               within(ViewOptions::kMinRanges_m, store_number(view.min_range_m))}),
         seen({"--max-range", 0, "M", "farthest range at which a cell is seen, such as that of the log", "no limit",
               within(kPositive, store_number(view.max_range_m))}),
         seen(
             {"--beam-height", 0, "DEG", "vertical beam width, full angle", number_text(view.height_rad / kDegree_rad),
              within(in_units_of(kDegree_rad, ViewOptions::kHeights_rad), store_number(view.height_rad, kDegree_rad))}),
         seen(mount_option(command.body_from_sensor))}}},
      {"pingvox compare ours.bt theirs.bt", "pingvox compare before.ot after.ot --json",
       "pingvox compare harbour.ot truth/world.bt --layer 0 --occupied 0.7",
       "pingvox compare harbour.ot truth/world.bt --visible-from truth/poses.tum --max-range 10",
       "pingvox compare dive.tum gps.tum --json"},
      "Exit status: 0 equal, 1 different, 2 failed."};
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    CommandFiles files;
    files.read("A", command.a);
    files.read("B", command.b);
    files.read("--visible-from", visible_from);
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    command.limited = parsed.limited;
    if (!visible_from.empty()) command.visible_from = visible_from;
    if (!(command.view.max_range_m > command.view.min_range_m)) {
      return usage_error(fmt::format("--max-range: must be above --min-range ({:.6g} m), is {:.6g} m",
                                     command.view.min_range_m, command.view.max_range_m));
    }
    return command;
  });
}

}  // namespace pingvox::app
