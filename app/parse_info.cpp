#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "shared_options.hpp"

namespace pingvox::app {

Result<Command> info_command(const Args& args) {
  InfoCommand command;
  const OptionTable table{
      "info",
      "Describes a file: a log of beams, of point scans or of navigation, a cloud, a map, a mesh, or a "
      "trajectory.\n"
      "Files are recognised by their content, not by their name.",
      {{"FILE", Positional::Count::kOne, "the file; - is standard input", store(command.file)}},
      {{"Options",
        {json_option(command.output_options), strict_option(command.damage), topic_option(command.bag),
         fields_option(command.bag)}}},
      {"pingvox info tank.mat", "pingvox info tank.bt --json"},
      ""};
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    command.limited = parsed.limited;
    return command;
  });
}

}  // namespace pingvox::app
