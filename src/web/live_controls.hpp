#pragma once

#include <optional>
#include <string_view>

#include "pingvox/web/live_view.hpp"

namespace pingvox::web {

/// What a request of a page asks of a run: "control/head?range=20&gain=high&step=1.8&sector=-60,60" (or "sector=full"),
/// "control/recording/begin", "control/recording/end", "control/map/new". Numbers are finite; whether the head can do
/// so is not known here.
/// @return nullopt: no control of this name, or a query that it does not have
std::optional<LiveControl> control_of(std::string_view path, std::string_view query);

}  // namespace pingvox::web
