#include <gtest/gtest.h>

#include <cmath>

#include "pingvox/sonar/sound_speed.hpp"

namespace pingvox {
namespace {

/// Mackenzie 1981, for the open sea: 2 to 30 degrees, salinities of 25 to 40, down to 8 km.
double mackenzie_m_s(double t, double s, double d) {
  return 1448.96 + 4.591 * t - 5.304e-2 * t * t + 2.374e-4 * t * t * t + 1.340 * (s - 35.0) + 1.630e-2 * d +
         1.675e-7 * d * d - 1.025e-2 * t * (s - 35.0) - 7.139e-13 * t * d * d * d;
}

/// Marczak 1997, for pure water at the pressure of air.
double marczak_m_s(double t) {
  return 1402.385 + t * (5.038813 + t * (-5.799136e-2 + t * (3.287156e-4 + t * (-1.398845e-6 + t * 2.787860e-9))));
}

// Kills a wrong coefficient of a small term, which a few values do not show.
TEST(SoundSpeedEquations, AgreeAllOverTheSea) {
  int cases = 0;
  for (double t = 2.0; t <= 20.0; t += 2.0) {
    for (double s = 32.0; s <= 38.0; s += 1.0) {
      for (double d = 0.0; d <= 4000.0; d += 250.0, ++cases) {
        ASSERT_NEAR(sound_speed_m_s({t, s, d}), mackenzie_m_s(t, s, d), d > 1000.0 ? 0.55 : 0.35)
            << t << " degrees, salinity " << s << ", " << d << " m";
      }
    }
  }
  EXPECT_EQ(cases, 10 * 7 * 17);
}

TEST(SoundSpeedEquations, AgreeInFreshWater) {
  for (int t = 0; t <= 35; ++t) ASSERT_NEAR(sound_speed_m_s({1.0 * t, 0.0, 0.0}), marczak_m_s(t), 0.12) << t;
}

}  // namespace
}  // namespace pingvox
