// Estimates where a vehicle is while it dives, and corrects its map as often as the estimate changes. Logs stand for
// the devices here.
//
//   06_map_of_slam dive.csv nav.csv dive.bt
#include <cstdio>
#include <optional>
#include <pingvox/io/beams.hpp>
#include <pingvox/io/file.hpp>
#include <pingvox/io/maps.hpp>
#include <pingvox/io/nav.hpp>
#include <pingvox/mapping/rebuilt_map.hpp>
#include <pingvox/slam/slam_smoother.hpp>
#include <utility>

using namespace pingvox;

Result<void> dive(BeamSource& sonar, const NavLog& nav, RebuiltMap& map) {
  SlamSmoother smoother({});
  if (const auto added = smoother.add(nav); !added) return added;
  for (std::size_t beams = 0;;) {
    const auto beam = sonar.next();
    if (!beam) return tl::unexpected(beam.error());
    const bool is_end = !*beam;
    if (!is_end) {
      ++beams;
      smoother.add(**beam);
      if (const auto added = map.add(**beam, std::nullopt); !added)
        return added;  // its pose comes with the next solution
    }
    if (!is_end && beams % 800 != 0) continue;
    if (is_end) {
      if (const auto finished = map.finish(); !finished) return finished;
    }
    const auto solution = smoother.solve();
    if (!solution) return tl::unexpected(solution.error());
    if (const auto corrected = map.correct(solution->trajectory); !corrected) return corrected;
    // A vehicle goes on with the next beam: the map is rebuilt by a thread, and replaced by `add` or `update`.
    if (const auto rebuilt = map.wait(); !rebuilt) return rebuilt;
    std::printf("%zu beams: %zu in the map\n", beams, map.report().beams);
    if (is_end) return {};
  }
}

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "Usage: 06_map_of_slam LOG NAV MAP.bt\n");
    return 2;
  }
  const auto done = [&]() -> Result<void> {
    const auto sonar = read_file(argv[1]).and_then([](FileBytes bytes) { return open_beams(std::move(bytes)); });
    if (!sonar) return tl::unexpected(sonar.error());
    const auto nav = read_file(argv[2]).and_then([](const FileBytes& bytes) { return read_nav(bytes); });
    if (!nav) return tl::unexpected(nav.error());
    BuildOptions options;
    options.model = beam_of_head((*sonar)->device());
    auto map = RebuiltMap::make(options, {.resolution_m = 0.1});
    if (!map) return tl::unexpected(map.error());
    if (const auto dived = dive(**sonar, nav->log, *map); !dived) return dived;
    return write_file(argv[3], [&](std::ostream& out) { return write_map(map->map(), Format::kBt, "", out); });
  }();
  if (!done) {
    std::fprintf(stderr, "%s\n", done.error().message.c_str());
    return 1;
  }
}
