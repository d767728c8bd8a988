// Maps a log of sonar beams, each beam as a cone of the head that the log names, and writes the map in OctoMap's
// format.
//
//   01_map_a_log tank.csv tank.bt
#include <cstdio>
#include <pingvox/io/beams.hpp>
#include <pingvox/io/file.hpp>
#include <pingvox/io/maps.hpp>
#include <pingvox/mapping/build_map.hpp>
#include <string>

using namespace pingvox;

Result<OccupancyMap> map_log(const std::string& path) {
  auto file = read_file(path);
  if (!file) return tl::unexpected(file.error());
  auto beams = open_beams(std::move(*file));
  if (!beams) return tl::unexpected(beams.error());

  OccupancyMap map({.resolution_m = 0.05});
  BuildOptions options;
  options.model = beam_of_head((*beams)->device());
  // The sonar stands still. For one that moves, read_tum reads a Trajectory.
  const auto report = build_map(**beams, Trajectory::still(Pose::Identity()), options, map);
  if (!report) return tl::unexpected(report.error());
  std::printf("%zu beams, %zu echoes\n", report->beams, report->echoes);
  return map;
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "Usage: 01_map_a_log LOG MAP.bt\n");
    return 2;
  }
  const auto map = map_log(argv[1]);
  if (!map) {
    std::fprintf(stderr, "%s\n", map.error().message.c_str());
    return 1;
  }
  const auto written = write_file(argv[2], [&](std::ostream& out) { return write_map(*map, Format::kBt, "", out); });
  if (!written) {
    std::fprintf(stderr, "%s\n", written.error().message.c_str());
    return 1;
  }
}
