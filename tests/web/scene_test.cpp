#include "pingvox/web/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "page_columns.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "pingvox/web/scene_bytes.hpp"
#include "recording/dive.hpp"
#include "sonar/internal/echo_stream.hpp"
#include "support/logs.hpp"

namespace pingvox::web {
namespace {

using Bins = std::vector<std::uint8_t>;

TEST(Scene, joinsBinsByTheirMaximum) {
  const Bins bins = {1, 9, 3, 4, 7};
  EXPECT_EQ(join_bins(bins, 1), bins);
  EXPECT_EQ(join_bins(bins, 2), (Bins{9, 4, 7}));
  EXPECT_EQ(join_bins(bins, 5), (Bins{9}));
  EXPECT_EQ(join_bins(bins, 100), (Bins{9}));
  EXPECT_EQ(join_bins({}, 3), Bins{});
}

TEST(Scene, reducedLogsKeepTheirRangesAndLoudestBins) {
  SceneLog log;
  log.beams = {{.bin_length_m = 0.1}, {.bin_length_m = 0.2}};
  log.bins = 3;
  log.intensities = {0, 17, 255, 16, 1, 250};
  const SceneLog less = reduced(log, 2, 16);
  EXPECT_EQ(less.bins, 2U);
  EXPECT_EQ(less.intensities, (Bins{32, 255, 16, 255}));
  EXPECT_DOUBLE_EQ(less.beams[1].bin_length_m, 0.4);
  EXPECT_EQ(reduced(log, 1, 1).intensities, log.intensities);
}

TEST(Scene, takesFilesByTheirContent) {
  Scene scene;
  OccupancyMap map;
  map.edit().update(Key{32768, 32768, 32768}, LogOdds::from_probability(0.9));
  std::ostringstream bytes;
  ASSERT_TRUE(write_map(map, Format::kPvx, "", bytes, MapAxes::kEastNorth));
  const auto add = [&](const std::string& name, const std::string& content) {
    return add_file({name, bytes_of(content)}, {}, Damage::kSkip, scene);
  };
  ASSERT_TRUE(add("folder/a.pvx", bytes.str()));
  ASSERT_TRUE(add("b.tum", "0 1 2 3 0 0 0 1\n1 2 2 3 0 0 0 1\n"));
  ASSERT_TRUE(add("c.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
  ASSERT_TRUE(add("d.ply",
                  "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                  "property float z\nend_header\n1 2 3\n4 5 6\n"));
  ASSERT_EQ(scene.maps.size(), 2U);
  EXPECT_EQ(scene.maps[0].name, "a.pvx");
  EXPECT_EQ(scene.maps[0].axes, MapAxes::kEastNorth);
  EXPECT_GT(scene.maps[1].map.counts().occupied_cells, 100U);
  ASSERT_EQ(scene.paths.size(), 1U);
  EXPECT_EQ(scene.paths[0].trajectory.poses().size(), 2U);
  ASSERT_EQ(scene.points.size(), 1U);
  EXPECT_EQ(scene.points[0].points_m.size(), 2U);
  const std::string json = scene_json(scene);
  for (const char* part : {"\"x\": \"east\"", "\"map/1/cells\"", "\"path/0\"", "\"points/0\"", "\"clock\": \"log\"",
                           "\"format\": \"off\"", "\"agreement\": null"}) {
    EXPECT_NE(json.find(part), std::string::npos) << part << " in " << json;
  }
  EXPECT_EQ(add("e.txt", "hello").error().code, Error::Code::kUnsupported);
  EXPECT_EQ(add("f.pvx", bytes.str().substr(0, bytes.str().size() - 5)).error().code, Error::Code::kCorrupt);
}

TEST(Scene, hasTheBeamsOfADiveWithTheEchoesThatAreMapped) {
  const test::Dive dive = test::harbour_dive();
  RecordingOptions options;
  options.nav = {dive.nav};
  options.nav_offset_s = 0.0;
  options.body_from_sonar = pose_from_rpy({0.3, 0.1, -0.2}, 0.0, 0.0, 0.5);
  const Result<Recording> recording = Recording::open({dive.log}, options);
  ASSERT_TRUE(recording) << recording.error().message;
  const Result<VehiclePath> path = recording->path();
  ASSERT_TRUE(path) << path.error().message;
  BuildOptions build;
  build.sound_speed_ratio = 0.98;
  Scene scene;
  const Result<void> added = add_recording(*recording, *path, build, scene);
  ASSERT_TRUE(added) << added.error().message;

  // The echoes that live mapping detects beam by beam.
  EchoStream stream(build.filter, build.echo);
  std::vector<EchoStream::BeamWithEcho> expected;
  Result<OpenedLog> log = recording->open_log(0);
  ASSERT_TRUE(log);
  Result<std::vector<Beam>> beams = read_all(*log->beams());
  ASSERT_TRUE(beams);
  for (Beam beam : *beams) {
    beam.bin_length_m *= 0.98;
    for (auto& done : stream.add(std::move(beam))) expected.push_back(std::move(done));
  }
  for (auto& done : stream.finish()) expected.push_back(std::move(done));
  std::ranges::sort(expected, {}, &EchoStream::BeamWithEcho::number);

  ASSERT_EQ(scene.paths.size(), 1U);
  ASSERT_EQ(scene.logs.size(), 1U);
  const SceneLog& shown = scene.logs[0];
  EXPECT_EQ(shown.path, 0U);
  EXPECT_TRUE(shown.body_from_sonar.isApprox(options.body_from_sonar));
  ASSERT_EQ(shown.beams.size(), expected.size());
  ASSERT_EQ(shown.bins, 200U);
  std::size_t echoes = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const SceneBeam& beam = shown.beams[i];
    EXPECT_EQ(beam.time_s, expected[i].beam.time_s);
    EXPECT_EQ(beam.bearing_rad, expected[i].beam.bearing_rad);
    EXPECT_EQ(beam.bin_length_m, expected[i].beam.bin_length_m);
    EXPECT_TRUE(std::ranges::equal(shown.row(i), expected[i].beam.intensities));
    ASSERT_EQ(beam.echo_m.has_value(), expected[i].echo.has_value()) << i;
    EXPECT_EQ(beam.threshold.has_value(), beam.echo_m.has_value());
    if (!beam.echo_m) continue;
    ++echoes;
    EXPECT_EQ(*beam.echo_m, expected[i].echo->range_m);
    EXPECT_EQ(beam.echo_probability, evidence_of_intensity(expected[i].echo->intensity, build.model.hit).probability());
  }
  EXPECT_GT(echoes, 200U);
  EXPECT_EQ(shown.beams.front().sweep, 0U);
  EXPECT_GT(shown.beams.back().sweep, 3U);
}

TEST(Scene, tellsTheLevelOfALevelDetectorForEachBeam) {
  const test::Dive dive = test::harbour_dive();
  const Result<Recording> recording = Recording::open({dive.log});
  ASSERT_TRUE(recording) << recording.error().message;
  BuildOptions build;
  build.echo.detector = Detector::kLevel;
  build.echo.threshold = 90;
  Scene scene;
  ASSERT_TRUE(add_recording(*recording, still_path(), build, scene));
  EXPECT_TRUE(scene.paths.empty()) << "a vehicle that stands still has no path";
  EXPECT_EQ(scene.logs.at(0).path, std::nullopt);
  for (const SceneBeam& beam : scene.logs[0].beams) EXPECT_EQ(beam.threshold, 90.0);
}

TEST(Scene, joinsTheBinsOfLongBeamsAndPadsShortOnes) {
  // 1200 bins are joined by three, 100 stay as they are.
  std::ostringstream out;
  std::vector<Beam> beams;
  for (const std::size_t bins : {std::size_t{1200}, std::size_t{100}}) {
    Beam beam{.time_s = static_cast<double>(beams.size()),
              .bearing_rad = 0.0,
              .bin_length_m = 0.01,
              .intensities = std::vector<std::uint8_t>(bins, 5)};
    beam.intensities[bins - 1] = 200;
    beams.push_back(std::move(beam));
  }
  BeamsInMemory source(beams);
  ASSERT_TRUE(write_csv(source, out));
  const Result<Recording> recording = Recording::open({FileBytes{"long.csv", bytes_of(out.str())}});
  ASSERT_TRUE(recording) << recording.error().message;
  Scene scene;
  ASSERT_TRUE(add_recording(*recording, still_path(), {}, scene));
  const SceneLog& log = scene.logs.at(0);
  ASSERT_EQ(log.bins, 400U);
  EXPECT_DOUBLE_EQ(log.beams[0].bin_length_m, 0.03);
  EXPECT_EQ(log.row(0)[399], 200);
  EXPECT_EQ(log.row(0)[398], 5);
  EXPECT_DOUBLE_EQ(log.beams[1].bin_length_m, 0.01);
  EXPECT_EQ(log.row(1)[99], 200);
  EXPECT_EQ(log.row(1)[100], 0);
}

}  // namespace
}  // namespace pingvox::web
