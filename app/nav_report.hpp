#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "commands.hpp"
#include "io/internal/json.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/sonar/sound_speed.hpp"

namespace pingvox::app {

/// How many were skipped.
std::size_t damaged_records(const NavFile& nav);

/// "8.7 degrees C at 12.0 m by --nav, salinity 0: sound 1442.2 m/s"
std::string water_text(const Water& water);

/// "ATTITUDE and LOCAL_POSITION_NED, depth by SCALED_PRESSURE2"
std::string nav_sources_text(const VehiclePath::Nav& nav);

/// [{"name": ..., "samples": ..., "frame": ..., "note": ...}]
std::vector<JsonObject> json_of(std::span<const OtherSource> others);
/// A line of a report that names them; empty: there are none.
std::string others_line(std::span<const OtherSource> others);

/// The line of a report that says that a mount is assumed; empty: --mount was given.
std::string mount_line(const RecordingArgs& args);

/// Report of `info` on a navigation log: the members of its JSON object after "kind" and "format", but for the kinds of
/// damage.
void add_nav(JsonObject& json, const NavFile& nav);
/// The same as lines for persons.
std::string nav_text(const NavFile& nav);

}  // namespace pingvox::app
