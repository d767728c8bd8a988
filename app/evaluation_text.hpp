#pragma once

#include <string>
#include <vector>

#include "io/internal/json.hpp"
#include "pingvox/mapping/sweep_coverage.hpp"
#include "pingvox/recording/evaluate.hpp"

/// Reports on how far a map can be trusted.
namespace pingvox::app {

/// One sentence: "predicts 93 % of the echoes it can judge (81 % of all) within 0.1 m", where that is less than half
/// with what may be wrong, or "cannot be judged: ...".
std::string verdict_text(const Evaluation& evaluation);

/// "28 sweeps of 19.3 s, in which the vehicle moves 4.1 m and turns by 12 degrees (medians)"
std::string movement_text(const SweepCoverage& sweeps);

/// "47, seen in 28 sweeps each (median), 2.1 % in one only"
std::string places_text(const SweepCoverage& sweeps);
/// "17 of 4.06 s (median), 69.2 s in all"
std::string pauses_text(const BeamPauses& pauses);
JsonObject pauses_json(const BeamPauses& pauses);
JsonObject coverage_json(const SweepCoverage& sweeps);

/// Why a map of these sweeps cannot be good, in plain words; empty: no reason.
std::vector<std::string> coverage_warnings(const SweepCoverage& sweeps);

}  // namespace pingvox::app
