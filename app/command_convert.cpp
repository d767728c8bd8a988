#include <fmt/core.h>

#include <utility>

#include "commands.hpp"
#include "map_report.hpp"
#include "open_log.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "write_map_file.hpp"

namespace pingvox::app {
namespace {

tl::unexpected<Error> does_not_become(const std::string& name, Format from, Format to) {
  const bool to_map = kind_of(to) == FormatKind::kMap || kind_of(to) == FormatKind::kCloud;
  const FormatKind kind = kind_of(from);
  const bool is_log = kind == FormatKind::kBeams || kind == FormatKind::kScans;
  return fail(Error::Code::kBadOption,
              fmt::format("convert: {}: is {}, which does not become .{}{}", name, described(from), name_of(to),
                          to_map && is_log ? ": 'pingvox map' does that" : ""));
}

/// What is written from a log, and how much of it there was.
Result<std::string> convert_log(FileBytes file, const ConvertCommand& command) {
  const Result<std::unique_ptr<BeamSource>> source = open_beams(std::move(file), command.damage);
  if (!source) return tl::unexpected(source.error());
  std::size_t beams = 0;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) -> Result<void> {
    const Result<std::size_t> count = write_csv(**source, out);
    if (!count) return tl::unexpected(count.error());
    beams = *count;
    return {};
  });
  if (!written) return tl::unexpected(written.error());
  const std::size_t skipped = (*source)->skipped();
  return fmt::format("{} beams{}", beams, skipped > 0 ? fmt::format("; {} damaged ones left out", skipped) : "");
}

Result<std::string> convert_map(const FileBytes& file, const ConvertCommand& command) {
  const Result<MapFile> read = read_map(file);
  if (!read) return tl::unexpected(read.error());
  const Result<void> written = write_map_file(command.output, read->map, command.format, read->made_by);
  if (!written) return tl::unexpected(written.error());
  const MapCounts counts = read->map.counts();
  return fmt::format("{} occupied and {} free cells", counts.occupied_cells, counts.free_cells);
}

}  // namespace

Result<int> run(const ConvertCommand& command, Console& console) {
  Result<FileBytes> file = read_file(command.input);
  if (!file) return tl::unexpected(file.error());
  const Result<Format> format = recognised(*file);
  if (!format) return tl::unexpected(format.error());

  const FormatKind from = kind_of(*format), to = kind_of(command.format);
  const bool log_to_log = from == FormatKind::kBeams && to == FormatKind::kBeams;
  const bool map_to_map = from == FormatKind::kMap && (to == FormatKind::kMap || to == FormatKind::kCloud);
  if (!log_to_log && !map_to_map) return does_not_become(file->name, *format, command.format);

  const Result<std::string> what = log_to_log ? convert_log(std::move(*file), command) : convert_map(*file, command);
  if (!what) return tl::unexpected(what.error());
  const auto told = console.summarise(fmt::format("{}: {}\n", on_one_line(command.output), *what), command.output);
  if (!told) return tl::unexpected(told.error());
  return 0;
}

}  // namespace pingvox::app
