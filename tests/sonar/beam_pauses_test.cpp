// Pauses of a head, from the times of its beams.
#include "pingvox/sonar/beam_pauses.hpp"

#include <gtest/gtest.h>

namespace pingvox {
namespace {

/// 100 beams, 0.1 s apart, with pauses of 4 and 6 s, and then one beam that is late.
BeamPauses pauses_of_a_head(double start_s) {
  BeamPauseCounter counter;
  double time_s = start_s;
  for (int beam = 0; beam < 100; ++beam) {
    counter.add(time_s);
    time_s += beam == 30 ? 4.0 : beam == 60 ? 6.0 : 0.1;
  }
  counter.add(start_s + 1.0);
  return counter.pauses();
}

TEST(BeamPauses, AreFarLongerThanTheOtherSteps) {
  const BeamPauses pauses = pauses_of_a_head(0.0);
  EXPECT_EQ(pauses.count, 2U);
  EXPECT_NEAR(pauses.total_s, 10.0, 1e-9);
  EXPECT_NEAR(pauses.longest_s, 6.0, 1e-9);
  EXPECT_NEAR(pauses.median_s, 6.0, 1e-9) << "the upper one of two";
}

// Kills a first beam whose time is taken for a pause.
TEST(BeamPauses, DoNotDependOnWhenTheClockBegan) {
  for (const double start_s : {-5000.0, 3600.0, 1.7e9}) {
    const BeamPauses pauses = pauses_of_a_head(start_s);
    EXPECT_EQ(pauses.count, 2U) << start_s;
    EXPECT_NEAR(pauses.total_s, 10.0, 1e-5) << start_s;
  }
}

// Kills pauses of a head that is slow all the time.
TEST(BeamPauses, AHeadWithSlowBeamsHasNone) {
  BeamPauseCounter counter;
  for (int beam = 0; beam < 50; ++beam) counter.add(2.0 * beam + (beam % 2 == 0 ? 0.0 : 0.5));
  EXPECT_EQ(counter.pauses().count, 0U);
}

TEST(BeamPauses, OfNoBeamOrOneAreNone) {
  BeamPauseCounter counter;
  EXPECT_EQ(counter.pauses().count, 0U);
  counter.add(17.0);
  EXPECT_EQ(counter.pauses().count, 0U);
}

}  // namespace
}  // namespace pingvox
