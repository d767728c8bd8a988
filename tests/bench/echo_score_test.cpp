#include "accuracy/echo_score.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

namespace pingvox::bench {
namespace {

constexpr EchoJudge kJudge{.bin_length_m = 0.02, .min_range_m = 0.75, .range_m = 5.0};

std::optional<Echo> echo_at(double range_m) {
  return Echo{.first = 0, .peak = 0, .last = 0, .range_m = range_m, .intensity = 100};
}

/// A wall at 3 m on the axis, seen to 3.2 m at the edge of the cone and to 4 m by the rest of the lobe.
TrueReturns wall() {
  return {.axis_m = 3.0, .returns = {{3.0, 3.2}}, .lobe = {{3.0, 4.0}}};
}

EchoScore of_one(const std::optional<Echo>& echo, const TrueReturns& truth) {
  return score_echoes(std::vector{echo}, std::vector{truth}, kJudge);
}

TEST(EchoScore, CountsByHowFarOffTheEchoIs) {
  EXPECT_EQ(of_one(echo_at(3.015), wall()).axis.within_1_bin, 1U);
  EXPECT_EQ(of_one(echo_at(2.97), wall()).axis.within_1_bin, 0U);
  EXPECT_EQ(of_one(echo_at(2.97), wall()).axis.within_2_bins, 1U);
  EXPECT_EQ(of_one(echo_at(2.93), wall()).axis.within_5cm, 0U);
  EXPECT_EQ(of_one(echo_at(2.93), wall()).axis.within_10cm, 1U);
  EXPECT_EQ(of_one(echo_at(2.89), wall()).axis.wrong, 1U);
  EXPECT_EQ(of_one(std::nullopt, wall()).axis.missed, 1U);
}

TEST(EchoScore, AWallBesideTheAxisIsAReturnAndNotTheAxis) {
  const EchoScore score = of_one(echo_at(3.19), wall());
  EXPECT_EQ(score.axis.wrong, 1U);
  EXPECT_EQ(score.returns.within_1_bin, 1U);
  EXPECT_EQ(score.false_echoes(), 0U);
  EXPECT_EQ(score.late, 1U);
}

TEST(EchoScore, TellsEchoesOfTheLobeBeyondTheConeFromEchoesOfNothing) {
  const EchoScore beyond = of_one(echo_at(3.8), wall());
  EXPECT_EQ(beyond.false_echoes(), 1U);
  EXPECT_EQ(beyond.beyond_cone, 1U);
  const EchoScore nothing = of_one(echo_at(1.5), wall());
  EXPECT_EQ(nothing.false_echoes(), 1U);
  EXPECT_EQ(nothing.beyond_cone, 0U);
}

TEST(EchoScore, ASilentBeamWantsNoEcho) {
  const TrueReturns nothing;
  EXPECT_EQ(of_one(std::nullopt, nothing).silent_beams, 1U);
  EXPECT_EQ(of_one(std::nullopt, nothing).false_echoes(), 0U);
  EXPECT_EQ(of_one(echo_at(2.0), nothing).false_echoes(), 1U);
  EXPECT_EQ(of_one(echo_at(2.0), nothing).axis.beams, 0U);
}

TEST(EchoScore, WhatLiesInTheBlankingIsNotMissed) {
  TrueReturns near;
  near.axis_m = 0.5;
  near.returns = {{0.5, 0.6}};
  const EchoScore score = of_one(std::nullopt, near);
  EXPECT_EQ(score.axis.beams, 0U);
  EXPECT_EQ(score.returns.beams, 0U);
}

TEST(EchoScore, ChanceIsTheShareOfRangesThatWouldBeRight) {
  EXPECT_NEAR(of_one(std::nullopt, wall()).chance_5cm, 0.3 / 4.25, 1e-12);
}

TEST(Spans, AreJoinedWhereTheyTouch) {
  const std::vector<Span> apart = join({{3.0, 4.0}, {1.0, 2.0}, {2.0, 2.5}, {3.5, 3.6}});
  ASSERT_EQ(apart.size(), 2U);
  EXPECT_EQ(apart[0].first_m, 1.0);
  EXPECT_EQ(apart[0].last_m, 2.5);
  EXPECT_EQ(apart[1].last_m, 4.0);
}

}  // namespace
}  // namespace pingvox::bench
