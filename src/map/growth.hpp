#pragma once

#include <cstddef>

#include "map/brick_tree.hpp"
#include "map/key_batch.hpp"
#include "pingvox/geometry/key.hpp"
#include "pingvox/map/log_odds.hpp"
#include "pingvox/map/scan_update.hpp"

/// By how many bytes updates will make a tree grow at most, for maps with a memory limit.
namespace pingvox::detail {

/// Upper bound for the growth of a tree's storage by a scan. Unchanged bricks need nothing, so a map at its limit still
/// accepts scans of known cells. W is the width of the cursor that the tree needs.
template <KeyWord W>
std::size_t growth_of(BrickTree& tree, const ScanUpdate& scan, const Clamp& clamp);

/// The same by a batch of cells, each of which gets the evidence as often as it is named.
std::size_t growth_of(BrickTree& tree, KeyBatch& batch, LogOdds evidence, const Clamp& clamp);

}  // namespace pingvox::detail
