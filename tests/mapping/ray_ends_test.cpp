#include "mapping/kernels/ray_ends.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "pingvox/geometry/lattice.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/scan_update.hpp"
#include "support/kernels.hpp"
#include "support/uniform.hpp"

namespace pingvox::detail {
namespace {

using test::uniform;

// Kills ends that are rounded otherwise than those of single rays, cells and pages that are mixed up, the last rays of
// a number that fills no vector, and places for what is outside or no number at all.
TEST(RayEnds, EachMachineFindsTheCellsOfSingleRays) {
  constexpr int kDepth = 16;
  constexpr std::int64_t kCentre = 1 << (kDepth - 1);
  std::size_t found = 0, outside = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Lattice lattice(0.05, kDepth);
    const Pose map_from_sensor = pose_from_rpy({uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, -9, 9)},
                                               uniform(random, -3, 3), uniform(random, -1, 1), uniform(random, -3, 3));
    RayEnds ends;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t i = 0; i < 4; ++i) {
        ends.map_from_sensor[a][i] = map_from_sensor(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(i));
      }
      // A multiple of a page below the middle of the lattice: some ends are below it.
      ends.lowest[a] = -16 * static_cast<std::int64_t>(random() % 30);
      ends.inside_from[a] = static_cast<double>(ends.lowest[a]);
      ends.inside_to[a] = static_cast<double>(kCentre);
    }
    ends.range_m = uniform(random, 0.1, 20.0);
    ends.cells_per_m = 1.0 / lattice.resolution_m();

    const std::size_t count = 1 + random() % 40;
    const double bearing = uniform(random, -3, 3), way_x = std::cos(bearing), way_y = std::sin(bearing);
    std::vector<double> across(count + kEndsAtOnce), up(count + kEndsAtOnce);
    for (std::size_t i = 0; i < count; ++i) {
      const double elevation = uniform(random, -1.5, 1.5);
      across[i] = std::cos(elevation);
      up[i] = std::sin(elevation);
    }
    if (seed % 10 == 0) up[0] = std::nan("");
    if (seed % 10 == 1) up[0] = std::numeric_limits<double>::infinity();
    if (seed % 10 == 2) up[0] = -1e300;

    test::for_each_kernel([&] {
      std::vector<std::uint64_t> places(count + kEndsAtOnce);
      find_ends(ends, way_x, way_y, std::span(across).first(count), up.data(), places.data());
      for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Vector3d direction(across[i] * way_x, across[i] * way_y, up[i]);
        const auto key = lattice.key_of(map_from_sensor * (direction * ends.range_m));
        std::uint64_t expected = kNoPlace;
        if (key && key->x >= kCentre + ends.lowest[0] && key->y >= kCentre + ends.lowest[1] &&
            key->z >= kCentre + ends.lowest[2]) {
          const auto page = [&](std::uint16_t word, std::size_t a) {
            return static_cast<std::uint64_t>((word - kCentre - ends.lowest[a]) / 16)
                   << (kCellBits + static_cast<int>(a) * kPlaceBits);
          };
          expected = ScanUpdate::cell_in_page(*key) | page(key->x, 0) | page(key->y, 1) | page(key->z, 2);
          ++found;
        } else {
          ++outside;
        }
        EXPECT_EQ(places[i], expected) << "ray " << i;
      }
    });
  }
  EXPECT_GT(found, 2000U);
  EXPECT_GT(outside, 500U);
}

}  // namespace
}  // namespace pingvox::detail
