#pragma once

#include <cstdint>

#include "map/kernels/lanes.hpp"
#include "pingvox/map/brick_tree.hpp"

/// Loops over the 64 values of a brick, as many at a time as the machine's vectors hold. Each gives, to the last bit,
/// what the plain loop in its comment gives (tests/map/brick_kernels_test.cpp).
namespace pingvox::detail {

/// for each cell of `cells`: value = updated_by(value, evidence, clamp). REQUIRES evidence != 0 and unknown cells to be
/// 0.
/// @return whether a value changed
bool add_alike(Brick& brick, std::uint64_t cells, float evidence, const Clamp& clamp, Lanes lanes = widest_lanes());

/// for each known cell: highest = max(highest, value)
float highest_of(const Brick& brick, Lanes lanes = widest_lanes());

/// for each cell: value == value[0]
bool are_equal(const Brick& brick, Lanes lanes = widest_lanes());

}  // namespace pingvox::detail
