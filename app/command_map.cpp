#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "commands.hpp"
#include "json.hpp"
#include "map_log.hpp"
#include "map_report.hpp"
#include "open_log.hpp"
#include "pingvox/io/file.hpp"
#include "progress.hpp"
#include "write_map_file.hpp"

namespace pingvox::app {
namespace {

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// What all logs together came to.
struct Totals {
  BuildReport report;
  std::size_t scans = 0, points = 0;  ///< of the report's sweeps and beams those that are no beams
  double write_s = 0.0, total_s = 0.0;

  void add(const BuildReport& log, const Log& source) {
    if (std::holds_alternative<std::unique_ptr<ScanSource>>(source)) {
      scans += log.sweeps;
      points += log.beams;
    }
    report.beams += log.beams;
    report.sweeps += log.sweeps;
    report.echoes += log.echoes;
    report.skipped += log.skipped;
    report.outside.count += log.outside.count;
    report.cells_freed += log.cells_freed;
    report.cells_hit += log.cells_hit;
    report.seconds.read += log.seconds.read;
    report.seconds.detect += log.seconds.detect;
    report.seconds.trace += log.seconds.trace;
    report.seconds.apply += log.seconds.apply;
  }
};

std::optional<double> share_read(const Log& log) {
  return std::visit([](const auto& source) { return source->share_read(); }, log);
}

/// Microseconds: what is shorter is noise.
double rounded(double seconds) {
  return std::round(seconds * 1e6) / 1e6;
}

std::string json_of(const Totals& totals, const OccupancyMap& map) {
  const BuildReport& report = totals.report;
  const MapCounts counts = map.counts();
  JsonObject seconds;
  seconds.add("read", rounded(report.seconds.read))
      .add("detect", rounded(report.seconds.detect))
      .add("trace", rounded(report.seconds.trace))
      .add("apply", rounded(report.seconds.apply))
      .add("write", rounded(totals.write_s))
      .add("total", rounded(totals.total_s));
  JsonObject held;
  held.add("resolution", map.lattice().resolution_m())
      .add("depth", map.lattice().depth())
      .add("leaves", counts.leaves)
      .add("inner", counts.inner)
      .add("memory_bytes", map.memory_bytes())
      .add("occupied_cells", counts.occupied_cells)
      .add("free_cells", counts.free_cells)
      .add("bounds", bounds_json(map.bounds()));
  JsonObject json;
  json.add("beams", report.beams)
      .add("sweeps", report.sweeps)
      .add("echoes", report.echoes)
      .add("skipped", report.skipped)
      .add("cells_freed", report.cells_freed)
      .add("cells_hit", report.cells_hit)
      .add("seconds", seconds)
      .add("map", held);
  return json.text() + "\n";
}

std::string text_of(const Totals& totals, const OccupancyMap& map, const std::string& output) {
  const BuildReport& report = totals.report;
  const auto& s = report.seconds;
  std::string read;
  if (const std::size_t beams = report.beams - totals.points; beams > 0) {
    const std::size_t echoes = report.echoes - totals.points;
    read = fmt::format("{} beams, {} complete sweeps, {} echoes", beams, report.sweeps - totals.scans, echoes);
    if (beams > echoes) read += fmt::format(", {} beams without one", beams - echoes);
  }
  if (totals.scans > 0) {
    read += fmt::format("{}{} points in {} scan{}", read.empty() ? "" : ", ", totals.points, totals.scans,
                        totals.scans == 1 ? "" : "s");
  }
  if (report.skipped > 0) read += fmt::format("; {} left out", report.skipped);
  if (report.outside.count > 0) read += fmt::format(", {} of them outside of the map", report.outside.count);
  const std::string name = output == "-" ? "standard output" : on_one_line(output);
  return name + "\n" + report_line("read", read) + map_text(map, map.counts()) +
         report_line("seconds",
                     fmt::format("{:.3f} = {:.3f} read + {:.3f} detect + {:.3f} trace + {:.3f} apply + {:.3f} "
                                 "write + rest",
                                 totals.total_s, s.read, s.detect, s.trace, s.apply, totals.write_s));
}

/// Why a map knows nothing, as far as that can be told.
std::string why_empty(const BuildReport& report, const Lattice& lattice) {
  if (report.outside.count > 0) {
    return fmt::format(
        "{} beams or points lie outside of the map, which with cells of {} m reaches {:.3g} m from its origin: larger "
        "cells (--resolution) reach farther",
        report.outside.count, lattice.resolution_m(), std::ldexp(lattice.resolution_m(), lattice.depth() - 1));
  }
  return "no echoes and no free space in range (--min-range, --max-range, --threshold, --silent)";
}

}  // namespace

Result<int> run(const MapCommand& command, Console& console) {
  const Stopwatch total;
  Result<OccupancyMap> map = OccupancyMap::make(command.map);
  if (!map) return tl::unexpected(map.error());
  const Result<Trajectory> trajectory = trajectory_of(command.poses);
  if (!trajectory) return tl::unexpected(trajectory.error());

  Totals totals;
  {
    ProgressBar bar(command.manner);
    for (std::size_t i = 0; i < command.logs.size(); ++i) {
      const Stopwatch read;
      Result<ByteStream> stream = ByteStream::open(command.logs[i]);
      if (!stream) return tl::unexpected(stream.error());
      const std::string name = stream->name();
      const Result<Log> log = open_log(std::move(*stream), command.damage, command.cloud_origin_m);
      if (!log) return tl::unexpected(log.error());
      totals.report.seconds.read += read.seconds();

      const Progress progress = [&](const BuildReport& done) {
        if (!bar.is_due()) return;
        // Logs count the same: how long the later ones are is not known yet.
        std::optional<double> share = share_read(*log);
        if (share) share = (static_cast<double>(i) + *share) / static_cast<double>(command.logs.size());
        bar.draw(share, fmt::format("{} beams, {:.0f} s, {}", totals.report.beams + done.beams, total.seconds(),
                                    bytes_text(map->memory_bytes())));
      };
      const Result<BuildReport> report = map_log(*log, name, *trajectory, command.build, command.head, *map, progress);
      if (!report) return tl::unexpected(report.error());
      totals.add(*report, *log);
    }
  }

  const Stopwatch write;
  const Result<void> written = write_map_file(command.output, *map, command.format, command.made_by);
  if (!written) return tl::unexpected(written.error());
  totals.write_s = write.seconds();
  totals.total_s = total.seconds();

  const Result<void> told = command.manner.report == Report::kJson
                                ? console.print(json_of(totals, *map))
                                : console.summarise(text_of(totals, *map, command.output), command.output);
  if (!told) return tl::unexpected(told.error());
  if (map->empty()) {
    console.say(fmt::format("{}: nothing was mapped: {}", command.output, why_empty(totals.report, map->lattice())));
  }
  return 0;
}

}  // namespace pingvox::app
