#include "map/brick_loops.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <random>

#include "map/bits.hpp"
#include "map/brick_tree.hpp"

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

TEST(BrickLoops, GiveWhatThePlainLoopsGive) {
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
    EXPECT_EQ(highest_of(brick), highest);
    EXPECT_EQ(are_equal(brick), equal);
    uniform += equal;

    const std::uint64_t missed = seed % 7 == 0 ? 0 : random() & random();
    const LogOdds evidence(seed % 2 == 0 ? -0.4F : 0.85F);
    Brick plain = brick;
    bool changed = false;
    for (std::size_t i = 0; i < 64; ++i) {
      if (!((missed >> i) & 1)) continue;
      const float after = add_evidence(LogOdds(plain.value[i]), evidence, kClamp).value();
      changed |= after != plain.value[i];
      plain.value[i] = after;
    }
    Brick updated = brick;
    EXPECT_EQ(add_alike(updated, missed, evidence.value(), kClamp), changed);
    EXPECT_EQ(updated.value, plain.value);
    unchanged += !changed;
  }
  EXPECT_GT(uniform, 100U);
  EXPECT_GT(unchanged, 1'000U);
}

TEST(BrickLoops, MasksAreWhatThePlainLoopsGive) {
  std::size_t octants = 0, uniform = 0, from = 0;
  for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Brick brick = random_brick(random);
    if (seed % 3 == 0) {
      for (std::size_t o = 0; o < 8; ++o) {
        if (random() % 2 == 0) std::fill_n(brick.value.begin() + static_cast<std::ptrdiff_t>(o * 8), 8, -2.0F);
        if (random() % 2 == 0) brick.known |= std::uint64_t{0xFF} << (o * 8);
      }
    }

    unsigned differ = 0, full = 0;
    std::uint64_t joined = 0;
    for (std::size_t o = 0; o < 8; ++o) {
      const auto first = brick.value.begin() + static_cast<std::ptrdiff_t>(o * 8);
      const bool is_equal = std::all_of(first, first + 8, [&](float value) { return value == *first; });
      const bool is_full = (brick.known >> (o * 8) & 0xFF) == 0xFF;
      differ |= static_cast<unsigned>(!is_equal) << o;
      full |= static_cast<unsigned>(is_full) << o;
      if (is_equal && is_full) joined |= std::uint64_t{0xFF} << (o * 8);
      octants += is_full;
      uniform += is_equal && is_full;
    }
    EXPECT_EQ(octants_that_differ(brick), differ);
    EXPECT_EQ(full_bytes(brick.known), full);
    EXPECT_EQ(cells_of_uniform_octants(brick), joined);

    for (const float threshold : {-2.0F, -0.0F, 0.85F}) {
      std::uint64_t cells = 0;
      for (std::size_t i = 0; i < 64; ++i) cells |= std::uint64_t{brick.value[i] >= threshold} << i;
      EXPECT_EQ(cells_from(brick, threshold), cells);
      from += static_cast<std::size_t>(std::popcount(cells));
    }

    const std::uint64_t a = random() & random(), b = random() & ~a;
    std::array<float, 64> filled{};
    for (std::size_t i = 0; i < 64; ++i) filled[i] = (a >> i & 1) != 0 ? -2.0F : ((b >> i & 1) != 0 ? 3.5F : 0.0F);
    fill(brick, a, -2.0F, b, 3.5F);
    EXPECT_EQ(brick.value, filled);
  }
  EXPECT_GT(octants, 10'000U);
  EXPECT_GT(uniform, 1'000U);
  EXPECT_GT(from, 100'000U);
}

TEST(BrickLoops, BitsAreCountedAndVisited) {
  for (std::uint64_t seed = 1; seed <= 1'000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const std::uint64_t used = seed % 10 == 0 ? 0 : (seed % 10 == 1 ? ~std::uint64_t{0} : random() & random());
    EXPECT_EQ(count_bits(used), static_cast<std::uint64_t>(std::popcount(used)));
    std::uint64_t visited = 0;
    for_each_bit(used, [&](std::size_t bit) { visited |= std::uint64_t{1} << bit; });
    EXPECT_EQ(visited, used);
  }
}

TEST(BrickLoops, MasksOfOctantsAreTheirBytes) {
  for (unsigned octants = 0; octants < 256; ++octants) {
    std::uint64_t cells = 0;
    for (std::size_t o = 0; o < 8; ++o) cells |= (octants >> o & 1) != 0 ? std::uint64_t{0xFF} << (o * 8) : 0;
    EXPECT_EQ(cells_of_octants(octants), cells);
    EXPECT_EQ(full_bytes(cells), octants);
    EXPECT_EQ(bytes_in_use(cells), octants);
    EXPECT_EQ(bytes_in_use(cells & 0x0180401008040220), octants);  // one bit of each byte
  }
}

}  // namespace
}  // namespace pingvox::detail
