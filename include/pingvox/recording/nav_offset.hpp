#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/beam_topic.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/input_file.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// What is added to the times of the navigation to get those of the sonar log, and its source.
struct NavOffset {
  enum class By {
    kGiven,       ///< by the caller
    kOneClock,    ///< assumed to be one clock, for want of other evidence
    kDates,       ///< both have dates
    kLocalDates,  ///< both have dates, those of the sonar log in local time
    kDateInName,  ///< the date in the name of the sonar log, which is local time
    kPicture,     ///< the rotation of the sonar image
  };
  double offset_s = 0.0;
  std::optional<double> deviation_s = std::nullopt;  ///< standard deviation; nullopt: it was not estimated
  By by = By::kOneClock;
  double local_from_utc_s = 0.0;  ///< of kLocalDates and kDateInName: the time zone
  std::size_t picture_turns = 0;  ///< of kPicture: parts of sweeps that were matched
};

/// The sonar log whose clock is wanted.
struct SonarLog {
  InputFile file;
  BeamTopic topic = {};  ///< of a bag
  Pose body_from_sonar = Pose::Identity();
  Damage damage = Damage::kSkip;
};

/// kUnsupported when navigation cannot be joined to the log, which has no times.
/// @param name  of the log
Result<void> check_has_times(const BeamSource& source, const std::string& name);

/// The offset between the clocks of a sonar log and of navigation: by their dates, else by the rotation of the sonar
/// image. Times without dates that overlap are taken as those of one clock, unless the navigation counts from the
/// start of its device; so are those of standard input, which can be read only once.
/// @return kUnsupported, with the reason, when it cannot be determined
Result<NavOffset> find_nav_offset(const NavLog& nav, const SonarLog& sonar);

/// "UTC-7:00"
std::string zone_text(double local_from_utc_s);

}  // namespace pingvox
