#pragma once

#include "pingvox/result.hpp"
#include "pingvox/viewer/picture.hpp"

namespace pingvox::bench {

/// Figures 9 and 10: a diagonal by Bresenham and by DDA.
Result<Picture> diagonal_rays();

/// Figures 11 and 12: the paper's DDA, missing its end and snapping beside it, and ours of the same rays.
Result<Picture> lost_ends();

}  // namespace pingvox::bench
