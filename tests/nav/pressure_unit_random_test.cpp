#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "nav/internal/pressure_unit.hpp"

namespace pingvox {
namespace {

constexpr double kAir_pa = 101'325.0, kMetre_pa = 1025.0 * 9.80665;

struct Sensor {
  double unit_pa, zero_pa;
};

/// Goes between two depths, never faster than a vehicle.
double depth_m(double top_m, double bottom_m, double time_s) {
  return top_m + 0.5 * (bottom_m - top_m) * (1.0 - std::cos(0.02 * time_s));
}

// Kills a unit or a zero that is guessed: a pressure is read right, or said to be unclear; with a depth beside it that
// tells ten metres from a thousandth of them, it is read right.
TEST(PressureUnitOfRandomDives, IsNeverWrong) {
  const std::array<Sensor, 8> sensors = {
      {{1.0, 0.0}, {1e2, 0.0}, {1e3, 0.0}, {1e5, 0.0}, {1.0, kAir_pa}, {1e2, kAir_pa}, {1e3, kAir_pa}, {1e5, kAir_pa}}};
  int read = 0, unclear = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    std::mt19937_64 random(seed);
    const auto between = [&random](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    const bool has_depth = random() % 2 == 0;
    // 922 kPa in 92 m and 922 hPa of air are the same numbers, and so are 0.9 kPa in 9 cm and 0.9 bar of air: without a
    // depth, dives begin at the surface.
    const double top_m = has_depth ? between(0.0, 100.0) : between(0.0, 0.07), bottom_m = top_m + between(1.0, 40.0);
    const Sensor& sensor = sensors[random() % sensors.size()];
    NavSource pressure{"bar30", NavQuantity::kPressure, {}}, depth{"depth", NavQuantity::kDepth, {}};
    for (int i = 0; i < 400; ++i) {
      NavSample sample;
      sample.time_s = 0.5 * i;
      sample.value.x() = depth_m(top_m, bottom_m, sample.time_s);
      depth.samples.push_back(sample);
      sample.value.x() = (kAir_pa + kMetre_pa * sample.value.x() - sensor.zero_pa) / sensor.unit_pa;
      pressure.samples.push_back(sample);
    }
    tell_pressure(pressure, has_depth ? &depth : nullptr, PressureUnit::kOpen);
    SCOPED_TRACE(testing::Message() << "seed " << seed << ": " << sensor.unit_pa << " Pa from " << sensor.zero_pa
                                    << " Pa, " << top_m << " to " << bottom_m << " m");
    if (has_depth) {
      ASSERT_EQ(pressure.fault, "");
    }
    if (!pressure.fault.empty()) {
      ++unclear;
      continue;
    }
    ++read;
    for (std::size_t i = 0; i < pressure.samples.size(); ++i) {
      ASSERT_NEAR((pressure.samples[i].value.x() - kAir_pa) / kMetre_pa, depth.samples[i].value.x(), 0.01)
          << pressure.note;
    }
  }
  EXPECT_GT(read, 150);
  EXPECT_GT(unclear, 10);
}

}  // namespace
}  // namespace pingvox
