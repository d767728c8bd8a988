// Maps beams as they come and asks the map between them how far it is to the next obstacle ahead. A log stands for the
// device here.
//
//   02_live_beams tank.csv
#include <cstdio>
#include <pingvox/io/beams.hpp>
#include <pingvox/io/file.hpp>
#include <pingvox/map/cast_ray.hpp>
#include <pingvox/mapping/beam_mapper.hpp>
#include <string>

using namespace pingvox;

Result<void> map_live(BeamSource& device, OccupancyMap& map) {
  BuildOptions options;
  options.model = beam_of_head(device.device());
  options.timing = Timing::kByBeam;  // each beam as soon as its neighbours are heard
  options.vote = Vote::kPerBeam;
  auto mapper = BeamMapper::make(options, map);
  if (!mapper) return tl::unexpected(mapper.error());

  const Pose map_from_body = Pose::Identity();  // where the vehicle is now, as its navigation says
  for (std::size_t beams = 1;; ++beams) {
    auto beam = device.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) return mapper->finish();
    if (const auto added = mapper->add(std::move(**beam), map_from_body); !added) return added;

    if (beams % 200 == 0) {
      const RayEnd ahead = cast_ray(map, map_from_body.translation(), map_from_body.linear().col(0), 10.0);
      if (ahead.what == Occupancy::kOccupied) std::printf("beam %zu: obstacle in %.2f m\n", beams, ahead.range_m);
    }
  }
}

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "Usage: 02_live_beams LOG\n");
    return 2;
  }
  OccupancyMap map({.resolution_m = 0.05});
  const auto done = read_file(argv[1])
                        .and_then([](FileBytes bytes) { return open_beams(std::move(bytes)); })
                        .and_then([&](std::unique_ptr<BeamSource> device) { return map_live(*device, map); });
  if (!done) {
    std::fprintf(stderr, "%s\n", done.error().message.c_str());
    return 1;
  }
}
