// Derivatives of all residuals against differences, and the way between knots.

#include "slam/smoother/slam_problem.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "slam/smoother/echo_pairs.hpp"
#include "tests/support/uniform.hpp"

namespace pingvox::test {
namespace {

TimeSeries series(double step_s, std::size_t count, double (*value)(double)) {
  std::vector<double> times_s, values;
  for (std::size_t i = 0; i < count; ++i) {
    times_s.push_back(step_s * static_cast<double>(i));
    values.push_back(value(times_s.back()));
  }
  return {times_s, values};
}

/// A vehicle that turns and speeds up, with two headings, one of them in the housing of the velocity's source.
SlamProblem a_problem() {
  VelocitySource velocity{"dvl", series(0.6, 40, [](double t) { return 0.5 + 0.1 * std::sin(t); }),
                          series(0.6, 40, [](double t) { return 0.05 * std::cos(2.0 * t); }),
                          series(0.6, 40, [](double) { return 0.1; }), 0};
  std::vector<HeadingSource> headings;
  headings.push_back({"imu", series(0.1, 240, [](double t) { return 0.3 * t + 0.2 * std::sin(t); }), {}, {}});
  headings.push_back({"dvl", series(0.6, 40, [](double t) { return 0.3 * t + 0.2 * std::sin(t) + 0.1; }), {}, {}});
  return {{0.5, 4.0, 7.0, 11.0, 14.0}, std::move(velocity), std::move(headings)};
}

Unknowns random_unknowns(const SlamProblem& problem, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Unknowns unknowns = problem.dead_reckoning();
  for (Eigen::Vector3d& knot : unknowns.knots) {
    for (int i = 0; i < 3; ++i) knot[i] += uniform(random, -0.1, 0.1);
  }
  for (double& global : unknowns.globals) global = uniform(random, -0.1, 0.1);
  return unknowns;
}

/// All unknowns in one list: three of each knot, then the globals.
double& unknown(Unknowns& unknowns, std::size_t i) {
  const std::size_t knots = 3 * unknowns.knots.size();
  if (i < knots) return unknowns.knots[i / 3][static_cast<Eigen::Index>(i % 3)];
  return unknowns.globals[static_cast<Eigen::Index>(i - knots)];
}

TEST(SlamProblem, DerivativesOfMotionAndHeadingsAreThoseOfTheirResiduals) {
  const SlamProblem problem = a_problem();
  const Unknowns at = random_unknowns(problem, 3);
  const auto rows_at = [&](const Unknowns& u) { return problem.rows(u, problem.ways(u)); };
  const std::vector<SlamProblem::Row> rows = rows_at(at);
  constexpr double kStep = 1e-6;
  for (std::size_t i = 0; i < 3 * problem.knots() + problem.globals(); ++i) {
    Unknowns more = at, less = at;
    unknown(more, i) += kStep;
    unknown(less, i) -= kStep;
    const auto above = rows_at(more), below = rows_at(less);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      double by = 0.0;
      if (i >= 3 * problem.knots()) {
        by = rows[r].by_globals[static_cast<Eigen::Index>(i - 3 * problem.knots())];
      } else if (i / 3 == rows[r].knot) {
        by = rows[r].by_knot[static_cast<Eigen::Index>(i % 3)];
      } else if (i / 3 == rows[r].knot + 1) {
        by = rows[r].by_next[static_cast<Eigen::Index>(i % 3)];
      }
      const double difference = (above[r].residual - below[r].residual) / (2.0 * kStep);
      EXPECT_NEAR(by, difference, 1e-5 * (1.0 + std::abs(difference))) << "row " << r << ", unknown " << i;
    }
  }
}

TEST(SlamProblem, DerivativesOfAPairAreThoseOfItsDistance) {
  const SlamProblem problem = a_problem();
  const Pose2 mount{{0.4, -0.1}, 3.0};
  const Unknowns at = random_unknowns(problem, 5);
  const auto echo_at = [&](double time_s, double bearing_rad, double range_m) {
    const auto between = problem.between_knots(time_s);
    return PlacedEcho{
        {time_s, bearing_rad, range_m, 0.4}, 0, between->first, between->second, problem.main_yaw_rad(time_s)};
  };
  // In different intervals, in neighbouring ones, and in the same.
  for (const double second_s : {12.5, 5.0, 3.0}) {
    const PlacedEcho a = echo_at(2.0, 0.7, 12.0), b = echo_at(second_s, 2.0, 20.0);
    const auto ways = problem.ways(at);
    const EchoOnGround ground_a = place_echo(problem, mount, at, ways, a);
    const EchoOnGround ground_b = place_echo(problem, mount, at, ways, b);
    EchoPair pair;
    pair.normal = Eigen::Vector2d(0.6, 0.8);
    const PairRow row = pair_row(a, ground_a, b, ground_b, at, pair);
    // The bulges are fixed, as they are in a step.
    const auto distance_m = [&](const Unknowns& u) {
      const auto u_ways = problem.ways(u);
      EchoOnGround u_a = place_echo(problem, mount, u, u_ways, a), u_b = place_echo(problem, mount, u, u_ways, b);
      u_a.at += ground_a.bulge - u_a.bulge;
      u_b.at += ground_b.bulge - u_b.bulge;
      // The normal is the mean of that of both, which turn with their sweeps.
      const double turned_rad = 0.5 * (yaw_of(a, u) - yaw_of(a, at) + yaw_of(b, u) - yaw_of(b, at));
      EchoPair u_pair = pair;
      u_pair.normal = Eigen::Rotation2Dd(turned_rad) * pair.normal;
      return pair_row(a, u_a, b, u_b, u, u_pair).distance_m;
    };
    std::vector<double> by(3 * problem.knots() + problem.globals(), 0.0);
    for (std::size_t i = 0; i < 6; ++i) {
      by[3 * a.knot + i] += row.by[static_cast<Eigen::Index>(i)];
      by[3 * b.knot + i] += row.by[static_cast<Eigen::Index>(6 + i)];
    }
    for (std::size_t i = 0; i < 3; ++i) {
      by[3 * problem.knots() + global::kWall + i] = row.by[static_cast<Eigen::Index>(12 + i)];
    }
    constexpr double kStep = 1e-6;
    for (std::size_t i = 0; i < by.size(); ++i) {
      Unknowns more = at, less = at;
      unknown(more, i) += kStep;
      unknown(less, i) -= kStep;
      EXPECT_NEAR(by[i], (distance_m(more) - distance_m(less)) / (2.0 * kStep), 1e-6)
          << "unknown " << i << ", second echo at " << second_s;
    }
    // Kills pairs that tell where north is: a turn of everything moves nothing against anything. (Bulges are fixed.)
    double by_turn = 0.0;
    for (std::size_t k = 0; k < problem.knots(); ++k) {
      by_turn += -by[3 * k] * at.knots[k].y() + by[3 * k + 1] * at.knots[k].x() + by[3 * k + 2];
    }
    const Eigen::Vector2d fixed = ground_a.bulge - ground_b.bulge;
    EXPECT_NEAR(by_turn, -pair.normal.dot(Eigen::Vector2d(-fixed.y(), fixed.x())), 1e-9) << second_s;
  }
}

/// Standard deviation of the way over all knots, 4 s apart, where the velocity is silent for 1000 s.
double deviation_after_gap(double (*yaw_rad_at)(double time_s)) {
  const auto two = [](double first, double second) {
    return TimeSeries({0.0, 1.0, 2.0, 1002.0, 1003.0, 1004.0}, {first, first, first, second, second, second});
  };
  std::vector<double> knots_s, times_s, yaws_rad;
  for (double time_s = 0.0; time_s <= 1004.0; time_s += 4.0) knots_s.push_back(time_s);
  for (double time_s = 0.0; time_s <= 1004.0; time_s += 0.5) {
    times_s.push_back(time_s);
    yaws_rad.push_back(yaw_rad_at(time_s));
  }
  const SlamProblem problem(knots_s, {"dvl", two(0.5, 0.5), two(0.0, 0.0), two(0.02, 0.02)},
                            {{"imu", TimeSeries(times_s, yaws_rad), {}, {}}});
  double variance_m2 = 0.0;
  for (const auto& way : problem.ways(problem.dead_reckoning())) variance_m2 += way.with_steady_m * way.with_steady_m;
  return std::sqrt(variance_m2);
}

// Kills errors that average out over a gap: on a straight way 0.1 m/s that is the same all the time adds up.
TEST(SlamProblem, AGapOfTheVelocityIsAsUncertainAsAVehicleThatMovesSteadily) {
  EXPECT_NEAR(deviation_after_gap([](double) { return 0.0; }), 100.0, 1.0);
  // Going round in a circle, 0.3 m/s from knot to knot.
  EXPECT_NEAR(deviation_after_gap([](double time_s) { return 0.1 * time_s; }), 0.3 * 4.0 * std::sqrt(250.0), 0.5);
}

// Kills a gap that is as certain as where it ends: a vehicle that came back was far away meanwhile.
TEST(SlamProblem, AGapIsAsUncertainAsTheFarthestPlaceInIt) {
  const auto there_and_back = [](double time_s) { return time_s < 502.0 ? 0.0 : std::numbers::pi; };
  EXPECT_NEAR(deviation_after_gap(there_and_back), 50.0, 1.0);
}

TEST(SlamProblem, TheBulgeBringsTheWayBackToTheIntegratedVelocity) {
  // A quarter circle of radius 2 m in one interval: the vehicle is off the chord by its sagitta in the middle.
  constexpr double kTurn_s = 10.0, kRate = std::numbers::pi / 2.0 / kTurn_s;
  VelocitySource velocity{"dvl", series(0.1, 102, [](double) { return 2.0 * kRate; }),
                          series(0.1, 102, [](double) { return 0.0; }), series(0.1, 102, [](double) { return 0.1; }),
                          0};
  std::vector<HeadingSource> headings;
  headings.push_back({"imu", series(0.1, 102, [](double t) { return kRate * t; }), {}, {}});
  const SlamProblem problem({0.0, kTurn_s}, std::move(velocity), std::move(headings));
  const Unknowns unknowns = problem.dead_reckoning();
  EXPECT_NEAR((unknowns.knots[1].head<2>() - Eigen::Vector2d(2.0, 2.0)).norm(), 0.0, 1e-3);
  const auto ways = problem.ways(unknowns);
  const Eigen::Vector2d middle = problem.bulge(unknowns, ways[0], 0, kTurn_s / 2.0);
  const double sagitta_m = 2.0 * (1.0 - std::cos(std::numbers::pi / 4.0));
  EXPECT_NEAR((middle - sagitta_m * Eigen::Vector2d(1.0, -1.0).normalized()).norm(), 0.0, 1e-3);
  EXPECT_NEAR(problem.bulge(unknowns, ways[0], 0, kTurn_s).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace pingvox::test
