// Finds a sonar in a map that is known, beam by beam.
//
//   05_locate tank.csv tank.bt
#include <cstdio>
#include <pingvox/io/beams.hpp>
#include <pingvox/io/file.hpp>
#include <pingvox/io/maps.hpp>
#include <pingvox/slam/localizer.hpp>
#include <utility>

using namespace pingvox;

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "Usage: 05_locate LOG MAP\n");
    return 2;
  }
  const auto file = read_file(argv[2]);
  const auto read = file.and_then([](const FileBytes& bytes) { return read_map(bytes); });
  if (!read) {
    std::fprintf(stderr, "%s\n", read.error().message.c_str());
    return 1;
  }
  const auto field = DistanceField::make(read->map, {});
  if (!field) {
    std::fprintf(stderr, "%s\n", field.error().message.c_str());
    return 1;
  }
  const auto log = read_file(argv[1]).and_then([](FileBytes bytes) { return open_beams(std::move(bytes)); });
  if (!log) {
    std::fprintf(stderr, "%s\n", log.error().message.c_str());
    return 1;
  }

  Localizer localizer(*field, {});
  for (;;) {
    auto beam = (*log)->next();
    if (!beam || !*beam) break;
    // A vehicle that moves adds its odometry before each beam: localizer.add(StampedPose{time_s, odom_from_body}).
    if (!localizer.add(**beam)) break;
  }
  localizer.finish();
  for (const PoseHypothesis& place : localizer.hypotheses()) {
    std::printf("x %.2f y %.2f m, yaw %.3f rad, weight %.2f\n", place.x_m, place.y_m, place.yaw_rad, place.weight);
  }
  std::printf("%s\n", localizer.is_sure() ? "sure" : "not sure");
}
