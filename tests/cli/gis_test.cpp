// Maps and paths on the earth: what other programs read of them, GDAL's where they are installed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>

#include "call.hpp"

namespace pingvox::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// What a command of the shell prints, standard error included.
std::string printed_by(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen((command + " 2>&1").c_str(), "r"), &pclose);
  std::string text;
  std::array<char, 4096> piece{};
  while (pipe && std::fgets(piece.data(), piece.size(), pipe.get()) != nullptr) text += piece.data();
  return text;
}

#define PINGVOX_NEEDS_GDAL() \
  if (printed_by("command -v gdalinfo").empty()) GTEST_SKIP() << "gdal-bin is not installed"

/// Two points, at heights of -2.45 and -5.05 m, as a map of cells of 0.1 m.
void write_points_map(const Workplace& here) {
  here.write("points.xyz", "30.05 -20.05 -2.45\n0.05 0.05 -5.05\n");
  ASSERT_EQ(
      here.call({"map", "points.xyz", "-o", "points.ot", "--resolution", "0.1", "--origin", "0.05,0.05,-4.95"}).status,
      0);
}

/// Longitude and latitude of a place in metres from 54.5 N 10.25 E.
std::string place_text(double x_m, double y_m) {
  constexpr double kEast_m = 64787.44574605707,
                   kNorth_m = 111314.29378689443;  // of a degree there, by the ellipsoid of WGS 84
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "%.9f %.9f", 10.25 + x_m / kEast_m, 54.5 + y_m / kNorth_m);
  return text.data();
}

TEST(Rasters, AreAtTheirPlaceForGdal) {
  PINGVOX_NEEDS_GDAL();
  const Workplace here;
  write_points_map(here);
  const Outcome tif = here.call({"convert", "points.ot", "-o", "h.tif", "--origin", "54.5,10.25"});
  ASSERT_EQ(tif.status, 0) << tif.err;
  EXPECT_THAT(tif.out, HasSubstr("0, 0 at latitude 54.5000000, longitude 10.2500000 degrees"));
  ASSERT_EQ(here.call({"convert", "points.ot", "-o", "h.asc", "--origin", "54.5,10.25"}).status, 0);
  EXPECT_THAT(printed_by("gdalinfo -json " + here.path("h.tif")),
              AllOf(HasSubstr("4326"), HasSubstr("Float32"), HasSubstr("height [m]"), Not(HasSubstr("ERROR"))));
  for (const char* const file : {"h.tif", "h.asc"}) {
    const std::string ask = "gdallocationinfo -valonly -wgs84 " + here.path(file) + " ";
    EXPECT_EQ(printed_by(ask + place_text(30.05, -20.05)).substr(0, 4), "-2.4") << file;
    EXPECT_EQ(printed_by(ask + place_text(0.05, 0.05)).substr(0, 2), "-5") << file;
    for (const double beside_m : {-0.08, 0.08}) {
      EXPECT_NE(printed_by(ask + place_text(30.05 + beside_m, -20.05)).substr(0, 4), "-2.4") << file;
      EXPECT_NE(printed_by(ask + place_text(30.05, -20.05 + beside_m)).substr(0, 4), "-2.4") << file;
    }
  }
}

TEST(Rasters, WithoutAnOriginAreInMetresForGdal) {
  PINGVOX_NEEDS_GDAL();
  const Workplace here;
  write_points_map(here);
  ASSERT_EQ(here.call({"convert", "points.ot", "-o", "o.tif", "--values", "occupancy"}).status, 0);
  const std::string about = printed_by("gdalinfo " + here.path("o.tif"));
  EXPECT_THAT(about, HasSubstr("Pixel Size = (0.1"));
  EXPECT_THAT(about, HasSubstr("NoData Value=nan"));
  EXPECT_THAT(about, Not(HasSubstr("WGS 84")));
  const std::string ask = "gdallocationinfo -valonly -geoloc " + here.path("o.tif") + " ";
  EXPECT_EQ(printed_by(ask + "30.05 -20.05"), "1\n");
  EXPECT_EQ(printed_by(ask + "12.05 -7.95"), "0\n") << "seen through";
  EXPECT_EQ(printed_by(ask + "30.05 0.05").substr(0, 3), "nan");
}

TEST(Rasters, SayThatAnOldPrjPlacesThem) {
  const Workplace here;
  write_points_map(here);
  ASSERT_EQ(here.call({"convert", "points.ot", "-o", "h.asc", "--origin", "54,10"}).status, 0);
  const Outcome again = here.call({"convert", "points.ot", "-o", "h.asc"});
  ASSERT_EQ(again.status, 0);
  EXPECT_THAT(again.out,
              AllOf(HasSubstr("not placed on the earth (--origin)"), HasSubstr("the existing h.prj still places it")));
}

TEST(Paths, OnTheEarthAreReadByOgr) {
  PINGVOX_NEEDS_GDAL();
  const Workplace here;
  here.write("dive.tum", "0 0 0 -1 0 0 0 1\n1 647.8744574606 0 -1 0 0 0 1\n");
  const Outcome written = here.call({"convert", "dive.tum", "-o", "dive.geojson", "--origin", "54.5,10.25"});
  ASSERT_EQ(written.status, 0) << written.err;
  EXPECT_EQ(written.out, "dive.geojson: 2 poses\n");
  const std::string features = printed_by("ogrinfo -al " + here.path("dive.geojson"));
  EXPECT_THAT(features, AllOf(HasSubstr("Feature Count: 3"), HasSubstr("WGS 84"), HasSubstr("= 90")));
  EXPECT_THAT(features, HasSubstr("LINESTRING (10.25 54.5,10.26"));
}

TEST(Paths, AreAtTheFixOfTheirNavigation) {
  const Workplace here;
  here.write("nav.csv",
             "time_s,source,quantity,x,y,z,sd_x,sd_y,sd_z,valid\n"
             "1,gps,fix,0.95,0.18,0,,,,1\n2,gps,fix,0.950001,0.18,0,,,,1\n"
             "1,imu,attitude,0,0,0,,,,1\n2,imu,attitude,0,0,0,,,,1\n");
  const Outcome written = here.call({"convert", "nav.csv", "-o", "nav.geojson"});
  ASSERT_EQ(written.status, 0) << written.err;
  EXPECT_THAT(here.read("nav.geojson"), HasSubstr("[[10.313240312,54.430990537],"));

  here.write("points.xyz", "1.05 0.05 -2.45\n");
  ASSERT_EQ(here.call({"map", "points.xyz", "-o", "points.ot"}).status, 0);
  const Outcome placed = here.call({"convert", "points.ot", "-o", "h.tif", "--nav", "nav.csv"});
  ASSERT_EQ(placed.status, 0) << placed.err;
  EXPECT_THAT(placed.out, HasSubstr("0, 0 at latitude 54.4309905, longitude 10.3132403 degrees"));
}

TEST(Origins, AreRefusedWhereTheyMakeNoSense) {
  const Workplace here;
  write_points_map(here);
  here.write("dive.tum", "0 0 0 -1 0 0 0 1\n");
  expect_error(here.call({"convert", "dive.tum", "-o", "dive.geojson"}), 2, {"dive.tum", "--origin LAT,LON"});
  expect_error(here.call({"convert", "points.ot", "-o", "h.ply", "--origin", "54,10"}), 2, {"--origin", ".geojson"});
  expect_error(here.call({"convert", "points.ot", "-o", "h.tif", "--origin", "90,10"}), 2, {"--origin", "90"});
  expect_error(here.call({"convert", "points.ot", "-o", "h.tif", "--origin", "54"}), 2, {"--origin", "2 numbers"});
  expect_error(here.call({"convert", "points.ot", "-o", "h.tif", "--origin", "54,10", "--nav", "n.csv"}), 2,
               {"exclude each other"});
  expect_error(here.call({"convert", "points.ot", "--format", "asc", "-o", "-", "--origin", "54,10"}), 2, {"-o -"});
  expect_error(here.call({"convert", "points.ot", "-o", "h.tif", "--height", "lowest", "--values", "occupancy"}), 2,
               {"--height"});
  expect_error(here.call({"convert", "points.ot", "-o", "h.ply", "--colours", "height"}), 2, {"--colours", ".glb"});
  expect_error(here.call({"convert", "points.ot", "-o", "h.ply", "--values", "heights"}), 2, {"--values", ".tif"});
  here.write("metres.csv",
             "time_s,source,quantity,x,y,z,sd_x,sd_y,sd_z,valid\n"
             "1,usbl,position,0,0,0,,,,1\n2,usbl,position,1,0,0,,,,1\n"
             "1,imu,attitude,0,0,0,,,,1\n2,imu,attitude,0,0,0,,,,1\n");
  expect_error(here.call({"convert", "points.ot", "-o", "h.tif", "--nav", "metres.csv"}), 1,
               {"metres.csv", "--origin"});
}

TEST(Meshes, AndLaserPointsOfNothingAreRefused) {
  const Workplace here;
  write_points_map(here);
  for (const char* const file : {"m.glb", "m.las", "m.tif"}) {
    expect_error(here.call({"convert", "points.ot", "-o", file, "--min-z", "40"}), 1, {"points.ot"});
    EXPECT_FALSE(here.has(file));
  }
  EXPECT_THAT(here.call({"convert", "points.ot", "-o", "m.glb"}).out, HasSubstr("m.glb: 12 rectangles for 2 occupied"));
  EXPECT_THAT(here.call({"convert", "points.ot", "-o", "m.las"}).out, HasSubstr("m.las: 2 points for 2 occupied"));
}

}  // namespace
}  // namespace pingvox::test
