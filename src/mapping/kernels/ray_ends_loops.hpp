// The loop over rays, included by ray_ends.cpp once for each kind of machine (see ray_lanes_loops.hpp).

#include "map/kernels/doubles_loops.hpp"

inline void find_ends(const RayEnds& ends, double way_x, double way_y, std::span<const double> across, const double* up,
                      std::uint64_t* places) {
  for (std::size_t first = 0; first < across.size(); first += kLanes) {
    Doubles level, height;
    load(across.data() + first, level);
    load(up + first, height);
    const Doubles x = level * way_x * ends.range_m, y = level * way_y * ends.range_m, z = height * ends.range_m;
    Words place{}, inside = Words{} - 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::array<double, 4>& row = ends.map_from_sensor[a];
      const Doubles end_m = row[0] * x + row[1] * y + row[2] * z + row[3];
      const Doubles cell = end_m * ends.cells_per_m;
      inside &= (cell >= ends.inside_from[a]) & (cell < ends.inside_to[a]);
      Doubles whole;
      floor_of(cell, whole);
      Words number;
      bits_of(whole - static_cast<double>(ends.lowest[a]), number);
      number &= (1 << 21) - 1;
      Words in_page = number & 15;
      in_page = (in_page | in_page << 4) & 0xC3;
      in_page = (in_page | in_page << 2) & 0x249;
      place |= in_page << a | (number >> 4) << (kCellBits + static_cast<int>(a) * kPlaceBits);
    }
    place = inside ? place : Words{} - 1;
    std::memcpy(places + first, &place, sizeof place);
  }
}
