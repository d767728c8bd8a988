#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"

namespace pingvox::app {

Result<Command> compare_command(const Args& args) {
  CompareCommand command;
  const OptionTable table{
      "compare",
      "Compares two maps cell by cell, at the finest resolution. Cells are equal if their log-odds are; if one of the\n"
      "files is a .bt, which has no log-odds, if both are free or both are occupied. Also judges A with B as ground\n"
      "truth: precision and recall of occupied cells (within one cell), and how many of A's free cells are free in B.",
      {{"A", Positional::Count::kOne, "a map; - is standard input", into(command.a)},
       {"B", Positional::Count::kOne, "a map of the same resolution and depth, such as ground truth", into(command.b)}},
      {{"Options",
        {{"--layer", 0, "M", "compare only the layer of cells that holds this height", "all layers",
          within({-kAnyHigh, kAnyHigh, Limits::Ends::kBothOut}, into_optional(command.layer_z_m))},
         {"--occupied", 0, "P", "probability from which on a cell of A is occupied", "0.5",
          within({0.0, 1.0, Limits::Ends::kBothOut}, into_optional(command.occupied_probability))},
         json_option(command.output_options),
         quiet_option(command.output_options)}}},
      {"pingvox compare ours.bt theirs.bt", "pingvox compare before.ot after.ot --json",
       "pingvox compare harbour.ot truth/world.bt --layer 0 --occupied 0.7"},
      "Exit status: 0 equal, 1 different, 2 failed."};
  return parse_command(table, args, [&](const Parsed&) -> Result<Command> {
    if (const auto once = check_standard_input({command.a, command.b}); !once) return tl::unexpected(once.error());
    return command;
  });
}

}  // namespace pingvox::app
