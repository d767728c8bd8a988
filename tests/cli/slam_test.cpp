// Trajectories from beams and navigation.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <sstream>
#include <string>

#include "call.hpp"
#include "json_reader.hpp"
#include "pingvox/geometry/pose.hpp"
#include "tests/slam/basin.hpp"
#include "tests/slam/scanned_drive.hpp"

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
                 "--calibration", "out.toml", "--covariance", "out.csv", "--mount", "0,0,0,0,0,40.1", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part : {R"("poses": 1001)", R"("sweeps": 10)", R"("pairs": )", R"("loops": {"found": )",
                           R"("submap_loops": {"found": )", R"("calibration": {"velocity_yaw_deg": {"value": )",
                           R"("seconds": {"read": )", R"("real_time_factor": )", R"("source": "compass")",
                           R"("name": "constant of heading compass")", R"("uncertainty": {"mean_sd_m": )"}) {
    EXPECT_THAT(outcome.out, HasSubstr(part));
  }
  EXPECT_THAT(here.call({"info", "out.tum"}).out, HasSubstr("1001"));
  EXPECT_EQ(here.call({"info", "out.bt"}).status, 0);
  EXPECT_THAT(here.read("out.csv"), HasSubstr("time_s,x_x,x_y,y_y,x_yaw,y_yaw,yaw_yaw\n0.000000000,"));
  expect_error(here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", "o.tum", "--covariance", "c.csv", "--causal"}),
               2, {"--covariance", "--causal"});
  EXPECT_THAT(here.read("out.toml"), HasSubstr("[[heading]]\nsource = \"compass\"\nconstant-deg = "));
}

// Kills names of coefficients that mean nothing to a user, and "-0.00".
TEST(Slam, OfAVehicleThatStandsStillNamesWhatIsNotKnown) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "--turns", "3", "-o", "log.csv", "--nav", "nav.csv", "--quiet"}).status, 0);
  const Outcome outcome = here.call({"slam", "log.csv", "--nav", "nav.csv", "-o", "out.tum"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("constant of heading IMU, deviation of heading IMU: hardly observable in this recording"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("-0.00 ")));
}

// The DVL of the basin is turned and its compass deviates: kills a calibration that is read and not used.
TEST(Slam, CalibrationIsReadBackByMapRenderLocateAndSlam) {
  PINGVOX_SKIP_WITH_OTHER_PROGRAM();
  const Workplace here;
  write_basin(here);
  const std::vector<std::string> dive = {"beams.csv", "--nav", "nav.csv", "--mount", "0,0,0,0,0,40.1"};
  const auto call = [&](std::vector<std::string> args, const std::vector<std::string>& more) {
    args.insert(args.end(), dive.begin(), dive.end());
    args.insert(args.end(), more.begin(), more.end());
    return here.call(args);
  };
  ASSERT_EQ(call({"slam"}, {"-o", "out.tum", "--calibration", "a.toml", "--nav-mount", "dvl=0.5,0,0,10,20,30"}).status,
            0);
  EXPECT_THAT(here.read("a.toml"), HasSubstr("[[mount]]\nsource = \"dvl\"\npose = \"0.5,0,0,10,20,30\"\n"));
  ASSERT_EQ(call({"slam"}, {"-o", "out.tum", "--calibration", "b.toml"}).status, 0);
  const Outcome again = call({"slam"}, {"-o", "o.tum", "--use-calibration", "a.toml", "--calibration", "again.toml"});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(here.read("again.toml"), HasSubstr("[[mount]]\nsource = \"dvl\"\npose = \"0.5,0,0,10,20,30\"\n"));
  ASSERT_EQ(call({"map"}, {"-o", "raw.bt", "--resolution", "0.5", "--beam", "ray"}).status, 0);
  ASSERT_EQ(
      call({"map"}, {"-o", "better.bt", "--resolution", "0.5", "--beam", "ray", "--use-calibration", "b.toml"}).status,
      0);
  EXPECT_NE(here.read("raw.bt"), here.read("better.bt"));
  EXPECT_EQ(call({"render"}, {"-o", "better.png", "--view", "above", "--resolution", "1", "--beam", "ray",
                              "--use-calibration", "b.toml"})
                .status,
            0);

  std::string few = here.read("beams.csv");
  for (std::size_t line = 0, end = 0; line < 60; ++line) {
    end = few.find('\n', end) + 1;
    if (line == 59) few.resize(end);
  }
  here.write("few.csv", few);
  const auto locate = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"locate", "few.csv", "--nav", "nav.csv", "--mount", "0,0,0,0,0,40.1", "--map",
                               "better.bt", "--start", "0,0,90,0.1,5", "-o", "l.tum"});
    return here.call(more);
  };
  ASSERT_EQ(locate({}).status, 0);
  const std::string uncalibrated = here.read("l.tum");
  ASSERT_EQ(locate({"--use-calibration", "b.toml"}).status, 0);
  EXPECT_NE(here.read("l.tum"), uncalibrated);
  std::string other = here.read("b.toml");
  here.write("other.toml", other.replace(other.find("\"compass\""), 9, "\"gyro\""));
  expect_error(locate({"--use-calibration", "other.toml"}), 2, {"no heading of compass"});

  expect_error(call({"slam"}, {"-o", "o.tum", "--matching", "none", "--calibration", "o.toml"}), 2, {"--calibration"});
  expect_error(here.call({"map", "beams.csv", "-o", "o.bt", "--use-calibration", "b.toml"}), 2,
               {"--use-calibration", "--nav"});
}

/// A number of a calibration.
double number_in(const std::string& toml, const std::string& name) {
  const std::size_t at = toml.find("\n" + name + " = ");
  return at == std::string::npos ? std::nan("") : std::stod(toml.substr(at + name.size() + 4));
}

// The sonar of the basin is at 0, 0. Kills a map along the trajectory whose sonar is not where the trajectory has it.
TEST(Slam, MapsFromTheSonarsEstimatedPlace) {
  PINGVOX_SKIP_WITH_OTHER_PROGRAM();
  const Workplace here;
  write_basin(here);
  const std::vector<std::string> dive = {"slam", "beams.csv", "--nav", "nav.csv", "--mount", "0.4,-0.3,0,0,0,40.1"};
  const auto slam = [&](const std::vector<std::string>& more) {
    std::vector<std::string> args = dive;
    args.insert(args.end(), more.begin(), more.end());
    return here.call(args);
  };
  const auto same_share = [&](const std::string& map, double x_m, double y_m) {
    const Outcome mapped = here.call({"map", "beams.csv", "--poses", "out.tum", "-o", "expected.bt", "--resolution",
                                      "0.2", "--mount", fmt::format("{},{},0,0,0,40.1", x_m, y_m)});
    EXPECT_EQ(mapped.status, 0) << mapped.err;
    auto json = flat_json(here.call({"compare", map, "expected.bt", "--json"}).out);
    EXPECT_TRUE(json);
    return json ? std::stod((*json)["same"]) / std::stod((*json)["cells"]) : 0.0;
  };
  const Outcome made = slam({"-o", "out.tum", "--map", "out.bt", "--resolution", "0.2", "--calibration", "c.toml"});
  ASSERT_EQ(made.status, 0) << made.err;
  const double x_m = number_in(here.read("c.toml"), "sonar-x"), y_m = number_in(here.read("c.toml"), "sonar-y");
  EXPECT_GT(std::hypot(x_m, y_m), 0.1);
  EXPECT_GT(same_share("out.bt", 0.4 + x_m, -0.3 + y_m), 0.999);
  EXPECT_LT(same_share("out.bt", 0.4, -0.3), 0.99);

  const Outcome reckoned = slam({"-o", "out.tum", "--map", "reckoned.bt", "--resolution", "0.2", "--matching", "none",
                                 "--use-calibration", "c.toml"});
  ASSERT_EQ(reckoned.status, 0) << reckoned.err;
  EXPECT_GT(same_share("reckoned.bt", 0.4 + x_m, -0.3 + y_m), 0.999);
}

TEST(Slam, SaysWhatIsWrongWithACalibration) {
  const Workplace here;
  write_basin(here);
  ASSERT_EQ(here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", "o.tum", "--calibration", "good.toml"}).status,
            0);
  const std::string good = here.read("good.toml");
  const auto map = [&](const std::string& toml) {
    here.write("c.toml", toml);
    return here.call({"map", "beams.csv", "--nav", "nav.csv", "-o", "o.bt", "--use-calibration", "c.toml",
                      "--resolution", "1", "--beam", "ray"});
  };
  const auto replaced = [&](const std::string& what, const std::string& by) {
    std::string toml = good;
    return toml.replace(toml.find(what), what.size(), by);
  };
  expect_error(map(replaced("velocity-scale =", "velocity-size =")), 1,
               {"c.toml: line 1", "velocity-scale", "missing"});
  expect_error(map(good + "sin3-deg = 1\n"), 1, {"c.toml: line ", "sin3-deg: is unknown"});
  expect_error(map(replaced("velocity-scale = ", "velocity-scale = x")), 1, {"c.toml: line 5: "});
  expect_error(map(replaced("velocity-scale = ", "velocity-scale = inf #")), 1, {"line 5", "not a finite number"});
  expect_error(map(replaced("velocity-scale-sd = ", "velocity-scale-sd = -")), 1, {"line 6", "above 0"});
  expect_error(map(replaced("sonar-x = ", "wall-in-echo = ")), 1, {"c.toml: line 9: ", "wall-in-echo"});
  expect_error(map(replaced("\"dvl\"", "dvl")), 1, {"c.toml: line 2: "});
  expect_error(map(replaced("\"dvl\"", "\"dvl")), 1, {"line 2"});
  expect_error(map(replaced("[[heading]]", "[[heeding]]")), 1, {"[[heeding]]: is unknown"});
  expect_error(map(replaced("\"compass\"", "\"gyro\"")), 2, {"no heading of compass"});
  expect_error(map(replaced("\"dvl\"", "\"A50\"")), 2, {"A50, not of dvl"});
  expect_error(map(good + "\n[[mount]]\nsource = \"dvl\"\npose = \"1,2\"\n"), 1, {"pose", "1,2"});
  expect_error(map(replaced("cos2-deg = ", "cos2-deg = 90 #")), 1, {"c.toml", "too large"});
  EXPECT_EQ(map(good + "# a comment\n\n").status, 0);
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

TEST(Slam, CausalIsAnotherTrajectoryOfTheSameBeams) {
  const Workplace here;
  write_basin(here);
  ASSERT_EQ(here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", "all.tum"}).status, 0);
  const Outcome causal = here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", "causal.tum", "--causal", "--json"});
  ASSERT_EQ(causal.status, 0);
  EXPECT_THAT(causal.out, HasSubstr(R"("largest": {"knots": )"));
  EXPECT_NE(here.read("all.tum"), here.read("causal.tum"));
  EXPECT_THAT(here.call({"info", "causal.tum"}).out, HasSubstr("1001"));
}

TEST(Slam, SaysWhatIsWrongWithItsWords) {
  const Workplace here;
  write_basin(here);
  for (const char* mount : {"dvl", "dvl=1,2", "=0,0,0,0,0,0"}) {
    expect_error(here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", "o.tum", "--nav-mount", mount}), 2,
                 {"--nav-mount"});
  }
  expect_error(here.call({"slam", "beams.csv", "-o", "o.tum", "--nav-offset", "1"}), 2, {"--nav-offset", "--nav"});
  expect_error(here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", "o.bt"}), 2, {"o.bt", ".tum"});
  expect_error(here.call({"slam", "beams.csv", "--nav", "", "-o", "o.tum"}), 2, {"--nav", "is empty"});
  expect_error(here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", "o.tum", "--graph", "o.g2o"}), 2, {"--graph"});
  expect_error(here.call({"slam", "-", "--nav", "nav.csv", "-o", "o.tum", "--map", "m.bt"}), 2, {"--map"});
  expect_error(here.call({"slam", "beams.csv", "--nav", "nav.csv", "-o", "o.tum", "--nav-mount", "dlv=0,0,0,0,0,9"}), 2,
               {"dlv", "compass"});
}

TEST(Slam, SaysWhatTellsTheVelocityWhereNoneWasMeasured) {
  const Workplace here;
  write_basin(here);
  std::istringstream lines(here.read("nav.csv"));
  std::string compass;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("dvl") == std::string::npos) compass += line + "\n";
  }
  here.write("compass.csv", compass);
  const Outcome text =
      here.call({"slam", "beams.csv", "--nav", "compass.csv", "--mount", "0,0,0,0,0,40.1", "-o", "o.tum"});
  ASSERT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("not measured, but by the sonar: "));
  const Outcome json =
      here.call({"slam", "beams.csv", "--nav", "compass.csv", "--mount", "0,0,0,0,0,40.1", "-o", "o.tum", "--json"});
  EXPECT_THAT(json.out, HasSubstr(R"("by_sonar": {"matched": )"));
  EXPECT_THAT(json.out, HasSubstr(R"("drift_m": )"));
  here.write("silent.csv", "time_s,bearing_rad,bin_length_m,intensities\n0,0,0.1,0,0\n1,3,0.1,0,0\n2,0.1,0.1,0,0\n");
  expect_error(here.call({"slam", "silent.csv", "-o", "silent.tum"}), 1, {"silent.csv", "sweeps match", "--nav"});
  EXPECT_FALSE(here.has("silent.tum"));
}

// The advice named an option of `map`, and the JSON that nothing was skipped.
TEST(Slam, CountsTheBeamsThatAreLeftOutOfTheMap) {
  const Workplace here;
  write_basin(here);
  const Outcome outcome = here.call({"slam", "beams.csv", "--nav", "nav.csv", "--nav-offset", "40", "-o", "out.tum",
                                     "--map", "out.bt", "--resolution", "0.5", "--matching", "none", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::smatch counts;
  ASSERT_TRUE(std::regex_search(outcome.out, counts,
                                std::regex(R"("map": \{"beams": (\d+), "skipped": (\d+), "resolution": 0.5\})")))
      << outcome.out;
  const std::string left_out = counts[2];
  EXPECT_GT(std::stoi(left_out), 100);
  EXPECT_THAT(outcome.err, HasSubstr("beams.csv: not mapped: " + left_out + " of "));
  EXPECT_THAT(outcome.err, HasSubstr("(--nav must cover the log"));
  const int all = std::stoi(left_out) + std::stoi(counts[1]);
  EXPECT_THAT(outcome.err, HasSubstr(fmt::format(" of {} beams", all)));
}

// Kills "3 beams without one, 60 of them in pauses": the pauses are those of the poses.
TEST(Slam, CountsPosesInPausesOfTheSonar) {
  const Workplace here;
  write_basin(here);
  std::istringstream beams(here.read("beams.csv"));
  std::string line, without;
  for (std::size_t i = 0; std::getline(beams, line); ++i) {
    if (i < 400 || i > 600) without += line + "\n";
  }
  here.write("pause.csv", without);
  const Outcome outcome =
      here.call({"slam", "pause.csv", "--nav", "nav.csv", "--nav-offset", "5", "--matching", "none", "-o", "out.tum"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(std::regex_search(
      outcome.out,
      std::regex(R"(\d+ poses over [0-9.]+ s, \d+ of them in pauses of the sonar; \d+ beams without one)")))
      << outcome.out;
}

TEST(Slam, WarnsOfWhatIsImplausible) {
  const Workplace here;
  write_basin(here);
  const Outcome outcome = here.call(
      {"slam", "beams.csv", "--nav", "nav.csv", "--nav-mount", "dvl=0,0,0,0,0,90", "-o", "out.tum", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("beams.csv, nav.csv: implausible: "));
  EXPECT_THAT(outcome.err, HasSubstr("are --mount, --nav-mount and --nav-offset right?"));
}

TEST(Slam, SaysWhatIsMissingInTheNavigation) {
  const Workplace here;
  write_basin(here);
  here.write("still.csv", "time_s,source,quantity,x,y,z\n1,dvl,velocity,0,0,0\n99,dvl,velocity,0,0,0\n");
  expect_error(here.call({"slam", "beams.csv", "--nav", "still.csv", "-o", "o.tum"}), 1,
               {"beams.csv", "no valid heading"});
  expect_error(here.call({"slam", "beams.csv", "--nav", "nav.csv", "--nav-offset", "5000", "-o", "o.tum"}), 1,
               {"do not overlap in time"});
  here.write("header.csv", "time_s,bearing_rad,bin_length_m,intensities\n");
  const Outcome none = here.call({"slam", "header.csv", "-o", "o.tum"});
  expect_error(none, 1, {"header.csv: there are no beams\n"});
  EXPECT_FALSE(here.has("o.tum"));
}

// Kills a map along samples of two clocks, put in order of time.
TEST(Slam, RefusesNavigationWhoseClockRunsBack) {
  const Workplace here;
  write_basin(here);
  here.write("back.csv",
             "time_s,source,quantity,x,y,z\n1,dvl,velocity,0,0,0\n31,dvl,velocity,0,0,0\n11,dvl,velocity,0,0,0\n"
             "1,imu,heading,0,,\n60,imu,heading,0,,\n");
  for (const char* command : {"slam", "map"}) {
    expect_error(
        here.call({command, "beams.csv", "--nav", "back.csv", "-o", command == std::string("map") ? "o.bt" : "o.tum"}),
        1, {"back.csv", "velocity of dvl runs back by 20.000 s, from 31.000 to 11.000 s"});
  }
  EXPECT_FALSE(here.has("o.tum") || here.has("o.bt"));
  const Outcome info = here.call({"info", "back.csv"});
  EXPECT_EQ(info.status, 0);
  EXPECT_THAT(info.out, HasSubstr("velocity of dvl by 20.000 s, from 31.000 to 11.000 s; 1 sample"));
  EXPECT_THAT(here.call({"info", "back.csv", "--json"}).out, HasSubstr(R"("late": 1)"));
  EXPECT_THAT(here.call({"convert", "back.csv", "-o", "sorted.csv"}).out, HasSubstr("runs back by 20.000 s"));
  // What is not used may be at any time.
  here.write("range.csv", here.read("nav.csv") + "31,altimeter,range,3,,\n11,altimeter,range,3,,\n");
  const Outcome mapped = here.call({"map", "beams.csv", "--nav", "range.csv", "-o", "o.bt", "--beam", "ray"});
  EXPECT_EQ(mapped.status, 0) << mapped.err;
}

/// Root of the mean square error of a trajectory after SE(2) alignment, by `compare`.
double error_m(const Workplace& here, const std::string& trajectory, const std::string& truth) {
  const std::string compared = here.call({"compare", trajectory, truth, "--json"}).out;
  const std::string before = R"("rmse": )";
  const std::size_t at = compared.find(before, compared.find(R"("se2")"));
  return at == std::string::npos ? NAN : std::stod(compared.substr(at + before.size()));
}

// Kills gates of pairs that are wider than the way from one boulder to the next: 1.5 m, where dead reckoning has 0.74
// m.
TEST(Slam, DoesNotTakeOneBoulderForTheNext) {
  PINGVOX_SKIP_WITH_OTHER_PROGRAM();
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "seabed", "-o", "s.csv", "--trajectory", "loop", "--nav", "n.csv", "--truth", "t",
                       "--resolution", "1", "--seed", "2"})
                .status,
            0);
  ASSERT_EQ(here.call({"slam", "s.csv", "--nav", "n.csv", "-o", "o.tum", "--quiet"}).status, 0);
  EXPECT_LT(error_m(here, "o.tum", "t/poses.tum"), 0.5);
}

// Kills gates that are wide wherever the DVL is silent for twenty seconds: 1.2 m.
TEST(Slam, ALostBottomLockDoesNotLeadToWrongWalls) {
  PINGVOX_SKIP_WITH_OTHER_PROGRAM();
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "harbour", "-o", "h.csv", "--trajectory", "by-hand", "--turns", "50", "--nav",
                       "n.csv", "--truth", "t", "--resolution", "1", "--seed", "11"})
                .status,
            0);
  std::istringstream lines(here.read("n.csv"));
  std::string with_gap;
  for (std::string line; std::getline(lines, line);) {
    const double time_s = std::atof(line.c_str());
    const bool is_lost = line.find(",velocity,") != std::string::npos && time_s > 88.0 && time_s < 108.0;
    if (!is_lost) with_gap += line + "\n";
  }
  here.write("gap.csv", with_gap);
  const Outcome solved = here.call({"slam", "h.csv", "--nav", "gap.csv", "-o", "o.tum", "--json"});
  ASSERT_EQ(solved.status, 0) << solved.err;
  EXPECT_LT(error_m(here, "o.tum", "t/poses.tum"), 0.4);
  EXPECT_THAT(solved.out, HasSubstr(R"("gaps_by_sonar_s": )"));
}

/// A drive there and back in an odd room, as scans.log.
void write_scans(const Workplace& here) {
  constexpr std::array<Wall, 6> kRoom = {
      {{-5, -9, 45, -12}, {45, -12, 47, 8}, {47, 8, 20, 12}, {20, 12, 18, 6}, {18, 6, -4, 10}, {-4, 10, -5, -9}}};
  const ScannedDrive drive(kRoom, std::vector<Eigen::Vector2d>{{0, 0}, {36, -3}, {30, 2}, {0, 0}, {36, -3}}, {});
  std::string log;
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    const auto& [place_m, yaw_rad] = drive.odometry[i];
    log += fmt::format("NODE {} {} -1 0 0 {}\n", place_m.x(), place_m.y(), yaw_rad);
    const Pose sensor_from_map =
        Pose(Eigen::Translation3d(drive.scans[i].origin_m) * drive.scans[i].rotation).inverse();
    for (const Eigen::Vector3d& point_m : drive.scans[i].points_m) {
      const Eigen::Vector3d at = sensor_from_map * point_m;
      log += fmt::format("{} {} {}\n", at.x(), at.y(), at.z());
    }
  }
  here.write("scans.log", log);
}

TEST(SlamOfScans, WritesTrajectoryAndMap) {
  const Workplace here;
  write_scans(here);
  const Outcome outcome = here.call(
      {"slam", "scans.log", "-o", "out.tum", "--map", "out.bt", "--resolution", "0.5", "--graph", "out.g2o", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(here.read("out.g2o"), testing::StartsWith("VERTEX_SE2 0 "));
  EXPECT_THAT(here.read("out.g2o"), HasSubstr("\nEDGE_SE2 0 "));
  for (const char* part :
       {R"("scans": )", R"("skipped": 0)", R"("key_frames": )", R"("loops": {"found": )", R"("seconds": {"read": )"}) {
    EXPECT_THAT(outcome.out, HasSubstr(part));
  }
  EXPECT_THAT(here.read("out.tum"), HasSubstr("\n1.000000000 "));
  EXPECT_EQ(here.call({"info", "out.bt"}).status, 0);
  ASSERT_EQ(here.call({"slam", "scans.log", "-o", "again.tum"}).status, 0);
  EXPECT_EQ(here.read("out.tum"), here.read("again.tum"));
}

TEST(SlamOfScans, SaysWhatIsWrongWithItsWordsAndFiles) {
  const Workplace here;
  write_scans(here);
  expect_error(here.call({"slam", "scans.log", "-o", "o.tum", "--nav", "nav.csv"}), 2, {"--nav", "beams"});
  expect_error(here.call({"slam", "scans.log", "scans.log", "-o", "o.tum"}), 2, {"unexpected argument"});
  here.write("one.log", "NODE 0 0 0 0 0 0\n1 2 3\n");
  expect_error(here.call({"slam", "one.log", "-o", "o.tum"}), 1, {"one.log", "only one scan"});
  here.write("none.log", "NODE 0 0 0 0 0 0\nNODE 1 0 0 0 0 0\n");
  expect_error(here.call({"slam", "none.log", "-o", "o.tum"}), 1, {"none.log", "no points"});
  EXPECT_FALSE(here.has("o.tum"));
}

}  // namespace
}  // namespace pingvox::test
