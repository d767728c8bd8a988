#pragma once

#include <optional>

#include "pingvox/web/answer.hpp"

namespace pingvox::web {

/// What an extension of BlueOS tells of itself where the readers are Readers::kLocalNetwork, also to pages of other
/// origins: `/register_service` to BlueOS, `/cockpit_extras.json` and `/icon.svg` to Cockpit.
/// @return nullopt for all other requests
std::optional<Answer> blueos_answer(const Request& request, const Access& access);

}  // namespace pingvox::web
