// Clouds and meshes that become maps, and maps that become clouds, grids and heights.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "call.hpp"
#include "json_reader.hpp"

namespace pingvox::test {
namespace {

using ::testing::HasSubstr;
using Words = std::vector<std::string>;

FlatJson info(const Workplace& here, const std::string& file) {
  const Outcome outcome = here.call({"info", file, "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return flat_json(outcome.out).value_or(FlatJson{});
}

void expect_done(const Workplace& here, const Words& words) {
  const Outcome outcome = here.call(words);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

/// The same points, seen from 0.5, -0.25, 1: coordinates that every kind of number holds.
constexpr const char* kPoints = "1 2 3\n-4.5 0.25 6\n2.75 -3.5 0.5\n";
constexpr const char* kPointsFromOrigin = "0.5 2.25 2\n-5 0.5 5\n2.25 -3.25 -0.5\n";

void write_clouds(const Workplace& here) {
  here.write("scan.log", std::string("NODE 0.5 -0.25 1 0 0 0\n") + kPointsFromOrigin);
  here.write("a.xyz", kPoints);
  here.write("a.ply", std::string("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                  "property float z\nend_header\n") +
                          kPoints);
  here.write("a.pcd", std::string("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\n"
                                  "VIEWPOINT 0.5 -0.25 1 1 0 0 0\nPOINTS 3\nDATA ascii\n") +
                          kPoints);
}

TEST(Clouds, BecomeTheMapOfTheSameScan) {
  const Workplace here;
  write_clouds(here);
  expect_done(here, {"map", "scan.log", "-o", "scan.ot"});
  expect_done(here, {"map", "a.pcd", "-o", "pcd.ot"});
  expect_done(here, {"map", "a.ply", "-o", "ply.ot", "--origin", "0.5,-0.25,1"});
  expect_done(here, {"map", "a.xyz", "-o", "xyz.ot", "--origin", "0.5,-0.25,1"});
  for (const char* const map : {"pcd.ot", "ply.ot", "xyz.ot"}) EXPECT_EQ(here.read(map), here.read("scan.ot")) << map;
  expect_done(here, {"map", "a.xyz", "-o", "zero.ot"});
  EXPECT_NE(here.read("zero.ot"), here.read("scan.ot")) << "seen from 0, 0, 0";
}

TEST(Clouds, AreAScanEach) {
  const Workplace here;
  write_clouds(here);
  const Outcome outcome = here.call({"map", "a.xyz", "a.pcd", "a.ply", "-o", "all.bt", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = flat_json(outcome.out);
  ASSERT_TRUE(json);
  EXPECT_EQ(json->at("sweeps"), "3");
  EXPECT_EQ(json->at("echoes"), "9");
}

TEST(Clouds, AreCountedAsPointsAndNotAsBeams) {
  const Workplace here;
  write_clouds(here);
  EXPECT_THAT(here.call({"map", "a.xyz", "a.pcd", "-o", "all.bt"}).out, HasSubstr("  6 points in 2 scans\n"));
  EXPECT_THAT(here.call({"map", "a.xyz", "-o", "all.bt", "--max-range", "0.1"}).out,
              HasSubstr("  3 points in 1 scan\n"))
      << "points have no blanking range";
}

TEST(Clouds, AreToldByInfo) {
  const Workplace here;
  write_clouds(here);
  const FlatJson json = info(here, "a.pcd");
  EXPECT_EQ(json.at("kind"), "\"cloud\"");
  EXPECT_EQ(json.at("format"), "\"pcd\"");
  EXPECT_EQ(json.at("points"), "3");
  EXPECT_EQ(json.at("origin"), "[0.5, -0.25, 1]");
  EXPECT_EQ(json.at("bounds.min"), "[-4.5, -3.5, 0.5]");
  EXPECT_EQ(json.at("skipped"), "0");
  EXPECT_EQ(json.size(), 7U);
  EXPECT_THAT(here.call({"info", "a.xyz"}).out, HasSubstr("a cloud of points (.xyz)"));
}

TEST(Clouds, OfAMapAreReadAgain) {
  const Workplace here;
  here.simulate_tank();
  expect_done(here, {"map", "tank.csv", "-o", "tank.ot"});
  expect_done(here, {"convert", "tank.ot", "-o", "tank.pcd"});
  expect_done(here, {"convert", "tank.ot", "-o", "tank.ply"});
  expect_done(here, {"map", "tank.csv", "-o", "direct.pcd"});
  EXPECT_EQ(here.read("direct.pcd"), here.read("tank.pcd"));
  const std::string points = info(here, "tank.ply").at("points");
  EXPECT_EQ(info(here, "tank.pcd").at("points"), points);
  EXPECT_THAT(here.call({"convert", "tank.ot", "-o", "tank.ply"}).out,
              HasSubstr("tank.ply: " + points + " points for "));
  EXPECT_EQ(info(here, "tank.pcd").at("bounds.max"), info(here, "tank.ply").at("bounds.max"));
}

// Kills points in the frame of their scan: a map of the cloud has other cells then.
TEST(Clouds, OfScansHaveTheirPoints) {
  const Workplace here;
  here.write("scans.log",
             "NODE 1 0 0 0 0 0\n1 0 0\n2 0.5 0\n\n"
             "NODE 0 3 0.5 0 0 0\n0 4 0\n");
  const Outcome written = here.call({"convert", "scans.log", "-o", "scans.ply"});
  EXPECT_EQ(written.status, 0) << written.err;
  EXPECT_EQ(written.out, "scans.ply: 3 points\n");
  expect_done(here, {"convert", "scans.log", "-o", "scans.xyz"});
  for (const char* cloud : {"scans.ply", "scans.xyz"}) {
    EXPECT_EQ(info(here, cloud).at("bounds.min"), "[0, 0, 0]");
    EXPECT_EQ(info(here, cloud).at("bounds.max"), "[3, 7, 0.5]");
  }
  expect_error(here.call({"convert", "scans.log", "-o", "scans.csv"}), 2, {"scans.log", ".ply, .pcd and .xyz"});
  expect_error(here.call({"convert", "scans.log", "-o", "scans.bt"}), 2, {"scans.log", "'pingvox map'"});
}

TEST(Meshes, BecomeTheMapOfTheirSurface) {
  const Workplace here;
  expect_done(here, {"simulate", "tank", "-o", "tank.csv", "--truth", "truth", "--resolution", "0.1", "--quiet",
                     "--turns", "1"});
  const FlatJson mesh = info(here, "truth/world.ply");
  EXPECT_EQ(mesh.at("kind"), "\"mesh\"");
  EXPECT_EQ(mesh.at("format"), "\"ply\"");
  EXPECT_EQ(mesh.count("vertices") + mesh.count("triangles") + mesh.count("bounds.min") + mesh.count("bounds.max"), 4U);
  EXPECT_EQ(mesh.size(), 6U);

  expect_done(here, {"convert", "truth/world.ply", "-o", "walls.ot", "--resolution", "0.1"});
  const FlatJson walls = info(here, "walls.ot"), truth = info(here, "truth/world.bt");
  EXPECT_EQ(walls.at("occupied_cells"), truth.at("occupied_cells")) << "the simulator's own map of the same triangles";
  EXPECT_EQ(walls.at("free_cells"), "0");
  expect_done(here, {"convert", "truth/world.ply", "-o", "coarse.pvx", "--resolution", "0.2"});
  EXPECT_EQ(info(here, "coarse.pvx").at("resolution"), "0.2");
}

TEST(Thresholds, ChangeWhatCountsAsOccupiedAndAsFree) {
  const Workplace here;
  here.simulate_tank();
  expect_done(here, {"map", "tank.csv", "-o", "tank.pvx"});
  expect_done(here, {"map", "tank.csv", "-o", "strict.pvx", "--occupied", "0.7", "--free", "0.2"});
  const FlatJson plain = info(here, "tank.pvx"), strict = info(here, "strict.pvx");
  EXPECT_LT(std::stoull(strict.at("occupied_cells")), std::stoull(plain.at("occupied_cells")));
  EXPECT_LT(std::stoull(strict.at("free_cells")), std::stoull(plain.at("free_cells")));
  EXPECT_EQ(here.call({"compare", "tank.pvx", "strict.pvx"}).status, 0) << "the beliefs are the same";

  expect_done(here, {"convert", "tank.pvx", "-o", "judged.pvx", "--occupied", "0.7", "--free", "0.2"});
  EXPECT_EQ(info(here, "judged.pvx").at("occupied_cells"), strict.at("occupied_cells"));
  EXPECT_EQ(info(here, "judged.pvx").at("free_cells"), strict.at("free_cells"));
  expect_done(here, {"convert", "tank.pvx", "-o", "strict.bt", "--occupied", "0.7", "--free", "0.2"});
  EXPECT_EQ(info(here, "strict.bt").at("occupied_cells"), strict.at("occupied_cells"));
  EXPECT_EQ(info(here, "strict.bt").at("free_cells"), strict.at("free_cells"));
}

TEST(CutDepth, GivesTheSameMapWhenWrittenAndWhenConverted) {
  const Workplace here;
  here.simulate_tank();
  expect_done(here, {"map", "tank.csv", "-o", "tank.ot"});
  expect_done(here, {"map", "tank.csv", "-o", "cut.ot", "--cut-depth", "14"});
  expect_done(here, {"convert", "tank.ot", "-o", "converted.ot", "--cut-depth", "14"});
  EXPECT_EQ(here.read("converted.ot"), here.read("cut.ot"));
  EXPECT_LT(std::stoull(info(here, "cut.ot").at("leaves")), std::stoull(info(here, "tank.ot").at("leaves")));
  EXPECT_EQ(std::stoull(info(here, "cut.ot").at("occupied_cells")) % 64, 0U) << "in cells of the finest resolution";
  expect_error(here.call({"convert", "tank.ot", "-o", "a.bt", "--cut-depth", "17"}), 2,
               {"tank.ot", "--cut-depth: must be in 1..16"});
  expect_done(here, {"render", "tank.ot", "-o", "coarse.png", "--cut-depth", "13", "--occupied", "0.6"});
}

TEST(Grids, AreAPictureAndItsYamlWhicheverIsNamed) {
  const Workplace here;
  here.simulate_tank();
  expect_done(here, {"map", "tank.csv", "-o", "tank.ot", "--beam", "cone"});
  expect_done(here, {"convert", "tank.ot", "-o", "a.yaml", "--z", "0"});
  expect_done(here, {"convert", "tank.ot", "-o", "b.pgm", "--min-z", "0", "--max-z", "0.05"});
  expect_done(here, {"convert", "tank.ot", "-o", "c", "--format", "yaml", "--z", "0.01"});
  const std::string picture = here.read("a.pgm");
  EXPECT_EQ(here.read("b.pgm"), picture);
  EXPECT_EQ(here.read("c.pgm"), picture);
  for (const char value : {'\0', '\xfe', '\xcd'}) EXPECT_NE(picture.find(value), std::string::npos);
  EXPECT_THAT(here.read("a.yaml"), ::testing::StartsWith("image: a.pgm\n"));
  EXPECT_THAT(here.read("b.yaml"), HasSubstr("image: b.pgm\n"));
  expect_done(here, {"convert", "tank.ot", "-o", "all.pgm"});
  EXPECT_NE(here.read("all.pgm"), picture);
}

TEST(Grids, ThatCannotBeMadeLeaveTheOldFiles) {
  const Workplace here;
  here.simulate_tank();
  expect_done(here, {"map", "tank.csv", "-o", "tank.ot"});
  here.write("grid.pgm", "old");
  here.write("grid.yaml", "old");
  const auto files_before = here.files();
  expect_error(here.call({"convert", "tank.ot", "-o", "grid.yaml", "--z", "50"}), 1, {"tank.ot", "nothing is known"});
  expect_error(here.call({"convert", "tank.ot", "-o", "grid.yaml"}, {.file_bytes = 100}), 1, {"grid.pgm"});
  EXPECT_EQ(here.read("grid.pgm"), "old");
  EXPECT_EQ(here.read("grid.yaml"), "old");
  EXPECT_EQ(here.files(), files_before);
}

TEST(Heights, AreThoseOfTheSurfaceAskedFor) {
  const Workplace here;
  // Two plates, one above the other, and nothing beside them.
  here.write("plates.off",
             "OFF 8 2 0\n0.1 0.1 0.5\n1.9 0.1 0.5\n1.9 0.9 0.5\n0.1 0.9 0.5\n"
             "0.1 0.1 2.5\n0.9 0.1 2.5\n0.9 0.9 2.5\n0.1 0.9 2.5\n4 0 1 2 3\n4 4 5 6 7\n");
  expect_done(here, {"convert", "plates.off", "-o", "plates.bt", "--resolution", "1"});
  const std::string head = "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n";
  expect_done(here, {"convert", "plates.bt", "-o", "high.asc"});
  EXPECT_EQ(here.read("high.asc"), head + "3 1\n");
  expect_done(here, {"convert", "plates.bt", "-o", "low.asc", "--height", "lowest"});
  EXPECT_EQ(here.read("low.asc"), head + "1 1\n");
  EXPECT_EQ(here.call({"convert", "plates.off", "-o", "-", "--format", "asc", "--resolution", "1"}).out,
            head + "3 1\n");
  expect_done(here, {"convert", "plates.bt", "-o", "above.asc", "--min-z", "1"});
  EXPECT_THAT(here.read("above.asc"), HasSubstr("ncols 1\n"));
}

TEST(Convert, SaysWhatDoesNotBecomeWhat) {
  const Workplace here;
  write_clouds(here);
  here.simulate_tank();
  here.write("hull.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  expect_error(here.call({"convert", "a.ply", "-o", "a.bt"}), 2, {"a.ply", "a cloud", "pingvox map"});
  expect_error(here.call({"convert", "tank.csv", "-o", "a.yaml"}), 2, {"tank.csv", "pingvox map"});
  expect_error(here.call({"convert", "hull.off", "-o", "a.csv"}), 2, {"hull.off", "a mesh"});
  expect_error(here.call({"map", "hull.off", "-o", "a.bt"}), 1, {"hull.off", "a mesh", "pingvox convert"});
  expect_error(here.call({"convert", "tank.csv", "-o", "b.csv", "--resolution", "1"}), 2, {"only on meshes"});
  expect_error(here.call({"convert", "hull.off", "-o", "a.bt", "--resolution", "1e-6"}), 1, {"hull.off"});
}

TEST(Recordings, OfAMapHaveItsPathAndBeams) {
  const Workplace here;
  here.simulate_tank();
  expect_done(here, {"map", "tank.csv", "-o", "tank.ot"});
  here.write("dive.tum", "0.5 1.5 -2.25 -3 0 0 0 1\n1.5 2.5 -2.25 -3 0 0 0 1\n");
  for (const char* const messages : {"foxglove", "ros2"}) {
    const Outcome written = here.call(
        {"convert", "tank.ot", "-o", "tank.mcap", "--messages", messages, "--path", "dive.tum", "--beams", "tank.csv"});
    ASSERT_EQ(written.status, 0) << written.err;
    EXPECT_THAT(written.out, HasSubstr(", 2 poses, " + info(here, "tank.csv").at("beams") + " beams\n"));
    EXPECT_EQ(here.read("tank.mcap").substr(1, 5), "MCAP0");
  }
}

TEST(Recordings, AreRefusedWhereTheyMakeNoSense) {
  const Workplace here;
  here.simulate_tank();
  expect_done(here, {"map", "tank.csv", "-o", "tank.ot"});
  here.write("early.tum", "-0.5 1.5 -2.25 -3 0 0 0 1\n");
  expect_error(here.call({"convert", "tank.ot", "-o", "t.mcap", "--path", "early.tum"}), 1, {"tank.ot", "-0.5 s"});
  expect_error(here.call({"convert", "tank.ot", "-o", "t.mcap", "--path", "tank.csv"}), 1, {"tank.csv"});
  expect_error(here.call({"convert", "tank.csv", "-o", "t.mcap"}), 2, {"tank.csv", "'pingvox map'"});
  for (const char* const option : {"--messages", "--path", "--beams"}) {
    const std::string value = option == std::string("--messages") ? "ros2" : "tank.csv";
    expect_error(here.call({"convert", "tank.ot", "-o", "t.ply", option, value}), 2, {option, ".mcap"});
  }
  EXPECT_FALSE(here.has("t.mcap"));
}

}  // namespace
}  // namespace pingvox::test
