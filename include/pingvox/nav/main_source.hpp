#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

// The choice among several sources of the vehicle's pose in a log.
namespace pingvox {

/// Sources become NavSubject::kOther, with a note that says why, where they are goals, commands, plans or of something
/// else by their name, unless they are chosen. Of those whose subject is uncertain also poses in a frame that moves
/// with the vehicle, headings without a place (as of the head of a sonar), and velocities in a frame that stands still;
/// of the others poses of a frame that stands still in one that moves with the vehicle, which are inverted.
void judge_subjects(std::vector<NavSource>& sources);

/// The best source of a quantity, as NavLog::best has it.
const NavSource* main_source(const NavLog& log, NavQuantity quantity);

/// The sources of a path. nullptr: the log has none that is valid.
struct PathSources {
  const NavSource* position = nullptr;  ///< of quantity kPosition or kFix
  const NavSource* attitude = nullptr;
};

/// Position: of the sources that are known, together with an attitude, for at least half as long as the one that is
/// known longest, first by NavSubject (of uncertain ones those in a fixed frame, REP-105, first), positions in metres
/// before fixes but places that never change last; then the estimate of the autopilot's main filter, then the source
/// with most valid samples. Attitude: of the sources that are known for at least half of the longest time together with
/// the position, the position's own, then likewise. The order of the sources in the log does not matter.
PathSources path_sources(const NavLog& log);

/// Of the sources of these quantities those that are known, together with another one if there is one, for at least
/// half as long as the one that is known longest: the one with most valid samples first.
/// @param other  nullptr: alone
std::vector<const NavSource*> covering_sources(const NavLog& log, std::span<const NavQuantity> quantities,
                                               const NavSource* other = nullptr);

/// Makes sources NavSubject::kOther that are known, between these times, for less than half as long as the best one
/// that can stand for them (see choose_sources): what covers a long journey may miss the dive. All stay where none is
/// known then.
Result<NavLog> sources_between(const NavLog& log, double from_s, double to_s);

/// A source that a user names: "/odom", or of one quantity only.
struct NamedSource {
  std::string name;
  std::optional<NavQuantity> quantity = std::nullopt;
};

/// Makes the named sources NavSubject::kChosen, and the others that could be taken instead NavSubject::kOther: position
/// and fix, attitude and heading, depth and pressure stand for each other.
/// @return kBadOption when there is no such source; the message names all sources
Result<NavLog> choose_sources(const NavLog& log, std::span<const NamedSource> named);

}  // namespace pingvox
