#pragma once

#include <span>
#include <string>
#include <vector>

#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// What is known of the numbers of a source of pressure before they are looked at.
enum class PressureUnit {
  kStated,  ///< given: Pa
  kOpen,    ///< Pa, hPa, kPa, bar, dbar, psi or mmHg: what a type of message says of it is not what all drivers do
};

/// Tells the unit and the zero of a pressure by all its samples, and makes them Pa above a vacuum; `note` says what
/// they were, if it was something else. By the first of these that applies:
///   1. a depth of the same log: they fit it in one unit and from one zero;
///   2. the lowest pressure is that of air in Pa, hPa or kPa: the recording begins or ends at the surface;
///   3. they are pressures below the surface in Pa;
///   4. of what else is possible - pressures of air and below the surface in another unit, gauges that read 0 at the
///      surface - there is only one. Where several are, `fault` names them.
/// What takes the vehicle up and down faster than vehicles go, or below 1000 m (in dbar, psi
/// and mmHg, which are rare, 100 m), is not possible.
/// @param source  of a pressure, in any order
/// @param depth   nullptr: the log has none
void tell_pressure(NavSource& source, const NavSource* depth, PressureUnit unit);

/// The same of all sources of pressure among those of a log.
/// @param stated  the names of those whose unit was stated; the others' is open
void tell_pressures(std::vector<NavSource>& sources, std::span<const std::string> stated = {});

}  // namespace pingvox
