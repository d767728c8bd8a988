#include "pingvox/geometry/key.hpp"

#include <gtest/gtest.h>

using namespace pingvox;

namespace {

TEST(Key, WidthIsTheNarrowestThatHoldsTheDepth) {
  for (int depth = 1; depth <= kMaxDepth; ++depth) {
    const int levels = with_key_word(depth, []<KeyWord W>() { return kLevelsOf<W>; });
    const int expected = depth <= 8 ? 8 : depth <= 16 ? 16 : depth <= 32 ? 32 : depth <= 64 ? 64 : 128;
    EXPECT_EQ(levels, expected) << depth;
  }
}

TEST(Key, OctantTakesOneBitOfEachComponentUpToTheHighest) {
  const BasicKey<std::uint8_t> narrow{0x80, 0x01, 0x81};
  EXPECT_EQ(narrow.octant(7), 1 | 4);
  EXPECT_EQ(narrow.octant(0), 2 | 4);
  EXPECT_EQ(narrow.octant(3), 0);
  const WideKey wide{0, WideWord{1} << 127, 1};
  EXPECT_EQ(wide.octant(127), 2);
  EXPECT_EQ(wide.octant(0), 4);
}

TEST(Key, KeepsItsComponentsInAnotherWidth) {
  const BasicKey<std::uint8_t> narrow{255, 0, 7};
  EXPECT_EQ(narrow.as<WideWord>(), (WideKey{255, 0, 7}));
  EXPECT_EQ(narrow.as<WideWord>().as<std::uint8_t>(), narrow);
}

}  // namespace
