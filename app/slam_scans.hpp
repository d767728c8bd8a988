#pragma once

#include <memory>

#include "commands.hpp"
#include "console.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// `slam` of a log of point scans.
/// @param scans  the log, opened
Result<int> run_scans(const SlamCommand& command, std::unique_ptr<ScanSource> scans, Console& console);

}  // namespace pingvox::app
