#pragma once

namespace pingvox {

/// How the horizontal axes of a map lie in the world; z is up.
enum class MapAxes {
  kUnknown,     ///< unknown, or x ahead and y left of the vehicle at some time
  kRightAhead,  ///< x right and y ahead of the vehicle at the start
  kEastNorth,   ///< x east, y north
};

}  // namespace pingvox
