#pragma once

#include "mapping/internal/held_out_echoes.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// The echoes of all logs of a recording, read as build_map does.
/// @param forecast  of the recording; its opened logs are read
/// @return kUnsupported for logs of scans, and when the path is of navigation and a log has no times; errors of reading
Result<HeldOutEchoes> recording_echoes(const Recording& recording, const VehiclePath& path, const BuildOptions& build,
                                       MapForecast& forecast);

}  // namespace pingvox
