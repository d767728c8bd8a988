// How much a vehicle's velocity changes, told from the noise of a DVL.

#include "slam/smoother/steady_motion.hpp"

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

// Kills a stop that is smoothed away.
TEST(SteadyMotion, HardlyCountsWhereTheVehicleStops) {
  const VelocitySource velocity = measured([](double) { return 0.3; });
  const HeadingSource heading{"compass", TimeSeries({0.0, 300.0}, {0.0, 0.0}), std::nullopt, std::nullopt};
  const VelocitySource stops{"dvl", TimeSeries({0.0, 150.0, 150.01, 300.0}, {0.3, 0.3, 0.0, 0.0}),
                             TimeSeries({0.0, 300.0}, {0.0, 0.0}), velocity.density};
  const SlamProblem problem({148.0, 150.0, 152.0}, stops, {heading});
  const Unknowns unknowns = problem.dead_reckoning();
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs = {{0, 1}, {1, 2}, {0, 2}};
  NormalEquations equations(3, problem.globals(), pairs);
  add_steady_motion(problem, unknowns, problem.ways(unknowns), 0.01, equations);
  // 0.3 m/s slower, with a weight as above, it would be 2250.
  EXPECT_LT(std::abs(equations.gradient[3]), 100.0);
  EXPECT_GT(std::abs(equations.gradient[3]), 10.0);
}

// How fast the velocity changes does not depend on where north is, on how the DVL is turned, nor on its scale.
// Kills derivatives that are left out: those of the frame, by which north or scale crept away over many knots.
TEST(SteadyMotion, DoesNotPullAtWhatItSaysNothingOf) {
  const VelocitySource velocity = measured([](double time_s) { return 0.3 + 0.1 * std::sin(0.2 * time_s); });
  const HeadingSource heading{"compass", TimeSeries({0.0, 300.0}, {0.0, 12.0}), std::nullopt, std::nullopt};
  std::vector<double> times_s;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t k = 0; k < 40; ++k) {
    times_s.push_back(7.0 * k + (k % 3));
    if (k > 0) pairs.emplace_back(k - 1, k);
    if (k > 1) pairs.emplace_back(k - 2, k);
  }
  const SlamProblem problem(times_s, velocity, {heading});
  Random random(5);
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE(round);
    Unknowns unknowns = problem.dead_reckoning();
    for (Eigen::Vector3d& knot : unknowns.knots) {
      knot += Eigen::Vector3d(0.3 * random.normal(), 0.3 * random.normal(), 0.1 * random.normal());
    }
    const double scale = 1.0 + 0.02 * random.normal();
    unknowns.globals[global::kVelocityYaw] = 0.2 * random.normal();
    unknowns.globals[global::kVelocityScale] = scale - 1.0;
    NormalEquations equations(problem.knots(), problem.globals(), pairs);
    add_steady_motion(problem, unknowns, problem.ways(unknowns), 0.01, equations);
    const auto knots = static_cast<Eigen::Index>(3 * problem.knots());
    double by_turn = 0.0, by_north = 0.0, by_size = 0.0;
    for (std::size_t k = 0; k < problem.knots(); ++k) {
      const Eigen::Vector3d pull = equations.gradient.segment<3>(static_cast<Eigen::Index>(3 * k));
      by_turn += pull.z() + unknowns.knots[k].x() * pull.y() - unknowns.knots[k].y() * pull.x();
      by_north += pull.z();
      by_size += unknowns.knots[k].head<2>().dot(pull.head<2>()) / scale;
    }
    const double least = 1e-9 * equations.gradient.cwiseAbs().sum();
    EXPECT_NEAR(by_turn, 0.0, 100.0 * least);
    EXPECT_NEAR(by_north, equations.gradient[knots + Eigen::Index{global::kVelocityYaw}], least);
    EXPECT_NEAR(by_size, -equations.gradient[knots + Eigen::Index{global::kVelocityScale}], 100.0 * least);
  }
}

}  // namespace
}  // namespace pingvox::test
