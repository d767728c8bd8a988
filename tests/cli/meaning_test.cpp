// What the values of options come to in the map.

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "call.hpp"
#include "json_reader.hpp"

namespace pingvox::test {
namespace {

/// A head that looks ahead all the time, and hears a wall at 2.025 m.
std::string wall_ahead() {
  std::string log = "time_s,bearing_rad,bin_length_m,intensities\n";
  for (int beam = 0; beam < 20; ++beam) {
    log += std::to_string(0.1 * beam) + ",0,0.05";
    for (int bin = 0; bin < 100; ++bin) log += bin >= 40 && bin < 43 ? ",200" : ",5";
    log += '\n';
  }
  return log;
}

/// The upper corner of the map that these options make, with cells of 0.1 m.
std::array<double, 3> corner_with(const std::vector<std::string>& options) {
  const Workplace here;
  here.write("wall.csv", wall_ahead());
  std::vector<std::string> words = {"map",      "wall.csv", "-o",           "map.pvx", "--json",      "--beam", "ray",
                                    "--filter", "none",     "--resolution", "0.1",     "--min-range", "0.1"};
  words.insert(words.end(), options.begin(), options.end());
  const Outcome made = here.call(words);
  EXPECT_EQ(made.status, 0) << made.err;
  auto json = flat_json(made.out);
  std::array<double, 3> corner{};
  const std::string text = json ? (*json)["map.bounds.max"] : "";
  EXPECT_EQ(std::sscanf(text.c_str(), "[%lf, %lf, %lf]", &corner[0], &corner[1], &corner[2]), 3) << made.out;
  return corner;
}

constexpr double kRounding = 1e-6;

// Kills a faster sound that makes ranges shorter.
TEST(Meaning, OfTheSpeedOfSoundIsThatRangesGrowWithIt) {
  EXPECT_NEAR(corner_with({"--mount", "0.03,0.03,0.03,0,0,0"})[0], 2.1, kRounding);
  EXPECT_NEAR(corner_with({"--mount", "0.03,0.03,0.03,0,0,0", "--sound-speed", "3000"})[0], 4.1, kRounding);
}

// Kills degrees that are taken for radians, and angles in another order.
TEST(Meaning, OfAMountIsMetresAndDegrees) {
  const auto left = corner_with({"--mount", "0.03,0.03,0.03,0,0,90"});
  EXPECT_NEAR(left[0], 0.1, kRounding);
  EXPECT_NEAR(left[1], 2.1, kRounding);
  const auto up = corner_with({"--mount", "0.03,0.03,1.03,0,-90,0"});
  EXPECT_NEAR(up[0], 0.1, kRounding);
  EXPECT_NEAR(up[2], 3.1, kRounding);
}

// Kills a unit that is a thousand times too small.
TEST(Meaning, OfALimitInKIsThousandsOfBytes) {
  EXPECT_NEAR(corner_with({"--mount", "0.03,0.03,0.03,0,0,0", "--memory-limit", "512K"})[0], 2.1, kRounding);
}

}  // namespace
}  // namespace pingvox::test
