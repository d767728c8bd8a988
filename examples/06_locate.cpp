// Finds a sonar in a map that is known.
//
//   06_locate tank.bt tank.csv
#include <cstdio>
#include <pingvox/io/file.hpp>
#include <pingvox/io/maps.hpp>
#include <pingvox/recording/recording.hpp>

int report(const pingvox::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "Usage: 06_locate MAP LOG\n");
    return 2;
  }
  auto file = pingvox::read_file(argv[1]);
  if (!file) return report(file.error());
  auto map = pingvox::read_map(*file);
  if (!map) return report(map.error());
  auto recording = pingvox::Recording::open({argv[2]});
  if (!recording) return report(recording.error());
  auto location = pingvox::locate(*recording, map->map);
  if (!location) return report(location.error());
  for (const pingvox::PoseHypothesis& place : location->found.hypotheses) {
    std::printf("x %.2f y %.2f m, yaw %.3f rad, weight %.2f\n", place.x_m, place.y_m, place.yaw_rad, place.weight);
  }
  std::printf("%s\n", location->found.is_sure() ? "sure" : "not sure");
}
