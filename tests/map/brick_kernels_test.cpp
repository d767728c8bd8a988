#include <gtest/gtest.h>

#include <random>

#include "map/kernels/brick.hpp"
#include "support/lanes.hpp"

namespace pingvox::detail {
namespace {

constexpr Clamp kClamp{LogOdds(-2.0F), LogOdds(3.5F)};

Brick random_brick(std::mt19937_64& random) {
  // Few different values, the clamps among them and values beyond them, so that equal ones and stable ones occur.
  constexpr std::array<float, 8> kValues{-2.5F, -2.0F, -1.9F, -0.4F, 0.0F, 0.85F, 3.5F, 4.0F};
  Brick brick;
  brick.known = random() | random();
  const float same = kValues[random() % 8];
  const bool is_uniform = random() % 4 == 0;
  for (std::size_t i = 0; i < 64; ++i) {
    if ((brick.known >> i) & 1) brick.value[i] = is_uniform ? same : kValues[random() % 8];
  }
  return brick;
}

TEST(BrickKernels, GiveWhatThePlainLoopsGive) {
  std::size_t uniform = 0, unchanged = 0;
  for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Brick brick = random_brick(random);
    if (seed % 5 == 0) brick.known = ~std::uint64_t{0};

    float highest = std::numeric_limits<float>::lowest();
    bool equal = true;
    for (std::size_t i = 0; i < 64; ++i) {
      if ((brick.known >> i) & 1) highest = std::max(highest, brick.value[i]);
      equal &= brick.value[i] == brick.value[0];
    }
    for (const Lanes lanes : lanes_here()) {
      EXPECT_EQ(highest_of(brick, lanes), highest);
      EXPECT_EQ(are_equal(brick, lanes), equal);
    }
    uniform += equal;

    const std::uint64_t missed = seed % 7 == 0 ? 0 : random() & random();
    const LogOdds evidence(seed % 2 == 0 ? -0.4F : 0.85F);
    Brick plain = brick;
    bool changed = false;
    for (std::size_t i = 0; i < 64; ++i) {
      if (!((missed >> i) & 1)) continue;
      const float after = updated_by(LogOdds(plain.value[i]), evidence, kClamp).value();
      changed |= after != plain.value[i];
      plain.value[i] = after;
    }
    for (const Lanes lanes : lanes_here()) {
      Brick voted = brick;
      EXPECT_EQ(add_alike(voted, missed, evidence.value(), kClamp, lanes), changed);
      EXPECT_EQ(voted.value, plain.value);
    }
    unchanged += !changed;
  }
  EXPECT_GT(uniform, 100U);
  EXPECT_GT(unchanged, 1'000U);
}

}  // namespace
}  // namespace pingvox::detail
