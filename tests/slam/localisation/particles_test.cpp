#include "slam/localisation/particles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "tests/support/uniform.hpp"

namespace pingvox::test {
namespace {

std::vector<std::size_t> all_of(const std::vector<Pose2>& poses) {
  std::vector<std::size_t> all(poses.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

/// Particles around a place, of one weight each.
void add_around(const Pose2& place, std::size_t count, double log_weight, std::mt19937_64& random,
                Particles& particles) {
  for (std::size_t i = 0; i < count; ++i) {
    particles.poses.push_back(
        {{place.place_m.x() + uniform(random, -0.1, 0.1), place.place_m.y() + uniform(random, -0.1, 0.1)},
         place.yaw_rad + uniform(random, -0.05, 0.05)});
    particles.log_weights.push_back(log_weight);
  }
}

// Kills draws that do not depend on the offset, or that are not in proportion to the weights.
TEST(Particles, AreDrawnAsOftenAsTheyWeigh) {
  constexpr std::size_t kCount = 7;
  constexpr int kOffsets = 1000;
  const std::vector<double> weights = {0.05, 0.3, 0.0, 0.45, 0.2};
  std::vector<double> drawn(weights.size(), 0.0);
  for (int n = 0; n < kOffsets; ++n) {
    std::vector<double> now(weights.size(), 0.0);
    for (const std::size_t i : draw_particles(weights, kCount, (n + 0.5) / kOffsets)) now[i] += 1.0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      EXPECT_LE(std::abs(now[i] - static_cast<double>(kCount) * weights[i]), 1.0);
      drawn[i] += now[i] / kOffsets;
    }
  }
  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_NEAR(drawn[i], static_cast<double>(kCount) * weights[i], 0.01) << i;
  }
}

// Kills boxes that are larger along one of the three axes than along the others.
TEST(Particles, AreAsManyForBoxesAlongEachAxis) {
  for (const int boxes : {2, 5, 20, 60}) {
    SCOPED_TRACE(boxes);
    std::vector<Pose2> along_x, along_y, turned;
    for (int n = 0; n < boxes; ++n) {
      const double middle = n + 0.5;
      along_x.push_back({{0.1 * middle, 0.0}, 0.0});
      along_y.push_back({{0.0, 0.1 * middle}, 0.0});
      turned.push_back({{0.0, 0.0}, 3.0 * kDegree_rad * (middle - std::floor(0.5 * boxes))});
    }
    const double asked = kld_particles(along_x, all_of(along_x));
    EXPECT_EQ(kld_particles(along_y, all_of(along_y)), asked);
    EXPECT_EQ(kld_particles(turned, all_of(turned)), asked);
    EXPECT_GT(asked, 10.0 * (boxes - 1));
    // So many more in each box change nothing.
    std::vector<Pose2> doubled = turned;
    doubled.insert(doubled.end(), turned.begin(), turned.end());
    EXPECT_EQ(kld_particles(doubled, all_of(doubled)), asked);
  }
}

// Kills a spread that depends on what lies elsewhere.
TEST(Particles, TheSpreadNearAPoseIsThatOfTheParticlesThere) {
  std::mt19937_64 random(5);
  const Pose2 place{{3.0, -2.0}, 3.1};
  Particles alone;
  add_around(place, 2000, 0.0, random, alone);
  const PoseHypothesis mean = mean_near(alone, place, 1.0, 1.0);
  EXPECT_NEAR(mean.weight, 1.0, 1e-9);
  EXPECT_NEAR(mean.x_m, place.place_m.x(), 0.01);
  EXPECT_NEAR(mean.y_m, place.place_m.y(), 0.01);
  EXPECT_NEAR(std::remainder(mean.yaw_rad - place.yaw_rad, 2.0 * std::numbers::pi), 0.0, 0.005);
  EXPECT_NEAR(mean.deviation_m, std::sqrt(2.0 / 3.0) * 0.1, 0.003);
  EXPECT_NEAR(mean.deviation_rad, std::sqrt(1.0 / 3.0) * 0.05, 0.0015);
  Particles two = alone;
  add_around({{-8.0, 5.0}, 0.0}, 6000, 0.0, random, two);
  const PoseHypothesis again = mean_near(two, place, 1.0, 1.0);
  EXPECT_NEAR(again.weight, 0.25, 1e-9);
  EXPECT_NEAR(again.deviation_m, mean.deviation_m, 1e-9);
  EXPECT_NEAR(again.deviation_rad, mean.deviation_rad, 1e-9);
}

// Kills a place that is less likely, but possible, and is not reported.
TEST(Particles, EachPlaceIsAGroupWithItsShare) {
  std::mt19937_64 random(9);
  Particles particles;
  add_around({{0.0, 0.0}, 0.0}, 700, 0.0, random, particles);
  add_around({{5.0, 0.0}, 0.0}, 250, 0.0, random, particles);
  add_around({{0.0, 0.0}, 2.0}, 45, 0.0, random, particles);  // the same place, turned
  add_around({{0.0, 9.0}, 0.0}, 5, 0.0, random, particles);
  const std::vector<PoseHypothesis> groups = groups_of(particles);
  ASSERT_EQ(groups.size(), 4U);
  const std::vector<double> weights = {0.7, 0.25, 0.045, 0.005};
  for (std::size_t g = 0; g < groups.size(); ++g) EXPECT_NEAR(groups[g].weight, weights[g], 1e-9);
  EXPECT_NEAR(groups[1].x_m, 5.0, 0.05);
  EXPECT_NEAR(groups[2].yaw_rad, 2.0, 0.05);
  EXPECT_NEAR(groups[3].y_m, 9.0, 0.15);
}

}  // namespace
}  // namespace pingvox::test
