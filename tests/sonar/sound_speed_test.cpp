#include "pingvox/sonar/sound_speed.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace pingvox {
namespace {

// Kills a wrong coefficient: values by other authors' equations (UNESCO 1983 for sea water, Marczak 1997 for fresh).
TEST(SoundSpeed, AgreesWithOtherEquations) {
  struct Case {
    Water water;
    double speed_m_s;
  };
  const std::array<Case, 8> cases = {{{{0.0, 35.0, 0.0}, 1449.1},
                                      {{10.0, 35.0, 0.0}, 1489.8},
                                      {{20.0, 35.0, 0.0}, 1521.5},
                                      {{30.0, 35.0, 0.0}, 1545.6},
                                      {{10.0, 0.0, 0.0}, 1447.3},
                                      {{20.0, 0.0, 0.0}, 1482.3},
                                      {{10.0, 35.0, 1000.0}, 1506.5},
                                      {{2.0, 35.0, 4000.0}, 1526.0}}};
  for (const Case& c : cases) {
    EXPECT_NEAR(sound_speed_m_s(c.water), c.speed_m_s, 0.6)
        << c.water.temperature_c << ", " << c.water.salinity << ", " << c.water.depth_m;
  }
}

TEST(SoundSpeed, WaterOutsideOfTheEquationIsRefused) {
  EXPECT_TRUE((Water{20.0, 0.0, 0.0}.validate()));
  for (const Water& water : {Water{-1.0, 0.0, 0.0}, Water{36.0, 0.0, 0.0}, Water{20.0, -1.0, 0.0},
                             Water{20.0, 46.0, 0.0}, Water{20.0, 0.0, 4001.0}, Water{std::nan(""), 0.0, 0.0}}) {
    EXPECT_FALSE(water.validate());
  }
}

}  // namespace
}  // namespace pingvox
