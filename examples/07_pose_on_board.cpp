// Tells where a vehicle is while its sonar and its navigation report. Logs stand for the devices here.
//
//   07_pose_on_board dive.csv nav.csv
#include <cstdio>
#include <pingvox/io/beams.hpp>
#include <pingvox/io/file.hpp>
#include <pingvox/io/nav.hpp>
#include <pingvox/slam/causal_slam.hpp>
#include <utility>
#include <vector>

using namespace pingvox;

// What the sources say until a time.
Result<void> add_until(double time_s, const NavLog& nav, std::vector<std::size_t>& added, CausalSlam& slam) {
  for (std::size_t s = 0; s < nav.sources().size(); ++s) {
    const NavSource& source = nav.sources()[s];
    for (; added[s] < source.samples.size() && source.samples[added[s]].time_s <= time_s; ++added[s]) {
      const auto done = slam.add(source.name, source.quantity, source.samples[added[s]]);
      if (!done) return done;
    }
  }
  return {};
}

Result<void> dive(BeamSource& sonar, const NavLog& nav) {
  CausalSlam slam({});
  std::vector<std::size_t> added(nav.sources().size(), 0);
  for (std::size_t beams = 1;; ++beams) {
    const auto beam = sonar.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) break;
    if (const auto done = add_until((*beam)->time_s, nav, added, slam); !done) return done;
    if (const auto done = slam.add(**beam); !done) return done;
    if (beams % 400 != 0) continue;
    const auto pose = slam.pose();
    if (!pose) continue;
    const Eigen::Vector3d place = pose->map_from_body.translation();
    std::printf("%.1f s: x %.2f y %.2f z %.2f m\n", pose->time_s, place.x(), place.y(), place.z());
  }
  const auto solution = slam.finish();
  if (!solution) return tl::unexpected(solution.error());
  std::printf("%zu poses\n", solution->trajectory.poses().size());
  return {};
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "Usage: 07_pose_on_board LOG NAV\n");
    return 2;
  }
  const auto done = [&]() -> Result<void> {
    const auto sonar = read_file(argv[1]).and_then([](FileBytes bytes) { return open_beams(std::move(bytes)); });
    if (!sonar) return tl::unexpected(sonar.error());
    const auto nav = read_file(argv[2]).and_then([](const FileBytes& bytes) { return read_nav(bytes); });
    if (!nav) return tl::unexpected(nav.error());
    if (const auto checked = check_sources(nav->log); !checked) return checked;
    return dive(**sonar, nav->log);
  }();
  if (!done) {
    std::fprintf(stderr, "%s\n", done.error().message.c_str());
    return 1;
  }
}
