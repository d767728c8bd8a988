// The sonar's picture on the ground: files, place and messages; what GDAL reads of them where it is installed.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "call.hpp"

namespace pingvox::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string shell_output(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen((command + " 2>&1").c_str(), "r"), &pclose);
  std::string text;
  std::array<char, 4096> piece{};
  while (pipe && std::fgets(piece.data(), piece.size(), pipe.get()) != nullptr) text += piece.data();
  return text;
}

/// Four beams ahead, left, back and right, a second apart: bins of 0.1 m, the strongest at 5 m.
void write_cross(const Workplace& here) {
  std::string log = "time_s,bearing_rad,bin_length_m,intensities\n";
  for (int n = 0; n < 4; ++n) {
    log += std::to_string(n) + "," + std::to_string(1.5707963267948966 * n) + ",0.1";
    for (int bin = 0; bin < 60; ++bin) log += bin == 50 ? ",200" : ",20";
    log += "\n";
  }
  here.write("cross.csv", log);
}

TEST(Mosaic, IsAPictureWithItsWorldFile) {
  const Workplace here;
  write_cross(here);
  const Outcome made = here.call({"mosaic", "cross.csv", "-o", "cross.png", "--json"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(here.read("cross.png").substr(1, 3), "PNG");
  EXPECT_THAT(made.out, AllOf(HasSubstr("\"beams\": 4"), HasSubstr("\"origin\": null")));
  EXPECT_EQ(here.read("cross.pgw").substr(0, 9), "0\n-0.025\n")
      << "ahead is up: a step to the right is a step back in y";
  ASSERT_EQ(here.call({"mosaic", "cross.csv", "-o", "north.png", "--up", "north"}).status, 0);
  EXPECT_EQ(here.read("north.pgw").substr(0, 8), "0.025\n0\n");
  const Outcome streamed = here.call({"mosaic", "-", "-o", "-"}, {.in = here.read("cross.csv")});
  ASSERT_EQ(streamed.status, 0) << streamed.err;
  EXPECT_EQ(streamed.out, here.read("cross.png"));
}

TEST(Mosaic, IsAtItsPlaceForGdal) {
  if (shell_output("command -v gdalinfo").empty()) GTEST_SKIP() << "gdal-bin is not installed";
  const Workplace here;
  write_cross(here);
  // 100 m east and 50 m north of the origin, the head turned to the north: its beam to the left is heard in the west.
  here.write("north.tum", "0 100 50 -2 0 0 0.70710678 0.70710678\n9 100 50 -2 0 0 0.70710678 0.70710678\n");
  for (const char* const blend : {"mean", "maximum"}) {
    const Outcome made = here.call(
        {"mosaic", "cross.csv", "--poses", "north.tum", "-o", "north.tif", "--origin", "54.5,10.25", "--blend", blend});
    ASSERT_EQ(made.status, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr("0, 0 at latitude 54.5000000, longitude 10.2500000 degrees"));
    EXPECT_THAT(shell_output("gdalinfo " + here.path("north.tif")),
                AllOf(HasSubstr("4326"), HasSubstr("NoData Value=nan"), Not(HasSubstr("ERROR"))));
    const auto intensity_at = [&](double x_m, double y_m) {
      constexpr double kEast_m = 64787.44574605707, kNorth_m = 111314.29378689443;  // of a degree there (WGS 84)
      std::array<char, 80> place{};
      std::snprintf(place.data(), place.size(), "%.9f %.9f", 10.25 + x_m / kEast_m, 54.5 + y_m / kNorth_m);
      return shell_output("gdallocationinfo -valonly -wgs84 " + here.path("north.tif") + " " + place.data());
    };
    for (const auto& [x_m, y_m] : {std::pair{100.0, 55.05}, {94.95, 50.0}, {100.0, 44.95}, {105.05, 50.0}}) {
      EXPECT_NEAR(std::strtod(intensity_at(x_m, y_m).c_str(), nullptr), 200.0, 0.01) << x_m << " " << y_m;
    }
    EXPECT_NEAR(std::strtod(intensity_at(100.0, 53.0).c_str(), nullptr), 20.0, 0.01);
    EXPECT_EQ(intensity_at(103.0, 53.0).substr(0, 3), "nan") << "between the beams";
  }
  ASSERT_EQ(here.call({"mosaic", "cross.csv", "--poses", "north.tum", "-o", "north.png"}).status, 0);
  EXPECT_EQ(shell_output("gdallocationinfo -valonly -geoloc " + here.path("north.png") + " 100 55.05"), "226\n255\n")
      << "255 * sqrt(200 / 255), opaque";
}

TEST(Mosaic, IsAtTheFixOfItsNavigation) {
  const Workplace here;
  write_cross(here);
  here.write("nav.csv",
             "time_s,source,quantity,x,y,z,sd_x,sd_y,sd_z,valid\n"
             "0,gps,fix,0.95,0.18,0,,,,1\n4,gps,fix,0.950001,0.18,0,,,,1\n"
             "0,imu,attitude,0,0,0,,,,1\n4,imu,attitude,0,0,0,,,,1\n");
  const Outcome made =
      here.call({"mosaic", "cross.csv", "--nav", "nav.csv", "--nav-offset", "0", "-o", "cross.tif", "--json"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, AllOf(HasSubstr("\"latitude_deg\": 54.43099"), HasSubstr("\"longitude_deg\": 10.3132")));
  expect_error(here.call({"mosaic", "cross.csv", "--nav", "nav.csv", "--nav-offset", "0", "-o", "cross.tif", "--origin",
                          "10.3,54.4"}),
               2, {"--origin", "nav.csv", "54.43099"});
  expect_error(here.call({"mosaic", "cross.csv", "--nav", "nav.csv", "--nav", "nav.csv", "-o", "cross.tif"}), 2,
               {"nav.csv", "twice"});
}

// Kills positions in metres whose fixes are not looked at.
TEST(Mosaic, OfPositionsInMetresIsPlacedByFixesOfTheirTime) {
  const Workplace here;
  write_cross(here);
  std::string nav = "time_s,source,quantity,x,y,z,sd_x,sd_y,sd_z,valid\n";
  for (int i = 0; i <= 12; ++i) {
    nav += fmt::format("{0},gps,fix,0.95,0.18,0,,,,1\n{0},ekf,position,0,637.0,0,,,,1\n{0},imu,attitude,0,0,0,,,,1\n",
                       0.25 * i);
  }
  here.write("nav.csv", nav);
  const Outcome made =
      here.call({"mosaic", "cross.csv", "--nav", "nav.csv", "--nav-offset", "0", "-o", "cross.tif", "--json"});
  ASSERT_EQ(made.status, 0) << made.err;
  // 637 m south of the fix: 0.00572 degrees.
  EXPECT_THAT(made.out, HasSubstr("\"latitude_deg\": 54.4252"));
  const Outcome path = here.call({"convert", "nav.csv", "-o", "nav.geojson"});
  ASSERT_EQ(path.status, 0) << path.err;
  EXPECT_THAT(here.read("nav.geojson"), HasSubstr("54.4309")) << "the vehicle is at the fix";
}

TEST(Mosaic, IsRefusedWhereItMakesNoSense) {
  const Workplace here;
  write_cross(here);
  here.write("late.tum", "100 0 0 0 0 0 0 1\n104 1 0 0 0 0 0 1\n");
  here.write("scan.xyz", "1 2 3\n");
  const auto call = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"mosaic"});
    return here.call(options);
  };
  expect_error(call({"cross.csv", "--resolution", "0.0001", "-o", "a.png"}), 1, {"cross.csv", "pixels of 0.0001 m"});
  expect_error(call({"cross.csv", "--poses", "late.tum", "-o", "a.png"}), 1, {"cross.csv", "outside the time"});
  expect_error(call({"cross.csv", "-o", "a.png", "--min-range", "50"}), 1, {"cross.csv", "--min-range"});
  expect_error(call({"scan.xyz", "-o", "a.png"}), 1, {"scan.xyz"});
  expect_error(call({"none.csv", "-o", "a.png"}), 1, {"none.csv"});
  expect_error(call({"cross.csv", "-o", "a.bt"}), 2, {"a.bt", ".png or .tif"});
  expect_error(call({"cross.csv", "-o", "a.png", "--origin", "54,10"}), 2, {"--origin", ".tif"});
  expect_error(call({"cross.csv", "-o", "a.tif", "--gamma", "1"}), 2, {"--gamma", ".png"});
  expect_error(call({"cross.csv", "-o", "a.tif", "--up", "north"}), 2, {"--up", ".png"});
  expect_error(call({"cross.csv", "-o", "a.png", "--max-range", "0.5"}), 2, {"--max-range", "--min-range"});
  expect_error(call({"cross.csv", "-o", "-", "--json"}), 2, {"--json"});
  here.write("a.pgw", here.read("cross.csv"));
  expect_error(call({"a.pgw", "-o", "a.png"}), 2, {"world file", "a.pgw"});
  EXPECT_FALSE(here.has("a.png"));
  EXPECT_FALSE(here.has("a.tif"));
}

TEST(Mosaic, SaysWhatItLeftOut) {
  const Workplace here;
  write_cross(here);
  here.write("short.tum", "0 0 0 0 0 0 0 1\n2.5 1 0 0 0 0 0 1\n");
  here.write("damaged.csv", here.read("cross.csv") + "5,0,-1,3\n");
  const Outcome made = here.call({"mosaic", "damaged.csv", "--poses", "short.tum", "-o", "a.png", "--json"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, AllOf(HasSubstr("\"beams\": 3"), HasSubstr("\"skipped\": 2"), HasSubstr("\"damage\": 1"),
                              HasSubstr("\"no_pose\": 1")));
  EXPECT_THAT(made.err, AllOf(HasSubstr("1 of 4 beams outside the time of the poses"), HasSubstr("1 damaged record")));
  expect_error(here.call({"mosaic", "damaged.csv", "-o", "b.png", "--strict"}), 1, {"damaged.csv", "line 6"});
}

}  // namespace
}  // namespace pingvox::test
