#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sim/sonar.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox::bench {

/// Options of a simulated recording.
struct RecordingOptions {
  std::string_view world;  ///< tank; harbour; harbour, no hull; seabed; cave
  Motion motion = Motion::kStill;
  std::size_t turns = 5;    ///< of the head
  double speed_m_s = 0.25;  ///< of a vehicle that moves
  double heave_m = 0.0;     ///< amplitude of five vertical oscillations around z = 0
  std::size_t beams = 200;  ///< per turn
  std::uint64_t seed = 1;
};

/// A simulated log with its ground truth.
struct Recording {
  RecordingOptions options;
  Scene scene;
  SonarOptions sonar;
  std::vector<Sweep> sweeps;
  std::vector<SonarSimulator::Ping> pings;  ///< of all beams of all sweeps, in order
};

/// @return kBadOption for an unknown world
Result<Recording> record(const RecordingOptions& options);

}  // namespace pingvox::bench
