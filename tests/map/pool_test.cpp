#include "map/pool.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <utility>

namespace pingvox::detail {
namespace {

/// Each word is its number + 1, from the first one on.
void write_words(Arena& arena, std::size_t first) {
  for (std::size_t at = first; at + 8 <= arena.size(); at += 8) {
    const std::uint64_t word = at + 1;
    std::memcpy(arena.data() + at, &word, sizeof word);
  }
}
std::size_t words_that_differ(const Arena& arena) {
  std::size_t differ = 0;
  for (std::size_t at = 0; at + 8 <= arena.size(); at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, arena.data() + at, sizeof word);
    differ += word != at + 1;
  }
  return differ;
}
std::size_t bytes_in_use(const Arena& arena, std::size_t first) {
  std::size_t used = 0;
  for (std::size_t at = first; at < arena.size(); ++at) used += arena.data()[at] != std::byte{0};
  return used;
}

TEST(Arena, KeepsWhatWasWrittenAndHandsOutZeroes) {
  for (const Arena::Pages pages : {Arena::Pages::kHuge, Arena::Pages::kSmall}) {
    Arena arena(pages);
    std::size_t steps = 0;
    // Byte by byte beyond what there is, as a pool grows: past steps that are made ready, and past huge pages.
    while (arena.size() < (std::size_t{5} << 20)) {
      SCOPED_TRACE(arena.size());
      const std::size_t before = arena.size();
      arena.grow(before + 1);
      ASSERT_GT(arena.size(), before);
      ASSERT_LE(arena.size(), before + before / 2 + 4096);
      ASSERT_EQ(bytes_in_use(arena, before), 0U);
      write_words(arena, before);
      ++steps;
    }
    EXPECT_GT(steps, 10U);
    EXPECT_EQ(words_that_differ(arena), 0U);
  }
}

TEST(Arena, GrowsByAsMuchAsIsAskedFor) {
  for (const std::size_t size : {1UL, 4096UL, 4097UL, 65537UL, 300'000UL, 3'000'000UL}) {
    SCOPED_TRACE(size);
    Arena arena;
    for (const std::size_t asked : {size, 3 * size}) {
      arena.grow(asked);
      ASSERT_GE(arena.size(), asked);
      write_words(arena, 0);
      EXPECT_EQ(words_that_differ(arena), 0U);
    }
  }
}

TEST(Arena, MovesWithAllOfItsRoom) {
  Arena from;
  for (std::size_t i = 0; i < 12; ++i) from.grow(from.size() + 1);
  write_words(from, 0);
  const std::size_t size = from.size();
  Arena to(std::move(from));
  from = Arena();
  for (Arena* const arena : {&from, &to}) arena->grow(arena->size() + 1);  // a second owner of the room would crash
  write_words(from, 0);
  write_words(to, size);
  EXPECT_EQ(words_that_differ(to), 0U);
  from = std::move(to);
  EXPECT_EQ(words_that_differ(from), 0U);
  EXPECT_GT(from.size(), size);
}

}  // namespace
}  // namespace pingvox::detail
