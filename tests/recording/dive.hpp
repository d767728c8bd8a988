#pragma once

#include <sstream>
#include <string>
#include <utility>

#include "pingvox/io/beams.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/sim/nav_sensors.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sim/sonar.hpp"
#include "support/logs.hpp"

namespace pingvox::test {

/// Log and navigation of a simulated dive through a harbour, as CSV in memory.
struct Dive {
  FileBytes log, nav;
  Trajectory truth;
};

/// @param delay_s  by which the clock of the navigation is ahead
inline Dive harbour_dive(double delay_s = 0.0) {
  const Scene scene = harbour_scene({});
  SonarOptions sonar;
  sonar.beams_per_turn = 60;
  sonar.bins = 200;
  sonar.bin_length_m = 0.05;
  const Trajectory truth = follow_route(scene.loop, 40.0, {});
  SonarSimulator beams(scene.world, truth, sonar, 12);
  std::ostringstream log, nav;
  EXPECT_TRUE(write_csv(beams, log));
  NavSensorOptions sensors;
  sensors.delay_s = delay_s;
  EXPECT_TRUE(write_nav_csv(simulate_nav(truth, 0.0, 40.0, sensors).log, nav));
  return {{"dive.csv", bytes_of(log.str())}, {"nav.csv", bytes_of(nav.str())}, truth};
}

/// A map as the bytes of a file, to compare all of it.
inline std::string bytes_of_map(const OccupancyMap& map) {
  std::ostringstream out;
  EXPECT_TRUE(write_map(map, Format::kPvx, "", out));
  return out.str();
}

}  // namespace pingvox::test
