#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sim/sonar.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox::bench {

/// What is simulated for a measurement.
struct RecordingOptions {
  std::string_view world;  ///< tank; harbour; harbour, no hull; seabed; cave
  Motion motion = Motion::kStill;
  std::size_t turns = 5;    ///< of the head
  double speed_m_s = 0.25;  ///< of a vehicle that moves
  double heave_m = 0.0;     ///< how far it goes up and down around z = 0 on its way, five times
  std::size_t beams = 200;  ///< per turn
  std::uint64_t seed = 1;
};

/// A simulated log with what is true of it.
struct Recording {
  RecordingOptions options;
  Scene scene;
  SonarOptions sonar;
  std::vector<Sweep> sweeps;
  std::vector<SonarSimulator::Ping> pings;  ///< of all beams of all sweeps, in order
};

/// @return kBadOption when there is no such world
Result<Recording> record(const RecordingOptions& options);

}  // namespace pingvox::bench
