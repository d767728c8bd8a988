#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pingvox/io/bag.hpp"
#include "pingvox/io/beam_topic.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/input_file.hpp"
#include "pingvox/io/nav_fields.hpp"
#include "pingvox/nav/main_source.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/nav/receiver_clock.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// One of several logs of navigation, and how its clock is joined to that of the first one.
struct NavLogClock {
  enum class By {
    kFirst,      ///< it is the first one
    kDevice,     ///< both have times of the autopilot's clock
    kTurns,      ///< the rotation of the vehicle in both
    kDates,      ///< both have dates
    kSameStart,  ///< both count from the start of the device
    kOneClock,   ///< assumed to be one clock, for want of other evidence
  };
  std::string name;
  double offset_s = 0.0;              ///< to add to its times to get those of the first one
  std::optional<double> deviation_s;  ///< standard deviation; nullopt: it was not estimated
  By by = By::kFirst;
  std::vector<ClockSetting> settings;  ///< of the recorder's clock
};

/// Navigation logs of one vehicle, put together on the first clock that is known.
struct NavFiles {
  NavLog log;               ///< sources of the same name and quantity are one
  std::size_t damaged = 0;  ///< records that could not be read
  /// A remark on a file.
  struct Note {
    std::string file, text;
  };
  std::vector<Note> left_out;       ///< what was left out although undamaged: messages of other vehicles
  std::vector<Note> not_joined;     ///< what could not be used: "tf does not join base_link to map"
  std::vector<NavLogClock> clocks;  ///< of each log
  /// Topics of the bags among them.
  struct Topics {
    std::string file;
    std::vector<BagTopicSummary> topics;
  };
  std::vector<Topics> bags;
};

/// How navigation is read, and what for.
struct NavigationOptions {
  Damage damage = Damage::kSkip;
  /// Of messages in ROS bags; if one of the logs is a bag, there must be messages of each.
  std::span<const NavFields> fields = {};
  /// Of the sonar, where it is in a bag of navigation: sources have to cover it. Empty: they need not.
  std::string log = {}, topic = {};
  std::span<const NamedSource> chosen = {};  ///< sources to use instead of others
};

/// Reads logs of navigation. Those that count from the start of a device, or from that of a computer whose clock was
/// not set, are aligned with those that have dates: by the clock of the device, where these have its messages, else by
/// how the vehicle turned in both.
/// @param files  none: the log is empty
/// @return kUnsupported when the clocks cannot be aligned, or a file is no navigation; kBadOption when there is no
///         source of a chosen name, or no messages of `fields`; errors of reading
Result<NavFiles> read_navigation(std::span<const InputFile> files, const NavigationOptions& reading = {});

/// One navigation log as it is, with its topics if it is a bag.
/// @param fields  as in NavigationOptions
Result<BagContents> read_nav_log(ByteStream stream, Damage damage, std::span<const NavFields> fields);
/// What a bag holds; the stream can still be read afterwards. A pipe is loaded into memory for that.
Result<BagContents> bag_contents(ByteStream& stream, Damage damage, std::span<const NavFields> fields);

/// The topics of a bag among the navigation that hold the sonar's log.
/// @param log    name of the sonar's file
/// @param topic  of it; empty: all that have beams, else all of scans
std::vector<BagTopicSummary> sonar_topics(std::span<const NavFiles::Topics> bags, const std::string& log,
                                          const std::string& topic);

/// The quantities of a path, and of dead reckoning.
inline constexpr std::array kPathQuantities = {NavQuantity::kPosition, NavQuantity::kFix, NavQuantity::kAttitude};
inline constexpr std::array kMotionQuantities = {NavQuantity::kVelocity, NavQuantity::kAttitude, NavQuantity::kHeading};

/// An unused source of a quantity that was used from another one.
struct OtherSource {
  std::string name, frame;
  std::string note;  ///< why it is not the vehicle's; empty: it may be
  std::size_t samples = 0;
};
/// The sources of these quantities that were not used, by their names.
/// @param used  names of sources
std::vector<OtherSource> other_sources(const NavLog& log, std::span<const NavQuantity> quantities,
                                       std::span<const std::string> used);
/// "/aruco/pose (580 samples: camera moves with the vehicle), AHRS2 (90 samples)"; empty: there are none.
std::string text_of(std::span<const OtherSource> others);

}  // namespace pingvox
