#pragma once

#include <optional>
#include <string_view>

#include "pingvox/web/live_view.hpp"

namespace pingvox::web {

/// The command in a request: "control/head?range=20&gain=high&step=1.8&sector=-60,60" (or "sector=full"),
/// "control/recording/begin", "control/recording/end", "control/map/new". Numbers are finite, but not checked against
/// the head.
/// @return nullopt: unknown command or query
std::optional<LiveControl> control_of(std::string_view path, std::string_view query);

}  // namespace pingvox::web
