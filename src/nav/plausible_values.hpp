#pragma once

#include <Eigen/Core>
#include <span>

#include "pingvox/nav/nav_log.hpp"

// What no vehicle can measure: numbers in another unit than their quantity has, and damaged ones. The limits are
// physical and generous, for all readers alike.
namespace pingvox {

/// Whether each number of a sample is within what its quantity can be.
bool is_possible(NavQuantity quantity, const Eigen::Vector3d& value);

/// Marks single samples that are not possible as invalid. Where they are not single, the unit is wrong: `fault` says
/// so.
/// @param source  in order of time
void check_values(NavSource& source);

}  // namespace pingvox
