#pragma once

#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// Whether the samples of a source have a yaw.
inline bool has_yaw(const NavSource& source) {
  return source.quantity == NavQuantity::kAttitude || source.quantity == NavQuantity::kHeading;
}

/// The yaw of a sample [rad].
/// REQUIRES has_yaw(source)
inline double yaw_of(const NavSource& source, const NavSample& sample) {
  return source.quantity == NavQuantity::kAttitude ? sample.value.z() : sample.value.x();
}

}  // namespace pingvox
