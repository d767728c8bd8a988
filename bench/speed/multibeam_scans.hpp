#pragma once

#include <string>
#include <vector>

#include "pingvox/result.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {

/// 300 pings of a multibeam, 256 beams each over 123 degrees across the track: a line of an R2Sonic 2026 in San
/// Francisco Bay. If the recording is missing, the same over a simulated seabed.
struct MultibeamScans {
  std::string input;  ///< "recording" or "simulated"
  std::vector<RayCloud> scans;
};
Result<MultibeamScans> multibeam_scans();

}  // namespace pingvox::bench
