#include "live/open_mapper.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "live/live_slam.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/mapping/beam_mapper.hpp"
#include "pingvox/mapping/map_resolution.hpp"
#include "pingvox/recording/recording.hpp"

namespace pingvox {
namespace {

Result<LiveSlam> slam_of(const LiveOptions& options, const BuildOptions& build, const MapOptions& map_options) {
  const std::size_t devices = options.nav.size();
  if (!options.known_map) return LiveSlam::make(*options.slam, devices, build, map_options);
  const LiveKnownMap& known = *options.known_map;
  return read_file(known.file)
      .and_then([&](const FileBytes& file) { return read_map(file, map_options.memory_limit_bytes); })
      .and_then([&](MapFile file) {
        return LiveSlam::make(*options.slam, devices, build,
                              LiveSlam::KnownMap{std::move(file.map), known.file, known.start});
      });
}

}  // namespace

double resolution_of(const LiveOptions& options, const BuildOptions& build) {
  const LiveHead& head = options.head;
  if (options.map.resolution_m) return *options.map.resolution_m;
  if (head.kind != LiveHead::Kind::kReplay) {
    const double range_m = head.kind == LiveHead::Kind::kMicron ? head.micron.range_m : head.ping360.range_m;
    return resolution_for(std::min(range_m, build.echo.max_range_m), build.model.width_rad);
  }
  InputFile log(head.address);
  if (log.is_read_once()) return MapOptions::kDefaultResolution_m;
  const MapForecast forecast =
      Recording::open({std::move(log)}, {.head = options.beam})
          .and_then([&](const Recording& recording) { return forecast_map(recording, options.map, build); })
          .value_or(MapForecast{});
  return forecast.resolution_m;
}

Result<MapperAndMap> open_mapper(const LiveOptions& options, const BuildOptions& build, const MapOptions& map_options) {
  if (options.slam) {
    return slam_of(options, build, map_options).map([](LiveSlam slam) {
      return MapperAndMap{std::move(slam), nullptr};
    });
  }
  Result<OccupancyMap> made = OccupancyMap::make(map_options);
  if (!made) return tl::unexpected(made.error());
  auto map = std::make_unique<OccupancyMap>(*std::move(made));
  return BeamMapper::make(build, *map, CountSweeps::kYes).map([&](BeamMapper mapper) {
    return MapperAndMap{std::move(mapper), std::move(map)};
  });
}

}  // namespace pingvox
