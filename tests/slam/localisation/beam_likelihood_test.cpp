#include "slam/localisation/beam_likelihood.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/room.hpp"

namespace pingvox::test {
namespace {

// From the middle of the room to its wall, which is 3 m behind.
class BeamJudgeInRoom : public testing::Test {
 protected:
  double likelihood(double range_m, bool has_echo) const {
    const HeardBeam beam{.direction = -Eigen::Vector2d::UnitX(), .range_m = range_m, .has_echo = has_echo};
    return std::exp(BeamJudge(beam, *field_, model_).log_likelihood(PlaneFrame(Pose2{})));
  }

  Result<DistanceField> field_ = DistanceField::make(Room().map(), {});
  BeamLikelihood model_;
};

TEST_F(BeamJudgeInRoom, ExpectsAnEchoOfAWallInRange) {
  ASSERT_TRUE(field_);
  EXPECT_DOUBLE_EQ(likelihood(5.0, false), model_.silent_wall);
  EXPECT_DOUBLE_EQ(likelihood(2.0, false), 1.0);
}

TEST_F(BeamJudgeInRoom, ExpectsTheEchoWhereTheWallIs) {
  ASSERT_TRUE(field_);
  EXPECT_GT(likelihood(3.0, true), 0.7);  // the middle of its cell may be half a cell off
  EXPECT_NEAR(likelihood(1.5, true), model_.stray, 0.01);
  EXPECT_NEAR(likelihood(4.5, true), model_.behind, 0.01);
}

}  // namespace
}  // namespace pingvox::test
