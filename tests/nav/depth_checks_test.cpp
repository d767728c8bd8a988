#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/nav/nav_log.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

/// Ten samples a second for 30 s.
NavSource half_a_minute(std::string name, NavQuantity quantity, const std::function<Vector3d(double)>& at) {
  NavSource source{std::move(name), quantity, {}};
  for (int i = 0; i < 300; ++i) {
    NavSample sample;
    sample.time_s = 0.1 * i;
    sample.value = at(sample.time_s);
    source.samples.push_back(sample);
  }
  return source;
}

/// A dive from 5 m by 2 cm a second.
double dive_m(double time_s) {
  return 5.0 + 0.02 * time_s;
}
NavSource pressure_of_dive() {
  return half_a_minute("bar30", NavQuantity::kPressure,
                       [](double time_s) { return Vector3d(101'325.0 + 1025.0 * 9.80665 * dive_m(time_s), 0, 0); });
}
NavSource depth_of_dive(double unit) {
  return half_a_minute("depth", NavQuantity::kDepth,
                       [unit](double time_s) { return Vector3d(unit * dive_m(time_s), 0, 0); });
}
/// Its height, where up is 1 or -1.
NavSource position_of_dive(double up) {
  return half_a_minute("odom", NavQuantity::kPosition,
                       [up](double time_s) { return Vector3d(0.1 * time_s, 0, -up * dive_m(time_s)); });
}

/// Of the last source.
std::string fault_among(std::vector<NavSource> sources) {
  return NavLog::make(std::move(sources), NavClock::kUnix)->sources().back().fault;
}

std::string doubt_among(std::vector<NavSource> sources) {
  return NavLog::make(std::move(sources), NavClock::kUnix)->sources().back().doubt;
}

TEST(DepthChecks, ADepthThatIsFasterThanAnyDiveIsInAnotherUnit) {
  const auto slow = [](double unit) {
    return half_a_minute("depth", NavQuantity::kDepth,
                         [unit](double time_s) { return Vector3d(unit * (5.0 + 0.05 * time_s), 0, 0); });
  };
  EXPECT_THAT(fault_among({slow(100.0)}), HasSubstr("it changes by 5 m/s repeatedly"));
  EXPECT_THAT(fault_among({slow(1000.0)}), HasSubstr("is it in cm or mm?"));
  EXPECT_EQ(fault_among({slow(1.0)}), "");
}

TEST(DepthChecks, ADepthAboveTheSurfaceAllTheTimePointsUp) {
  EXPECT_THAT(fault_among({depth_of_dive(-1.0)}), HasSubstr("above the surface, or more, all the time: does it point"));
  // In air, at the surface, and a boat in the swell.
  EXPECT_EQ(fault_among({half_a_minute("depth", NavQuantity::kDepth, [](double) { return Vector3d(-0.3, 0, 0); })}),
            "");
}

TEST(DepthChecks, ADepthIsComparedWithThePressure) {
  EXPECT_THAT(fault_among({pressure_of_dive(), depth_of_dive(100.0)}),
              HasSubstr("m where the pressure of bar30 is that of 5.3 m: is it in cm or mm?"));
  EXPECT_EQ(fault_among({pressure_of_dive(), depth_of_dive(1.0)}), "");
  EXPECT_EQ(fault_among({depth_of_dive(100.0)}), "") << "nothing speaks against it";
}

// Kills a z that points down: all walls of the map above the surface.
TEST(DepthChecks, AHeightIsComparedWithTheDepth) {
  for (const NavSource& depth : {pressure_of_dive(), depth_of_dive(1.0)}) {
    EXPECT_THAT(doubt_among({depth, position_of_dive(-1.0)}), HasSubstr("does it point down?")) << depth.name;
    EXPECT_EQ(doubt_among({depth, position_of_dive(1.0)}), "") << depth.name;
  }
  EXPECT_EQ(doubt_among({position_of_dive(-1.0)}), "");
}

// Kills a depth in feet, fathoms or decimetres, and one that points up, beside a pressure that tells another.
TEST(DepthChecks, ADepthInFeetIsToldByThePressure) {
  EXPECT_THAT(fault_among({pressure_of_dive(), depth_of_dive(3.2808)}),
              HasSubstr("it changes 3.28 times as much as that by the pressure of bar30: is it in feet?"));
  EXPECT_THAT(fault_among({pressure_of_dive(), depth_of_dive(0.5468)}), HasSubstr("is it in fathoms?"));
  EXPECT_THAT(fault_among({pressure_of_dive(), depth_of_dive(10.0)}), HasSubstr("is it in dm?"));
  const auto from_above =
      half_a_minute("depth", NavQuantity::kDepth, [](double time_s) { return Vector3d(10.0 - dive_m(time_s), 0, 0); });
  EXPECT_THAT(fault_among({pressure_of_dive(), from_above}), HasSubstr("falls as the pressure of bar30 rises"));
}

NavSource constant(NavQuantity quantity, const Vector3d& value) {
  return half_a_minute("constant", quantity, [value](double) { return value; });
}

TEST(DepthChecks, AConstantDepthIsComparedToo) {
  const NavSource deep = constant(NavQuantity::kPressure, {101'325.0 + 1025.0 * 9.80665 * 5.0, 0, 0});
  EXPECT_THAT(doubt_among({deep, constant(NavQuantity::kDepth, {50.0, 0, 0})}), HasSubstr("is it in dm?"));
  EXPECT_THAT(doubt_among({deep, constant(NavQuantity::kDepth, {0.5, 0, 0})}), HasSubstr("is it in another unit?"));
  EXPECT_EQ(doubt_among({deep, constant(NavQuantity::kDepth, {5.5, 0, 0})}), "");
  EXPECT_EQ(doubt_among({deep, constant(NavQuantity::kDepth, {15.3, 0, 0})}), "") << "from the zero of a gauge";
}

// Kills a vehicle at constant depth that is as far above the surface.
TEST(DepthChecks, AConstantHeightIsComparedWithTheDepth) {
  const NavSource depth = constant(NavQuantity::kDepth, {5.0, 0, 0});
  EXPECT_THAT(doubt_among({depth, constant(NavQuantity::kPosition, {1, 2, 5})}),
              HasSubstr("its z is 5 m above the origin where the depth of constant is 5 m: does it point down?"));
  EXPECT_EQ(doubt_among({depth, constant(NavQuantity::kPosition, {1, 2, -5})}), "");
  EXPECT_EQ(doubt_among({depth, constant(NavQuantity::kPosition, {1, 2, 0})}), "");
}

TEST(DepthChecks, AHeightInFeetIsNamed) {
  EXPECT_THAT(doubt_among({depth_of_dive(1.0), position_of_dive(3.2808)}), HasSubstr("is it in feet?"));
}

}  // namespace
}  // namespace pingvox
