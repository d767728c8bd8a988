#include "recording/recording_echoes.hpp"

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "pingvox/io/open_log.hpp"
#include "pingvox/sonar/background.hpp"

namespace pingvox {

Result<HeldOutEchoes> recording_echoes(const Recording& recording, const VehiclePath& path, const BuildOptions& build,
                                       MapForecast& forecast) {
  const RecordingOptions& of = recording.options();
  HeldOutEchoes echoes;
  std::optional<Background> background;
  for (std::size_t i = 0; i < recording.logs().size(); ++i) {
    auto opened = forecast.opened.extract(i);
    Result<OpenedLog> log = opened ? std::move(opened.mapped()) : recording.open_log(i);
    if (!log) return tl::unexpected(log.error());
    if (log->beams() != nullptr) {
      if (const auto done = subtract_background(recording, *log, background); !done) {
        return tl::unexpected(done.error());
      }
    }
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
    if (const auto added = echoes.add(**beams, options); !added) return tl::unexpected(added.error());
  }
  return echoes;
}

}  // namespace pingvox
