#pragma once

#include "pingvox/live/live_options.hpp"
#include "pingvox/result.hpp"
#include "pingvox/web/live_view.hpp"

namespace pingvox::app {

/// The settings of the head that a page commands. @return kBadOption for a step that the head does not have, or one
/// beyond the sector, and for what the head cannot do
Result<void> apply(const web::live_control::DriveHead& control, LiveHead& head);

}  // namespace pingvox::app
