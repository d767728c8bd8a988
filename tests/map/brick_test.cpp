#include "map/brick.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <map>
#include <new>
#include <random>
#include <utility>

namespace pingvox::detail {
namespace {

/// One that no other number gives.
Brick brick_number(std::uint64_t number) {
  Brick brick;
  brick.known = number * 0x9E3779B97F4A7C15U;
  for (std::size_t cell = 0; cell < 64; ++cell) brick.value[cell] = static_cast<float>(number * 64 + cell);
  return brick;
}

using Numbers = std::map<std::uint32_t, std::uint64_t>;  ///< of bricks, by index

std::size_t bricks_that_differ(const BrickPool& pool, const Numbers& numbers) {
  std::size_t differ = 0;
  for (const auto& [index, number] : numbers) {
    const Brick expected = brick_number(number);
    differ += pool[index].known != expected.known || pool[index].value != expected.value;
  }
  return differ;
}

// Kills known cells of one brick beside the values of another: in new and used places, after growing, in copies.
TEST(BrickPool, KeepsKnownCellsWithTheirValues) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    BrickPool pool;
    Numbers numbers;
    for (std::uint64_t number = 1; number <= 4000; ++number) {
      const std::uint32_t index = pool.allocate(brick_number(number));
      ASSERT_TRUE(numbers.emplace(index, number).second);
      if (random() % 3 != 0) continue;
      const auto other = numbers.lower_bound(static_cast<std::uint32_t>(random() % (number + 2)));
      if (other == numbers.end()) continue;
      pool.release(other->first);
      numbers.erase(other);
    }
    EXPECT_EQ(bricks_that_differ(pool, numbers), 0U);
    EXPECT_EQ(pool.bytes(), (numbers.size() + pool.spare()) * sizeof(Brick));

    BrickPool copy(pool);
    const auto [index, number] = *numbers.begin();
    pool[index].known = 0;
    pool[index].value.fill(0.0F);
    EXPECT_EQ(bricks_that_differ(copy, numbers), 0U);
    EXPECT_EQ(bricks_that_differ(pool, numbers), 1U);
    BrickPool moved(std::move(copy));
    numbers.emplace(moved.allocate(brick_number(5000)), 5000);
    EXPECT_EQ(bricks_that_differ(moved, numbers), 0U);
  }
}

// Kills indices that part ways when there is memory for the known cells of a brick and none for its values.
TEST(BrickPool, GoesOnAfterMemoryRanOut) {
#if defined(PINGVOX_SANITIZE_ADDRESS) || defined(PINGVOX_SANITIZE_THREAD)
  GTEST_SKIP() << "an allocation that fails ends a program with a sanitizer";
#endif
  std::ifstream statm("/proc/self/statm");
  rlim_t pages = 0;
  rlimit before = {};
  if (!(statm >> pages) || ::getrlimit(RLIMIT_AS, &before) != 0) GTEST_SKIP() << "no limit for memory here";
  BrickPool pool;
  Numbers numbers;
  std::uint64_t number = 1;
  const auto allocate = [&] {
    numbers.emplace(pool.allocate(brick_number(number)), number);
    ++number;
  };
  rlimit small = before;
  small.rlim_cur = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + (rlim_t{8} << 20);
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &small), 0);
  bool has_run_out = false;
  try {
    while (number < 100'000) allocate();
  } catch (const std::bad_alloc&) {
    has_run_out = true;
  }
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &before), 0);
  ASSERT_TRUE(has_run_out && !numbers.empty());
  pool.release(numbers.begin()->first);
  numbers.erase(numbers.begin());
  for (int i = 0; i < 1000; ++i) allocate();
  EXPECT_EQ(numbers.size(), number - 2);
  EXPECT_EQ(bricks_that_differ(pool, numbers), 0U);
}

}  // namespace
}  // namespace pingvox::detail
