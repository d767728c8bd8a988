#include "io/nav_sources.hpp"

#include <gtest/gtest.h>

namespace pingvox {
namespace {

// A device that was switched off and on in mid-dive made two maps in one.
TEST(DeadReckoningFrame, EndsWhereTheDeviceStartsAnew) {
  DeadReckoningFrame frame;
  EXPECT_TRUE(frame.holds(0.0, {0.0, 0.0, 0.0}));
  EXPECT_TRUE(frame.holds(0.2, {0.1, 0.0, 0.0}));
  EXPECT_TRUE(frame.holds(9.0, {3.0, 2.0, 0.5}));
  EXPECT_FALSE(frame.holds(12.5, {0.01, 0.0, 0.02}));
  EXPECT_FALSE(frame.holds(12.7, {0.03, 0.0, 0.02})) << "in the other frame";
}

TEST(DeadReckoningFrame, HoldsThroughAPauseAndThroughTheOrigin) {
  DeadReckoningFrame frame;
  EXPECT_TRUE(frame.holds(0.0, {1.5, 0.0, 0.0}));
  EXPECT_TRUE(frame.holds(3.0, {0.5, 0.5, 0.0})) << "a pause";
  EXPECT_TRUE(frame.holds(6.0, {0.05, 0.0, 0.0})) << "it was near the origin before";
  EXPECT_TRUE(frame.holds(6.2, {1.2, 0.0, 0.0}));
  EXPECT_TRUE(frame.holds(6.4, {0.0, 0.0, 0.0})) << "without a pause";
}

TEST(DeadReckoningFrame, EndsWithAStepThatIsTooFast) {
  DeadReckoningFrame frame;
  EXPECT_TRUE(frame.holds(0.0, {5.0, 0.0, 0.0}));
  EXPECT_FALSE(frame.holds(0.2, {0.0, 0.0, 0.0}));
}

}  // namespace
}  // namespace pingvox
