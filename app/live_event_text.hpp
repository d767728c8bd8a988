#pragma once

#include <string>

#include "pingvox/live/live_event.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/live/live_options.hpp"

namespace pingvox::app {

/// The message of an event.
/// @param options  as the run was opened with
/// @param status   for the names of the navigation devices
std::string live_event_text(const LiveEvent& event, const LiveOptions& options, const LiveStatus& status);

}  // namespace pingvox::app
