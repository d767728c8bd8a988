#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "json.hpp"
#include "nav_clock.hpp"
#include "pingvox/io/bag.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/sonar/sound_speed.hpp"

namespace pingvox::app {

/// How many were skipped.
std::size_t damaged_records(const NavFile& nav);

/// Navigation logs of one vehicle, put together on the first clock that is known.
struct NavFiles {
  NavLog log;                         ///< sources of the same name and quantity are one
  std::size_t damaged = 0;            ///< records that could not be read
  std::vector<std::string> warnings;  ///< what is left out and why; each begins with the names of files
  std::vector<NavLogClock> clocks;    ///< of each log
};
/// Logs that count from the start of a device, or from that of a computer whose clock was not set, are aligned with
/// those that have dates: by the clock of the device, where these have its messages, else by how the vehicle turned in
/// both. kUnsupported when that cannot be told.
/// @param names   - is standard input; an empty log without any
/// @param fields  of messages in ROS bags; if one of the logs is a bag, there must be messages of each
Result<NavFiles> read_navs(const std::vector<std::string>& names, Damage damage, std::span<const NavFields> fields);

/// One navigation log, with its topics if it is a bag.
/// @param fields  as above
Result<BagContents> read_nav_log(ByteStream stream, Damage damage, std::span<const NavFields> fields);

/// The water that navigation logs tell of, with the salinity of --water nav,S. kUnsupported when they do not tell the
/// temperature.
Result<Water> water_of(const std::optional<WaterAround>& around, double salinity);
/// "8.7 degrees C at 12.0 m by --nav, salinity 0: sound 1442.2 m/s"
std::string water_text(const Water& water);

/// Report of `info` on a navigation log: the members of its JSON object after "kind" and "format", but for the kinds of
/// damage.
void add_nav(JsonObject& json, const NavFile& nav);
/// The same as lines for persons.
std::string nav_text(const NavFile& nav);

}  // namespace pingvox::app
