#pragma once

#include <array>
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
#include "pingvox/nav/main_source.hpp"
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
  /// Topics of the bags among them.
  struct Topics {
    std::string file;
    std::vector<BagTopicSummary> topics;
  };
  std::vector<Topics> bags;
  std::vector<std::string> notes;  ///< what could not be used of them: "dive.bag: tf does not join ..."
};
/// What navigation is read for.
struct WantedNav {
  std::string log, topic;  ///< of the sonar: where it is in a bag of navigation, sources of a path have to cover it
  std::span<const NamedSource> chosen;
};
/// Logs that count from the start of a device, or from that of a computer whose clock was not set, are aligned with
/// those that have dates: by the clock of the device, where these have its messages, else by how the vehicle turned in
/// both. kUnsupported when that cannot be told.
/// @param names   - is standard input; an empty log without any
/// @param fields  of messages in ROS bags; if one of the logs is a bag, there must be messages of each
/// @param wanted  for which log they are, and which sources are taken instead of others; kBadOption when there is none
///                of a name
Result<NavFiles> read_navs(const std::vector<std::string>& names, Damage damage, std::span<const NavFields> fields,
                           const WantedNav& wanted);

/// One navigation log, with its topics if it is a bag.
/// @param fields  as above
Result<BagContents> read_nav_log(ByteStream stream, Damage damage, std::span<const NavFields> fields);

/// The water that navigation logs tell of, with the salinity of --water nav,S. kUnsupported when they do not tell the
/// temperature.
Result<Water> water_of(const std::optional<WaterAround>& around, double salinity);
/// "8.7 degrees C at 12.0 m by --nav, salinity 0: sound 1442.2 m/s"
std::string water_text(const Water& water);

/// Takes the sources of --nav-source instead of others; kBadOption when there is none of a name.
Result<NavLog> choose_named(const NavLog& log, std::span<const NamedSource> chosen);

/// What a path is made of, and dead reckoning.
inline constexpr std::array kPathQuantities = {NavQuantity::kPosition, NavQuantity::kFix, NavQuantity::kAttitude};
inline constexpr std::array kMotionQuantities = {NavQuantity::kVelocity, NavQuantity::kAttitude, NavQuantity::kHeading};

/// The sources that were not used of those that tell the same, for reports.
class NavOthers {
 public:
  NavOthers() = default;
  /// @param used  names of sources
  NavOthers(const NavLog& log, std::span<const NavQuantity> quantities, std::span<const std::string> used);
  /// "/aruco/pose (580 samples: camera moves with the vehicle), AHRS2 (90 samples)"; empty: there are none.
  std::string text() const;
  /// [{"name": ..., "samples": ..., "frame": ..., "note": ...}]
  std::vector<JsonObject> json() const;

 private:
  struct Other {
    std::string name, frame, note;
    std::size_t samples = 0;
  };
  std::vector<Other> others_;
};

/// A line of a report that names them; empty: there are none.
std::string others_line(const NavOthers& others);

/// The topics of a bag that hold the sonar's log.
/// @param topic  if one was chosen
std::vector<BagTopicSummary> sonar_topics(std::span<const NavFiles::Topics> bags, const std::string& log,
                                          const std::string& topic);

/// "dive.bag: /tf has the sonar's frame sonar_link on base_link: --mount 0.1,0,-0.4,180,0,0"; empty: `bags` do not tell
/// how the sonar is mounted, or it is mounted as nothing was said.
/// @param log    of the sonar
/// @param topic  of it, if one was chosen
std::string mount_hint(std::span<const NavFiles::Topics> bags, const std::string& log, const std::string& topic);

/// Report of `info` on a navigation log: the members of its JSON object after "kind" and "format", but for the kinds of
/// damage.
void add_nav(JsonObject& json, const NavFile& nav);
/// The same as lines for persons.
std::string nav_text(const NavFile& nav);

}  // namespace pingvox::app
