#pragma once

#include <cstddef>

#include "mapping/bundle_grid.hpp"
#include "pingvox/geometry/lattice.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/scan_update.hpp"

namespace pingvox::detail {

/// Adds the hits of an echo: the cells where rays of its range end, each with its share of the evidence.
/// @return how many rays end outside of the lattice
std::size_t add_hits(const Pose& map_from_sensor, const BundleGrid& rays, double range_m, LogOdds evidence,
                     ScanUpdate& scan);

}  // namespace pingvox::detail
