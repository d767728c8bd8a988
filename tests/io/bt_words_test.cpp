#include "io/maps/bt_words.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace pingvox {
namespace {

std::uint64_t byte_of(std::uint64_t mask, std::size_t octant) {
  return mask >> (octant * 8) & 0xFF;
}

/// Masks without a common bit; of each octant often all cells alike.
std::array<std::uint64_t, 2> random_masks(std::mt19937_64& random) {
  std::uint64_t free = random(), occupied = random() & ~free;
  for (std::size_t octant = 0; octant < 8; ++octant) {
    const std::uint64_t cells = std::uint64_t{0xFF} << (octant * 8);
    const auto kind = random() % 5;
    if (kind < 3) {
      free &= ~cells;
      occupied &= ~cells;
    }
    if (kind == 1) free |= cells;
    if (kind == 2) occupied |= cells;
  }
  return {free, occupied};
}

// Kills bits that go to another octant's word or to another child, a word that is taken for alike.
TEST(BtWords, OfABrickAreThoseOfItsOctants) {
  std::size_t alike = 0, all_mixed = 0;
  for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto [free, occupied] = random_masks(random);
    const EightWords words = words_of(free, occupied);
    const EightWords are_mixed = mixed_words(words);
    unsigned above = 0;
    for (std::size_t octant = 0; octant < 8; ++octant) {
      const unsigned word =
          word_of(static_cast<unsigned>(byte_of(free, octant)), static_cast<unsigned>(byte_of(occupied, octant)));
      ASSERT_EQ(words[octant], word);
      ASSERT_EQ(states_of(word).free, byte_of(free, octant));
      ASSERT_EQ(states_of(word).occupied, byte_of(occupied, octant));
      ASSERT_EQ(are_mixed[octant], is_uniform(word) ? 0 : 0xFFFF);
      above |= (is_uniform(word) ? word & 3U : bt::kInner) << (2 * octant);
      alike += is_uniform(word);
    }
    ASSERT_EQ(word_above(words, are_mixed), above);
    all_mixed += above == 0xFFFF;
  }
  EXPECT_GT(alike, 50'000U);
  EXPECT_GT(all_mixed, 5U);
}

TEST(BtWords, FillWholeOctants) {
  for (unsigned octants = 0; octants <= 0xFF; ++octants) {
    for (std::size_t octant = 0; octant < 8; ++octant) {
      ASSERT_EQ(byte_of(whole_octants(octants), octant), (octants >> octant & 1U) != 0 ? 0xFFU : 0U) << octants;
    }
  }
}

TEST(BtWords, NameTheirChildren) {
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    unsigned children = 0;
    for (std::size_t octant = 0; octant < 8; ++octant) children += state_of(word, octant) != bt::kUnknown;
    ASSERT_EQ(children_of(word), children);
  }
}

}  // namespace
}  // namespace pingvox
