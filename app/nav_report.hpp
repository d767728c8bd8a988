#pragma once

#include <cstddef>
#include <string>

#include "json.hpp"
#include "pingvox/io/nav.hpp"

namespace pingvox::app {

/// How many were skipped.
std::size_t damaged_records(const NavFile& nav);
/// What `info` says of a navigation log: the members of its JSON object after "kind" and "format", but for the kinds of
/// damage.
void add_nav(JsonObject& json, const NavFile& nav);
/// The same as lines for persons.
std::string nav_text(const NavFile& nav);

}  // namespace pingvox::app
