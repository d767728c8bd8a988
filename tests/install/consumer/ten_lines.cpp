// The whole program in ten lines, as the documentation has it.
#include <cstdio>
#include <pingvox/io/maps.hpp>
#include <pingvox/recording/recording.hpp>

namespace {
int report(const pingvox::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

int map_dive() {
  auto recording = pingvox::Recording::open({"dive.bin"}, {.nav = {"dive.tlog"}});
  if (!recording) return report(recording.error());
  auto map = pingvox::build_map(*recording, {.resolution_m = 0.1});  // the head's own beam, the path that was found
  if (!map) return report(map.error());
  return pingvox::write_map(map->map, "dive.bt") ? 0 : 1;
}
}  // namespace

int main() {
  return map_dive();
}
