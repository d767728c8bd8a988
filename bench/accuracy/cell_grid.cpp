#include "accuracy/cell_grid.hpp"

#include <algorithm>

#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox::bench {

bool CellGrid::is_near(const Cell& c, Occupancy kind) const {
  for (std::int64_t z = std::max<std::int64_t>(c[2] - 1, 0); z <= std::min(c[2] + 1, size_[2] - 1); ++z) {
    for (std::int64_t y = std::max<std::int64_t>(c[1] - 1, 0); y <= std::min(c[1] + 1, size_[1] - 1); ++y) {
      for (std::int64_t x = std::max<std::int64_t>(c[0] - 1, 0); x <= std::min(c[0] + 1, size_[0] - 1); ++x) {
        if (at({x, y, z}) == kind) return true;
      }
    }
  }
  return false;
}

CellBox::CellBox(const Lattice& lattice, const Eigen::AlignedBox3d& box_m) : lattice_(lattice) {
  const auto low = *lattice.key_of(box_m.min()), high = *lattice.key_of(box_m.max());
  low_ = {low.x, low.y, low.z};
  high_ = {high.x, high.y, high.z};
}

CellBox CellBox::layer(const Lattice& lattice, Eigen::AlignedBox3d box_m, double z_m) {
  box_m.min().z() = box_m.max().z() = z_m;
  return {lattice, box_m};
}

CellGrid::Cell CellBox::size() const {
  return {high_[0] - low_[0] + 1, high_[1] - low_[1] + 1, high_[2] - low_[2] + 1};
}

CellGrid::Cell CellBox::cell_of(const Eigen::Vector3d& point_m) const {
  const auto key = lattice_.key_of(point_m);
  if (!key) return {-1, -1, -1};
  return {key->x - low_[0], key->y - low_[1], key->z - low_[2]};
}

CellGrid CellBox::mark(const std::vector<Eigen::Vector3d>& points_m) const {
  constexpr double kHair_m = 1e-9;
  CellGrid grid(size());
  for (const Eigen::Vector3d& point : points_m) {
    const CellGrid::Cell cell = cell_of(point.array() + kHair_m);
    if (grid.has(cell)) grid.at(cell) = Occupancy::kOccupied;
  }
  return grid;
}

CellGrid CellBox::classes_of(const OccupancyMap& map, const Thresholds& thresholds) const {
  CellGrid grid(size());
  const auto middle_of = [&](const CellGrid::Cell& c) {
    const auto word = [](std::int64_t n) { return static_cast<std::uint16_t>(n); };
    return lattice_.centre_of(Key{word(c[0]), word(c[1]), word(c[2])});
  };
  const LeafQuery query{.max_depth = {}, .box = Box{middle_of(low_), middle_of(high_)}};
  for_each_leaf(map, query, [&](const Leaf& leaf) {
    const Occupancy kind = classify(leaf.belief, thresholds);
    const std::int64_t edge = std::int64_t{1} << (lattice_.depth() - leaf.depth);
    const auto number = [](WideWord word) { return static_cast<std::int64_t>(word); };
    const CellGrid::Cell corner = {number(leaf.key.x), number(leaf.key.y), number(leaf.key.z)};
    CellGrid::Cell first{}, last{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = std::max(corner[axis], low_[axis]) - low_[axis];
      last[axis] = std::min(corner[axis] + edge - 1, high_[axis]) - low_[axis];
    }
    for (std::int64_t z = first[2]; z <= last[2]; ++z) {
      for (std::int64_t y = first[1]; y <= last[1]; ++y) {
        for (std::int64_t x = first[0]; x <= last[0]; ++x) grid.at({x, y, z}) = kind;
      }
    }
  });
  return grid;
}

}  // namespace pingvox::bench
