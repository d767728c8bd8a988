// How much a vehicle's velocity changes, told from the noise of a DVL.

#include "slam/steady_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "pingvox/geometry/random.hpp"

namespace pingvox::test {
namespace {

/// Three samples a second for five minutes with noise of 0.1 m/s on each axis.
VelocitySource measured(const auto& ahead_m_s) {
  Random random(3);
  NavSource source{"dvl", NavQuantity::kVelocity, {}};
  for (int i = 0; i < 900; ++i) {
    NavSample sample;
    sample.time_s = i / 3.0;
    sample.value.x() = ahead_m_s(sample.time_s) + 0.1 * random.normal();
    sample.value.y() = 0.1 * random.normal();
    source.samples.push_back(sample);
  }
  return *velocity_source(source, Pose::Identity());
}

// Kills a measure that takes the noise for motion.
TEST(VelocityChange, IsSmallForASteadyVehicleAndLargeForOneThatIsNot) {
  const double steady = velocity_change(measured([](double) { return 0.3; }));
  const double swaying = velocity_change(measured([](double time_s) { return 0.3 + 0.3 * std::sin(0.5 * time_s); }));
  EXPECT_LT(steady, 0.005);
  EXPECT_GT(swaying, 0.05);
  EXPECT_LT(swaying, 0.4);
}

// Kills a pull that does not bring a knot back, and one along which a steady way is not at rest.
TEST(SteadyMotion, PullsAKnotBackThatIsOffASteadyWay) {
  const VelocitySource velocity = measured([](double) { return 0.3; });
  const HeadingSource heading{"compass", TimeSeries({0.0, 300.0}, {0.0, 0.0}), std::nullopt, std::nullopt};
  const VelocitySource steady{"dvl", TimeSeries({0.0, 300.0}, {0.3, 0.3}), TimeSeries({0.0, 300.0}, {0.0, 0.0}),
                              velocity.density};
  const SlamProblem problem({0.0, 2.0, 4.0}, steady, {heading});
  Unknowns unknowns = problem.dead_reckoning();
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs = {{0, 1}, {1, 2}, {0, 2}};
  const auto gradient = [&] {
    NormalEquations equations(3, problem.globals(), pairs);
    add_steady_motion(problem, unknowns, problem.ways(unknowns), 0.01, equations);
    return equations.gradient;
  };
  EXPECT_LT(gradient().head<9>().norm(), 1e-6);
  unknowns.knots[1].x() += 0.1;
  // It seems 0.05 m/s faster before and slower after, with a weight of one over 1e-4 times two thirds of 2 s.
  EXPECT_NEAR(gradient()[0], -375.0, 1.0);
  EXPECT_NEAR(gradient()[3], 750.0, 1.0);
  EXPECT_NEAR(gradient()[6], -375.0, 1.0);
}

}  // namespace
}  // namespace pingvox::test
