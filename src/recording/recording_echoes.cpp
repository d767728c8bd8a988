#include "recording/recording_echoes.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "pingvox/io/open_log.hpp"
#include "pingvox/sonar/background.hpp"

namespace pingvox {

double RecordingEchoes::tolerance_m() const {
  constexpr double kNear_m = 0.1;
  return std::max(kNear_m, cell_m);
}

Result<RecordingEchoes> recording_echoes(const Recording& recording, const VehiclePath& path, const MapOptions& map,
                                         const BuildOptions& build) {
  Result<MapForecast> forecast = forecast_map(recording, map, build);
  if (!forecast) return tl::unexpected(forecast.error());
  RecordingEchoes read{{}, map, forecast->resolution_m, forecast->beam_width_rad};
  read.map.resolution_m = read.cell_m;
  const RecordingOptions& of = recording.options();
  std::optional<Background> background;
  for (std::size_t i = 0; i < recording.logs().size(); ++i) {
    auto opened = forecast->opened.extract(i);
    Result<OpenedLog> log = opened ? std::move(opened.mapped()) : recording.open_log(i);
    if (!log) return tl::unexpected(log.error());
    if (const auto done = subtract_background(recording, *log, background); !done) return tl::unexpected(done.error());
    const std::string name = log->name;
    Result<std::unique_ptr<BeamSource>> beams = only_beams(std::move(log->log), name);
    if (!beams) return tl::unexpected(beams.error());
    if (path.nav) {
      if (const auto has = check_has_times(**beams, name); !has) return tl::unexpected(has.error());
    }
    BuildOptions options = build;
    options.model = of.head.apply_to(build.model, (*beams)->device());
    options.body_from_sensor = of.body_from_sonar;
    options.body_from_sensor.pretranslate(path.sonar_moved_m);
    if (recording.water()) options.sound_speed_ratio = sound_speed_ratio(*recording.water());
    if (const auto added = read.echoes.add(**beams, options); !added) return tl::unexpected(added.error());
  }
  return read;
}

}  // namespace pingvox
