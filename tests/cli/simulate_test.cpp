#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "call.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(Simulate, WritesTheTruthBesideTheLog) {
  const Workplace here;
  const Outcome made = here.call({"simulate", "harbour", "-o", "harbour.csv", "--trajectory", "line", "--turns", "2",
                                  "--truth", "truth", "--resolution", "0.2", "--drift", "0.5", "--lost", "0.1"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("truth: ground truth"));
  const std::string log = here.read("harbour.csv");
  const std::string ranges = here.read("truth/ranges.csv");
  EXPECT_EQ(lines_of(log), lines_of(ranges)) << "a line for each beam of the log, and the head";
  EXPECT_GT(lines_of(log), 300U);
  EXPECT_LT(lines_of(log), 400U) << "some are lost";
  EXPECT_TRUE(ranges.starts_with("time_s,bearing_rad,true_bearing_rad,axis_range_m,cone_range_m\n"));
  // The same times in the same order.
  std::istringstream beams(log);
  std::istringstream truths(ranges);
  for (std::string beam, truth; std::getline(beams, beam) && std::getline(truths, truth);) {
    EXPECT_EQ(beam.substr(0, beam.find(',')), truth.substr(0, truth.find(',')));
  }
  EXPECT_EQ(lines_of(here.read("harbour.tum")), lines_of(here.read("truth/poses.tum")));
  EXPECT_NE(here.read("harbour.tum"), here.read("truth/poses.tum")) << "it drifts";
  EXPECT_TRUE(here.read("truth/world.ply").starts_with("ply\n"));

  // The map made with the reported poses, beside the true one.
  ASSERT_EQ(here.call({"map", "harbour.csv", "--poses", "harbour.tum", "--beam", "cone", "--resolution", "0.2", "-o",
                       "harbour.bt", "--quiet"})
                .status,
            0);
  const Outcome compared = here.call({"compare", "harbour.bt", "truth/world.bt", "--json"});
  EXPECT_EQ(compared.status, 1) << compared.err;
  EXPECT_NE(compared.out, "");
}

// Kills a truth that has no pose but for the first beam.
TEST(Simulate, TheTrueTrajectoryOfAStillVehicleCoversItsLog) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "tank.csv", "--turns", "1", "--truth", "truth"}).status, 0);
  const Outcome mapped = here.call({"map", "tank.csv", "--poses", "truth/poses.tum", "-o", "tank.bt", "--json"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr(R"("skipped": 0,)"));
}

TEST(Simulate, HearsAMeshWhereItStands) {
  const Workplace here;
  // A wall 2 m ahead, once in each format.
  here.write("wall.off", "OFF\n4 1 0\n2 -9 -9\n2 9 -9\n2 9 9\n2 -9 9\n4 0 1 2 3\n");
  here.write("wall.ply",
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement "
             "face 1\nproperty list uchar int vertex_indices\nend_header\n2 -9 -9\n2 9 -9\n2 9 9\n2 -9 9\n4 0 1 2 3\n");
  here.write("wall.stl",
             "solid wall\nfacet normal 1 0 0\nouter loop\nvertex 2 -9 -9\nvertex 2 9 -9\nvertex 2 9 "
             "9\nendloop\nendfacet\nfacet normal 1 0 0\nouter loop\nvertex 2 -9 -9\nvertex 2 9 9\nvertex 2 -9 "
             "9\nendloop\nendfacet\nendsolid wall\n");
  std::vector<std::string> logs;
  for (const std::string mesh : {"wall.off", "wall.ply", "wall.stl"}) {
    SCOPED_TRACE(mesh);
    const Outcome made = here.call({"simulate", mesh, "-o", "log.csv", "--turns", "1", "--range", "5", "--truth",
                                    "truth", "--resolution", "0.5", "--quiet"});
    ASSERT_EQ(made.status, 0) << made.err;
    logs.push_back(here.read("log.csv"));
    EXPECT_THAT(here.read("truth/ranges.csv"), HasSubstr("0,0,0,2.000000,2.000000\n"));
  }
  EXPECT_EQ(logs[0], logs[1]);
  EXPECT_EQ(logs[0], logs[2]);

  here.write("broken.off", "OFF\n4 1 0\n2 -9 -9\n");
  expect_error(here.call({"simulate", "broken.off", "-o", "a.csv"}), 1, {"broken.off", "vertex 1"});
  expect_error(here.call({"simulate", "none.stl", "-o", "a.csv"}), 1, {"none.stl"});
  expect_error(here.call({"simulate", "wall.off", "-o", "a.csv", "--truth", "fine", "--resolution", "0.001"}), 2,
               {"--resolution"});
  EXPECT_FALSE(here.has("a.csv")) << "said before the work";
}

TEST(Simulate, FollowsATrajectoryOfTheCallers) {
  const Workplace here;
  here.write("way.tum", "100 0 0 0 0 0 0 1\n110 1 0 0 0 0 0 1\n");
  const Outcome made = here.call({"simulate", "tank", "-o", "tank.csv", "--poses", "way.tum", "--quiet"});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::string log = here.read("tank.csv");
  EXPECT_EQ(lines_of(log), 1U + 231U) << "23 beams a second for ten seconds, both ends included";
  EXPECT_THAT(log, HasSubstr("\n100,0,"));
  ASSERT_EQ(here.call({"map", "tank.csv", "--poses", "tank.tum", "-o", "tank.bt", "--quiet"}).status, 0);
}

TEST(Simulate, MakesTheSameFilesAgain) {
  const Workplace here;
  for (const std::string world : {"tank", "harbour", "marina", "seabed", "cave"}) {
    std::vector<std::string> made;
    for (const std::string seed : {"4", "4", "5"}) {
      ASSERT_EQ(here.call({"simulate", world, "-o", "log.csv", "--trajectory", world == "marina" ? "by-hand" : "loop",
                           "--turns", "1", "--beams-per-turn", "40", "--seed", seed, "--drift", "1", "--quiet"})
                    .status,
                0);
      made.push_back(here.read("log.csv") + here.read("log.tum"));
    }
    EXPECT_EQ(made[0], made[1]) << world;
    EXPECT_NE(made[0], made[2]) << world;
  }
}

// It wrote until the disk was full.
TEST(Simulate, RefusesPathsOfMoreTurnsThanMayBeAskedFor) {
  const Workplace here;
  here.write("long.tum", "0 0 0 0 0 0 0 1\n1e7 1 0 0 0 0 0 1\n");
  for (const std::vector<std::string>& path : {std::vector<std::string>{"--trajectory", "loop", "--speed", "1e-6"},
                                               {"--trajectory", "by-hand", "--speed", "1e-5"},
                                               {"--poses", "long.tum"}}) {
    std::vector<std::string> words = {"simulate", "harbour", "-o", "slow.csv"};
    words.insert(words.end(), path.begin(), path.end());
    expect_error(here.call(words), 2, {"turns of the head, more than 10000", "--turns"});
  }
  expect_error(here.call({"simulate", "harbour", "-o", "slow.csv", "--trajectory", "by-hand", "--speed", "1e-6",
                          "--turns", "1"}),
               2, {"longer than a built-in one"});
  EXPECT_FALSE(here.has("slow.csv"));
}

TEST(Simulate, WritesNavigationThatInfoAndSlamRead) {
  const Workplace here;
  std::vector<std::string> made;
  for (const std::string seed : {"4", "4", "5"}) {
    const Outcome simulated =
        here.call({"simulate", "harbour", "-o", "dive.csv", "--trajectory", "loop", "--turns", "2", "--seed", seed,
                   "--nav", "nav.csv", "--nav-delay", "0.25", "--truth", "truth", "--resolution", "0.5"});
    ASSERT_EQ(simulated.status, 0) << simulated.err;
    EXPECT_THAT(simulated.out, HasSubstr("samples of navigation"));
    made.push_back(here.read("nav.csv") + here.read("truth/nav.toml"));
  }
  EXPECT_EQ(made[0], made[1]);
  EXPECT_NE(made[0], made[2]);

  const Outcome info = here.call({"info", "nav.csv", "--json"});
  ASSERT_EQ(info.status, 0) << info.err;
  for (const char* source : {R"("name": "DVL", "quantity": "velocity")", R"("name": "IMU", "quantity": "attitude")",
                             R"("name": "IMU", "quantity": "turn rate")", R"("name": "depth", "quantity": "depth")"}) {
    EXPECT_THAT(info.out, HasSubstr(source));
  }
  const Outcome solved = here.call({"slam", "dive.csv", "--nav", "nav.csv", "--nav-offset", "-0.25", "-o", "slam.tum",
                                    "--calibration", "found.toml", "--quiet"});
  ASSERT_EQ(solved.status, 0) << solved.err;
  const std::string truth = here.read("truth/nav.toml"), found = here.read("found.toml");
  EXPECT_THAT(truth, HasSubstr("nav-offset = -0.25\n"));
  for (const char* name : {"velocity-yaw-deg = ", "velocity-scale = ", "[[heading]]\nsource = \"IMU\"\nconstant-deg = ",
                           "\nsin1-deg = ", "\ncos2-deg = "}) {
    EXPECT_THAT(truth, HasSubstr(name));
    EXPECT_THAT(found, HasSubstr(name)) << "the same names";
  }
  for (const std::string command : {"slam", "map"}) {
    const Outcome known = here.call({command, "dive.csv", "--nav", "nav.csv", "--use-calibration", "truth/nav.toml",
                                     "-o", command == "map" ? "dive.bt" : "known.tum"});
    EXPECT_EQ(known.status, 0) << known.err;
  }

  expect_error(here.call({"simulate", "tank", "-o", "tank.csv", "--dvl-noise", "0.2"}), 2, {"--dvl-noise", "--nav"});
  expect_error(here.call({"simulate", "tank", "-o", "tank.csv", "--nav", "nav.csv", "--dvl-lost", "1"}), 2,
               {"--dvl-lost"});
}

}  // namespace
}  // namespace pingvox::test
