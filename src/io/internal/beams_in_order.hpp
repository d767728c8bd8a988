#pragma once

#include <memory>
#include <string>

#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// The beams of a source in order of time, though messages of the log were swapped: those that are late by no more than
/// kMaxSwapped_s go to their places. Where the clock of the log was set back, its end is an error: kCorrupt.
/// @param name  of the log, for messages
std::unique_ptr<BeamSource> in_order(std::unique_ptr<BeamSource> source, std::string name);

}  // namespace pingvox
