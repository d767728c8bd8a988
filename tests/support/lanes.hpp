#pragma once

#include <vector>

#include "map/kernels/lanes.hpp"

namespace pingvox::detail {

/// The kinds of loops that can run on this machine.
inline std::vector<Lanes> lanes_here() {
  std::vector<Lanes> lanes{Lanes::kOne};
  if (widest_lanes() != Lanes::kOne) lanes.push_back(Lanes::kAvx2);
  if (widest_lanes() == Lanes::kAvx512) lanes.push_back(Lanes::kAvx512);
  return lanes;
}

}  // namespace pingvox::detail
