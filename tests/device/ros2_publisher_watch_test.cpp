#include "device/internal/ros2_publisher_watch.hpp"

#include <gtest/gtest.h>

#include <initializer_list>

namespace pingvox {
namespace {

/// How many are found by messages of these publishers, so many seconds apart.
std::size_t together(std::initializer_list<std::uint64_t> publishers, double step_s = 0.1) {
  Ros2PublisherWatch watch;
  double now_s = 0.0;
  for (const std::uint64_t publisher : publishers) watch.note(publisher, now_s += step_s);
  return watch.together();
}

TEST(Ros2PublisherWatch, TwoThatGoOnAfterEachOtherAreFound) {
  EXPECT_EQ(together({1, 2, 1, 2, 1, 2}), 2U);
  EXPECT_EQ(together({1, 1, 1, 2, 1, 1, 1, 2, 1, 1, 2}), 2U) << "one of them seldom";
  EXPECT_EQ(together({1, 2, 3, 1, 2, 3, 1, 2, 3}), 3U);
}

// A node that is killed and started again has another number, and the old one stays silent.
TEST(Ros2PublisherWatch, OneThatIsRestartedIsOne) {
  EXPECT_EQ(together({}), 0U);
  EXPECT_EQ(together({1, 1, 1}), 0U);
  EXPECT_EQ(together({1, 1, 2, 2, 3, 3, 4, 4, 5, 5}), 0U);
  EXPECT_EQ(together({1, 1, 2, 1, 2, 2, 2, 2}), 0U) << "its last message came late";
}

// As of a spare node that takes over now and then.
TEST(Ros2PublisherWatch, TurnsThatAreLongAgoDoNotCount) {
  EXPECT_EQ(together({1, 2, 1, 2, 1, 2, 1, 2}, 20.0), 0U);
}

}  // namespace
}  // namespace pingvox
