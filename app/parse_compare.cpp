#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"

namespace pingvox::app {

Result<Command> compare_command(const Words& words) {
  CompareCommand command;
  const OptionTable table{"compare",
                          "Compares two maps cell by cell, at the finest resolution. Cells are the same when their "
                          "log-odds are; when one of\n"
                          "the files is a .bt, which holds no log-odds, when both are free or both are occupied.\n"
                          "Also says how right A is if B is the truth: occupied cells within one cell, and free ones.",
                          {{"A", Positional::Count::kOne, "a map; - is standard input", into(command.a)},
                           {"B", Positional::Count::kOne, "another of the same resolution and depth", into(command.b)}},
                          {{"Options", {json_option(command.manner), quiet_option(command.manner)}}},
                          {"pingvox compare ours.bt theirs.bt", "pingvox compare before.ot after.ot --json"},
                          "Exit status: 0 the same, 1 different, 2 trouble."};
  return parsed(table, words, [&]() -> Result<Command> {
    if (const auto once = check_standard_input({command.a, command.b}); !once) return tl::unexpected(once.error());
    return command;
  });
}

}  // namespace pingvox::app
