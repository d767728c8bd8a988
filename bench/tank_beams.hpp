#pragma once

#include <string>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox::bench {

/// The beams of the paper's recording of a tank; if it is missing, 28 sweeps of the simulated tank (seed 1).
struct TankBeams {
  std::string input;  ///< "recording" or "simulated"
  std::vector<Beam> beams;
};
Result<TankBeams> tank_beams();

}  // namespace pingvox::bench
