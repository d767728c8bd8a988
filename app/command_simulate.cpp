#include <fmt/core.h>

#include "commands.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"

namespace pingvox::app {

Result<int> run(const SimulateCommand& command, Console& console) {
  TankSimulator simulator(command.tank);
  std::size_t beams = 0;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) -> Result<void> {
    const Result<std::size_t> count = write_csv(simulator, out);
    if (!count) return tl::unexpected(count.error());
    beams = *count;
    return {};
  });
  if (!written) return tl::unexpected(written.error());
  const auto told =
      console.summarise(fmt::format("{}: {} beams of a tank, {} turns, seed {}\n", on_one_line(command.output), beams,
                                    command.tank.turns, command.tank.seed),
                        command.output);
  if (!told) return tl::unexpected(told.error());
  return 0;
}

}  // namespace pingvox::app
