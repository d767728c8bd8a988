// Maps the log of a sonar along the vehicle's navigation, and writes the map in OctoMap's format. Each beam is the cone
// of the head that the log names; how the clocks of the logs are offset is found.
//
//   01_map_a_recording dive.bt dive.bin [dive.tlog ...]
#include <cstdio>
#include <pingvox/io/maps.hpp>
#include <pingvox/recording/recording.hpp>

int report(const pingvox::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "Usage: 01_map_a_recording MAP.bt LOG [NAV ...]\n");
    return 2;
  }
  auto recording = pingvox::Recording::open({argv[2]}, {.nav = {argv + 3, argv + argc}});
  if (!recording) return report(recording.error());
  auto map = pingvox::build_map(*recording, {.resolution_m = 0.1});
  if (!map) return report(map.error());
  std::printf("%zu beams, %zu echoes\n", map->report.beams, map->report.echoes);
  if (auto written = pingvox::write_map(map->map, argv[1]); !written) return report(written.error());
}
