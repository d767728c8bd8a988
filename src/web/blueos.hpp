#pragma once

#include <optional>

#include "pingvox/web/answer.hpp"

namespace pingvox::web {

/// The metadata of an extension of BlueOS, for Readers::kLocalNetwork and pages of any origin: `/register_service` for
/// BlueOS, `/cockpit_extras.json` and `/icon.svg` for Cockpit.
/// @return nullopt for all other requests
std::optional<Answer> blueos_answer(const Request& request, const Access& access);

}  // namespace pingvox::web
