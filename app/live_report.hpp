#pragma once

#include <string>

#include "commands.hpp"
#include "io/internal/json.hpp"
#include "pingvox/live/live_mapping.hpp"

namespace pingvox::app {

/// Since the last status.
struct LiveRates {
  double beams_per_s = 0.0;
  double latency_s = 0.0;  ///< longest time from a beam's arrival until the mapper was done with it
};

enum class LiveEnd { kNo, kYes };

/// "400 beams, 20/s, 310 echoes, ..."
std::string status_line(const LiveMapping& live, const LiveStatus& status, const LiveRates& rates);
/// At the end also the coverage of the sweeps.
JsonObject live_json(const LiveMapping& live, const LiveStatus& status, const LiveRates& rates, LiveEnd end);
/// Without --json.
std::string live_summary(const LiveMapping& live, const LiveStatus& status, const LiveCommand& command);

}  // namespace pingvox::app
