// Estimates where a vehicle was from its sonar and what navigation there is (a velocity and a heading, or a heading
// alone), and maps the recording along that path.
//
//   05_slam dive.bt dive.csv nav.csv
#include <cstdio>
#include <pingvox/io/maps.hpp>
#include <pingvox/recording/recording.hpp>

int report(const pingvox::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "Usage: 05_slam MAP.bt LOG NAV\n");
    return 2;
  }
  auto recording = pingvox::Recording::open({argv[2]}, {.nav = {argv[3]}});
  if (!recording) return report(recording.error());
  auto found = pingvox::slam(*recording);
  if (!found) return report(found.error());
  auto map = pingvox::build_map(*recording, found->path(), {.resolution_m = 0.1});
  if (!map) return report(map.error());
  std::printf("%zu poses, %zu beams in the map\n", found->solution.trajectory.poses().size(), map->report.beams);
  if (auto written = pingvox::write_map(map->map, argv[1]); !written) return report(written.error());
}
