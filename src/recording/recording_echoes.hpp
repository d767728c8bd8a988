#pragma once

#include "mapping/internal/held_out_echoes.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// The echoes of a recording, and the maps that they are compared with.
struct RecordingEchoes {
  HeldOutEchoes echoes;
  MapOptions map;               ///< with its resolution
  double cell_m = 0.0;          ///< this resolution
  double beam_width_rad = 0.0;  ///< of the first log

  /// Largest error in range of a predicted echo: 0.1 m, or a cell where that is more.
  double tolerance_m() const;
};

/// Of all logs, read as build_map does.
/// @return kUnsupported for logs of scans, and when the path is of navigation and a log has no times; errors of reading
Result<RecordingEchoes> recording_echoes(const Recording& recording, const VehiclePath& path, const MapOptions& map,
                                         const BuildOptions& build);

}  // namespace pingvox
