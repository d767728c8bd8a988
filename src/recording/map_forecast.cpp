#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "pingvox/map/trace_ray.hpp"
#include "pingvox/mapping/map_resolution.hpp"
#include "pingvox/recording/recording.hpp"
#include "sonar/internal/beams_ahead.hpp"

namespace pingvox {
namespace {

/// Some turns of a head, that a few short pings before a dive do not decide.
constexpr std::size_t kBeamsAhead = 1000;

/// The forecast of one log of beams.
struct LogBeginning {
  double range_m = 0.0;
  std::optional<double> beams;  ///< in all of it; nullopt: its length is unknown
  BeamModelOptions model;
};

std::optional<LogBeginning> look_at(OpenedLog& log, const HeadOptions& head, const BuildOptions& build) {
  auto* const beams = std::get_if<std::unique_ptr<BeamSource>>(&log.log);
  if (beams == nullptr) return std::nullopt;
  auto ahead = std::make_unique<BeamsAhead>(std::move(*beams), kBeamsAhead);
  const BeamsAhead& first = *ahead;
  *beams = std::move(ahead);
  const std::optional<double> range_m = first.usual_range_m();
  if (!range_m) return std::nullopt;
  LogBeginning beginning{.range_m = std::min(*range_m, build.echo.max_range_m),
                         .beams = std::nullopt,
                         .model = head.apply_to(build.model, first.device())};
  const auto count = static_cast<double>(first.count());
  const std::optional<double> share = first.share_read();
  if (first.has_ended()) {
    beginning.beams = count;
  } else if (share && *share > 0.0) {
    beginning.beams = count / *share;
  }
  return beginning;
}

/// Whether none of its beams is refused for its size.
bool can_be_mapped(const LogBeginning& log, double resolution_m) {
  return log.range_m / resolution_m <= kMaxCellsInRay &&
         cells_in_beam(log.model, log.range_m, resolution_m) <= kMaxCellsInBeam;
}

/// How long its beams take when each of them is silent up to its range, and the memory of cells that they can reach
/// in one turn of the head from one place.
MapCost cost_of(const LogBeginning& log, double resolution_m) {
  // Measured: 0.8 and 1.0 ns; 0.3 bytes of one turn, whose free space is joined, 1.3 of many.
  constexpr double kSecondsPerCell = 1.0e-9, kSecondsPerBeam = 3.0e-5, kBytesPerCell = 1.0;
  const double range_cells = log.range_m / resolution_m;
  const double half_height_rad = log.model.shape == BeamShape::kCone ? 0.5 * log.model.height_rad : 0.0;
  constexpr double kFullTurn = 4.0 / 3.0 * std::numbers::pi;
  const double reached =
      kFullTurn * std::pow(range_cells, 3) * std::sin(std::min(half_height_rad, std::numbers::pi / 2)) +
      std::numbers::pi * range_cells * range_cells;
  const double cells = cells_in_beam(log.model, log.range_m, resolution_m), beams = *log.beams;
  return {beams, beams * (kSecondsPerBeam + kSecondsPerCell * cells), kBytesPerCell * std::min(beams * cells, reached)};
}

}  // namespace

Result<MapForecast> forecast_map(const Recording& recording, const MapOptions& map, const BuildOptions& build) {
  MapForecast forecast;
  std::vector<LogBeginning> beginnings;
  for (std::size_t i = 0; i < recording.logs().size(); ++i) {
    const bool is_read_once = recording.logs()[i].is_read_once();
    Result<OpenedLog> log = recording.open_log(i);
    if (!log && is_read_once) return tl::unexpected(log.error());
    if (!log) continue;
    if (const auto beginning = look_at(*log, recording.options().head, build)) beginnings.push_back(*beginning);
    if (is_read_once) forecast.opened.emplace(i, *std::move(log));
  }
  for (const LogBeginning& log : beginnings) {
    if (forecast.range_m && log.range_m <= *forecast.range_m) continue;
    forecast.range_m = log.range_m;
    forecast.beam_width_rad = log.model.width_rad;
  }
  if (map.resolution_m) {
    forecast.resolution_m = *map.resolution_m;
  } else if (forecast.range_m) {
    forecast.resolution_m = resolution_for(*forecast.range_m, forecast.beam_width_rad);
  }
  const bool is_cost_known = std::ranges::all_of(
      beginnings, [&](const LogBeginning& log) { return log.beams && can_be_mapped(log, forecast.resolution_m); });
  if (!beginnings.empty() && is_cost_known) {
    forecast.cost.emplace();
    for (const LogBeginning& log : beginnings) {
      const MapCost cost = cost_of(log, forecast.resolution_m);
      forecast.cost->beams += cost.beams;
      forecast.cost->seconds += cost.seconds;
      forecast.cost->bytes = std::max(forecast.cost->bytes, cost.bytes);
    }
  }
  return forecast;
}

Result<OccupancyMap> make_map(const MapForecast& forecast, MapOptions map) {
  map.resolution_m = forecast.resolution_m;
  return OccupancyMap::make(map);
}

}  // namespace pingvox
