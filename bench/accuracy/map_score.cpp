#include "accuracy/map_score.hpp"

#include <cassert>
#include <limits>

namespace pingvox::bench {
namespace {

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

double MapScore::precision() const {
  return share(occupied_right, occupied);
}
double MapScore::recall() const {
  return share(visible_found, visible);
}
double MapScore::free_share() const {
  return share(free_right, free);
}
double MapScore::free_share_near() const {
  return share(free_near, free);
}

MapScore score_map(const CellGrid& map, const CellGrid& truth, const CellGrid& visible) {
  assert(map.size() == truth.size() && map.size() == visible.size());
  MapScore score;
  map.for_each([&](const CellGrid::Cell& cell) {
    if (map.at(cell) == Occupancy::kOccupied) {
      ++score.occupied;
      score.occupied_right += truth.is_near(cell, Occupancy::kOccupied);
    } else if (map.at(cell) == Occupancy::kFree) {
      ++score.free;
      const bool is_water = truth.at(cell) == Occupancy::kFree;
      score.free_right += is_water;
      score.free_near += is_water || truth.is_near(cell, Occupancy::kFree);
    }
    if (visible.at(cell) == Occupancy::kOccupied) {
      ++score.visible;
      score.visible_found += map.is_near(cell, Occupancy::kOccupied);
    }
  });
  return score;
}

}  // namespace pingvox::bench
