// Trajectories from beams and navigation.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "call.hpp"
#include "tests/slam/basin.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

/// A short drive in the basin, as beams.csv and nav.csv.
void write_basin(const Workplace& here) {
  const Basin basin;
  std::string beams = "time_s,bearing_rad,bin_length_m,intensities\n", nav = "time_s,source,quantity,x,y,z\n";
  for (const Beam& beam : basin.beams()) {
    if (beam.time_s > 100.0) break;
    beams += fmt::format("{},{},{},{}\n", beam.time_s, beam.bearing_rad, beam.bin_length_m,
                         fmt::join(beam.intensities, ","));
  }
  for (const NavSource& source : basin.sources()) {
    for (const NavSample& sample : source.samples) {
      if (sample.time_s > 100.0) break;
      const auto& v = sample.value;
      nav += numbers_of(source.quantity) == 1
                 ? fmt::format("{},{},{},{},,\n", sample.time_s, source.name, name_of(source.quantity), v.x())
                 : fmt::format("{},{},{},{},{},{}\n", sample.time_s, source.name, name_of(source.quantity), v.x(),
                               v.y(), v.z());
    }
  }
  here.write("beams.csv", beams);
  here.write("nav.csv", nav);
}

TEST(Slam, WritesTrajectoryMapAndCalibration) {
  const Workplace here;
  write_basin(here);
  const Outcome outcome =
      here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", "out.tum", "--map", "out.bt", "--resolution", "0.5",
                 "--calibration", "out.toml", "--mount", "0,0,0,0,0,40.1", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part : {R"("poses": 1001)", R"("sweeps": 10)", R"("pairs": )", R"("loops": {"found": )",
                           R"("calibration": {"velocity_yaw_deg": {"value": )", R"("seconds": {"read": )",
                           R"("real_time_factor": )", R"("source": "compass")"}) {
    EXPECT_THAT(outcome.out, HasSubstr(part));
  }
  EXPECT_THAT(here.call({"info", "out.tum"}).out, HasSubstr("1001"));
  EXPECT_EQ(here.call({"info", "out.bt"}).status, 0);
  EXPECT_THAT(here.read("out.toml"), HasSubstr("[[heading]]\nsource = \"compass\"\nconstant-deg = "));
}

TEST(Slam, DeadReckoningNeedsNoEchoes) {
  const Workplace here;
  write_basin(here);
  const Outcome outcome =
      here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", "out.tum", "--matching", "none", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr(R"("pairs": 0)"));
  EXPECT_THAT(outcome.out, HasSubstr(R"("calibration": null)"));
}

TEST(Slam, TheSameSeedWritesTheSameBytes) {
  const Workplace here;
  write_basin(here);
  for (const char* name : {"a.tum", "b.tum"}) {
    ASSERT_EQ(here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", name, "--seed", "7"}).status, 0);
  }
  EXPECT_EQ(here.read("a.tum"), here.read("b.tum"));
}

TEST(Slam, SaysWhatIsWrongWithItsWords) {
  const Workplace here;
  write_basin(here);
  expect_error(here.call({"slam", "beams.csv", "-o", "o.tum"}), 2, {"--nav is missing"});
  for (const char* mount : {"dvl", "dvl=1,2", "=0,0,0,0,0,0"}) {
    expect_error(here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", "o.tum", "--nav-mount", mount}), 2,
                 {"--nav-mount"});
  }
  expect_error(here.call({"slam", "-", "--nav", "nav.csv", "-o", "o.tum", "--map", "m.bt"}), 2, {"--map"});
  expect_error(here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", "o.tum", "--nav-mount", "dlv=0,0,0,0,0,9"}), 2,
               {"dlv", "compass"});
}

TEST(Slam, SaysWhatIsMissingInTheNavigation) {
  const Workplace here;
  write_basin(here);
  here.write("depth.csv", "time_s,source,quantity,x\n1,bar,depth,2\n2,bar,depth,2\n");
  expect_error(here.call({"slam", "beams.csv", "--nav", "depth.csv", "-o", "o.tum"}), 1,
               {"beams.csv", "no valid velocity and no heading"});
  expect_error(here.call({"slam", "beams.csv", "--nav", "nav.csv", "--nav-offset", "5000", "-o", "o.tum"}), 1,
               {"do not overlap in time"});
  EXPECT_FALSE(here.has("o.tum"));
}

}  // namespace
}  // namespace pingvox::test
