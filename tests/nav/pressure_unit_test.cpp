#include "nav/internal/pressure_unit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace pingvox {
namespace {

using testing::HasSubstr;

constexpr double kAir_pa = 101'325.0, kMetre_pa = 1025.0 * 9.80665;

struct Sensor {
  double unit_pa = 1.0;  ///< of its numbers
  double zero_pa = 0.0;  ///< what it calls 0
};
constexpr Sensor kPa{1.0, 0.0}, kHpa{1e2, 0.0}, kKpa{1e3, 0.0}, kBar{1e5, 0.0}, kGaugePa{1.0, kAir_pa},
    kGaugeHpa{1e2, kAir_pa}, kGaugeKpa{1e3, kAir_pa}, kGaugeBar{1e5, kAir_pa}, kDbar{1e4, 0.0},
    kGaugeDbar{1e4, kAir_pa}, kPsi{6894.757, 0.0}, kGaugePsi{6894.757, kAir_pa}, kMmHg{133.3224, 0.0};

struct Dive {
  double top_m = 0.0, bottom_m = 0.0;
};

double depth_at(const Dive& dive, double time_s) {
  return dive.top_m + 0.5 * (dive.bottom_m - dive.top_m) * (1.0 - std::cos(0.05 * time_s));
}

/// Two samples a second, for two minutes.
NavSource dive_of(const Dive& dive, NavQuantity quantity, const Sensor& sensor) {
  NavSource source{"bar30", quantity, {}};
  for (int i = 0; i < 240; ++i) {
    NavSample sample;
    sample.time_s = 0.5 * i;
    const double depth_m = depth_at(dive, sample.time_s);
    sample.value.x() =
        quantity == NavQuantity::kDepth ? depth_m : (kAir_pa + kMetre_pa * depth_m - sensor.zero_pa) / sensor.unit_pa;
    source.samples.push_back(sample);
  }
  return source;
}

/// How a pressure was read: "" where it is as deep as the vehicle was, else what is wrong.
std::string told(const Dive& dive, const Sensor& sensor, const NavSource* depth = nullptr) {
  NavSource source = dive_of(dive, NavQuantity::kPressure, sensor);
  tell_pressure(source, depth, PressureUnit::kOpen);
  if (!source.fault.empty()) return source.fault;
  for (const NavSample& sample : source.samples) {
    const double off_m = (sample.value.x() - kAir_pa) / kMetre_pa - depth_at(dive, sample.time_s);
    if (std::fabs(off_m) > 0.01) return "wrong: " + source.note;
  }
  return "";
}

TEST(PressureUnit, IsToldByARecordingFromTheSurface) {
  const Dive dive{0.1, 8.0};
  for (const Sensor& sensor : {kPa, kHpa, kKpa, kGaugePa}) {
    EXPECT_EQ(told(dive, sensor), "") << sensor.unit_pa << " from " << sensor.zero_pa;
  }
}

// Kills a unit by the size of the first number: 604 kPa were 604 hPa, and Pa of a gauge hPa.
TEST(PressureUnit, IsToldByARecordingThatBeginsDeep) {
  const Dive deep{50.0, 52.0};
  EXPECT_EQ(told(deep, kPa), "");
  EXPECT_EQ(told(deep, kKpa), "");
  EXPECT_THAT(told(deep, kBar), HasSubstr("may be bar (50.0 to 52.0 m deep) or "));
  EXPECT_EQ(told({0.5, 2.5}, kGaugePa), "");
  EXPECT_EQ(told({2.0, 7.0}, kGaugePa), "");
}

TEST(PressureUnit, IsToldByADepthOfTheLog) {
  const Dive deep{50.0, 58.0};
  const NavSource depth = dive_of(deep, NavQuantity::kDepth, kPa);
  for (const Sensor& sensor :
       {kPa, kHpa, kKpa, kBar, kGaugePa, kGaugeKpa, kGaugeBar, kDbar, kGaugeDbar, kPsi, kGaugePsi, kMmHg}) {
    EXPECT_EQ(told(deep, sensor, &depth), "") << sensor.unit_pa << " from " << sensor.zero_pa;
  }
}

// Kills a guess: 6039 hPa in 50 m are 6039 Pa in 0.6 m as well.
TEST(PressureUnit, ThatCannotBeToldIsAFault) {
  EXPECT_THAT(told({50.0, 50.1}, kHpa),
              testing::AllOf(HasSubstr("its numbers, from 6039"), HasSubstr("may be hPa ("),
                             HasSubstr("or Pa above that of air"), HasSubstr("ambiguous without a depth")));
  EXPECT_THAT(told({0.1, 8.0}, kGaugeKpa),
              HasSubstr("hPa above that of air (0.0 to 0.8 m deep) or kPa above that of air"));
  EXPECT_THAT(told({0.0, 8.0}, {1e-6, 0.0}), HasSubstr("are no pressures of air or water"));
}

// Kills dbar and psi that are read as bar ten or fifteen times as deep, or as kPa a tenth as deep.
TEST(PressureUnit, OfDbarAndPsiIsAskedFor) {
  const Dive dive{0.1, 6.0};
  EXPECT_THAT(told(dive, kDbar), HasSubstr("dbar (0.1 to 6.0 m deep) or "));
  EXPECT_THAT(told(dive, kGaugeDbar), HasSubstr("dbar above that of air (0.1 to 6.0 m deep)"));
  EXPECT_THAT(told({20.0, 23.0}, kGaugeDbar), HasSubstr("dbar above that of air (20.0 to 23.0 m deep)"));
  EXPECT_THAT(told(dive, kPsi), HasSubstr("psi (0.1 to 6.0 m deep) or "));
  EXPECT_THAT(told(dive, kGaugePsi), HasSubstr("psi above that of air (0.1 to 6.0 m deep)"));
  EXPECT_THAT(told(dive, kMmHg), HasSubstr("mmHg (0.1 to 6.0 m deep)"));
  EXPECT_THAT(told(dive, kBar), HasSubstr("bar (0.1 to 6.0 m deep) or "));
  EXPECT_THAT(told(dive, kGaugeBar), HasSubstr("bar above that of air (0.1 to 6.0 m deep)"));
}

// Kills a gauge that begins deep, in hPa, as kPa at five metres a second.
TEST(PressureUnit, IsNotWhatIsTooFast) {
  EXPECT_EQ(told({5.0, 20.0}, kGaugeHpa), "");
}

TEST(PressureUnit, AStatedOneIsKeptAndItsZeroFound) {
  NavSource gauge = dive_of({0.2, 5.0}, NavQuantity::kPressure, kGaugePa),
            wrong = dive_of({0.2, 5.0}, NavQuantity::kPressure, kKpa);
  tell_pressure(gauge, nullptr, PressureUnit::kStated);
  EXPECT_NEAR(gauge.samples[0].value.x(), kAir_pa + 0.2 * kMetre_pa, 1.0);
  EXPECT_EQ(gauge.note, "read as Pa above that of air");
  tell_pressure(wrong, nullptr, PressureUnit::kStated);
  EXPECT_THAT(wrong.fault, HasSubstr("are no pressures of air or water in Pa"));
}

// A gauge that became depth - 10 m, and one in air.
TEST(PressureUnit, DepthsHaveTheRightZero) {
  std::vector<NavSource> sources = {dive_of({0.5, 2.5}, NavQuantity::kPressure, kGaugePa)};
  tell_pressures(sources);
  const auto depth = depth_source(*NavLog::make(sources, NavClock::kUnix));
  ASSERT_TRUE(depth);
  EXPECT_NEAR(depth->samples[0].value.x(), 0.5, 1e-3);

  std::vector<NavSource> open = {dive_of({50.0, 50.1}, NavQuantity::kPressure, kHpa)};
  tell_pressures(open);
  EXPECT_FALSE(depth_source(*NavLog::make(open, NavClock::kUnix))) << "of a unit that is not known";
}

// Kills a sensor that sends 0 before it answers, as a gauge at the surface.
TEST(PressureUnit, IsNotToldByZeros) {
  NavSource source = dive_of({0.0, 5.0}, NavQuantity::kPressure, kHpa);
  for (std::size_t i = 0; i < 20; ++i) source.samples[i].value.x() = 0.0;
  tell_pressure(source, nullptr, PressureUnit::kOpen);
  EXPECT_EQ(source.fault, "");
  EXPECT_EQ(source.note, "read as hPa");
  EXPECT_FALSE(source.samples[0].valid);
  EXPECT_TRUE(source.samples[20].valid);
}

/// Goes between two depths, never faster than a vehicle.
double slow_depth_m(double top_m, double bottom_m, double time_s) {
  return top_m + 0.5 * (bottom_m - top_m) * (1.0 - std::cos(0.02 * time_s));
}

// Kills a unit or a zero that is guessed: a pressure is read right, or said to be unclear; with a depth beside it that
// tells ten metres from a thousandth of them, it is read right.
TEST(PressureUnitOfRandomDives, IsNeverWrong) {
  const std::array sensors = {kPa,       kHpa,      kKpa,  kBar,       kGaugePa, kGaugeHpa,
                              kGaugeKpa, kGaugeBar, kDbar, kGaugeDbar, kPsi,     kGaugePsi};
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
      sample.value.x() = slow_depth_m(top_m, bottom_m, sample.time_s);
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
