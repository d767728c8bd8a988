#pragma once

#include <string>

#include "pingvox/recording/calibration_file.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// What 'slam --calibration' and 'simulate --truth' write and --use-calibration reads, as TOML.
std::string calibration_toml(const CalibrationFile& file);

/// @return kIo when it cannot be read; kCorrupt naming the line of what is unknown, missing, there twice or no number;
///         a calibration that cannot be used is named without a line
Result<CalibrationFile> read_calibration(const std::string& path);

}  // namespace pingvox::app
