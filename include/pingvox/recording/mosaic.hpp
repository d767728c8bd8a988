#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "pingvox/geometry/raster.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/recording/vehicle_path.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/mosaic.hpp"

namespace pingvox {

struct RecordingMosaicOptions {
  std::optional<double> resolution_m = std::nullopt;  ///< of a pixel; nullopt: half of what `forecast_map` finds
  Blend blend = Blend::kMean;
  double min_range_m = MosaicOptions{}.min_range_m;  ///< bins nearer are left out
  double max_range_m = MosaicOptions{}.max_range_m;  ///< bins farther are left out
  double sound_speed_ratio = 1.0;  ///< BuildOptions::sound_speed_ratio; in known water the recording's

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// The sonar image on the ground, and how it was made.
struct RecordingMosaic {
  Raster<float> picture;  ///< intensities in the map frame, 0..255; NaN where there is no beam
  MapForecast forecast;   ///< from which the resolution follows
  BuildReport report;     ///< of all logs together: beams and those skipped
  std::vector<MappedLog> logs;
};

/// Draws the beams of all logs of a recording along a path (Mosaic).
/// @param progress  called after each beam
/// @return kBadOption when the options do not validate; kUnsupported for logs of scans, and when the path is of
///         navigation and a log has no times; kCorrupt when no beam of any log can be drawn; kLimit when the picture
///         would be too large, with its size; errors of reading
Result<RecordingMosaic> mosaic(const Recording& recording, const VehiclePath& path,
                               const RecordingMosaicOptions& options = {}, const Progress& progress = {});

}  // namespace pingvox
