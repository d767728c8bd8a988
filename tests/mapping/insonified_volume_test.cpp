#include "mapping/internal/insonified_volume.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "support/uniform.hpp"

namespace pingvox {
namespace {

using test::uniform;

std::set<WideKey> missed_cells(const ScanUpdate& scan) {
  std::set<WideKey> cells;
  for (const std::uint32_t index : scan.pages_in_order()) {
    const ScanUpdate::Page& page = scan.page(index);
    for (unsigned x = 0; x < 16; ++x) {
      for (unsigned y = 0; y < 16; ++y) {
        for (unsigned z = 0; z < 16; ++z) {
          const WideKey key{page.lowest.x + x, page.lowest.y + y, page.lowest.z + z};
          const std::size_t cell = ScanUpdate::cell_in_page(key);
          if ((page.missed[cell / 64] >> (cell % 64) & 1) != 0) cells.insert(key);
        }
      }
    }
  }
  return cells;
}

/// A piece of the volume (at most 5 degrees wide) as five half-spaces, a sphere and a box [cells, from the sensor].
struct PlainPiece {
  std::array<Eigen::Vector3d, 5> normals;
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();
  double range = 0.0;

  PlainPiece(const InsonifiedVolume& volume, double bearing_rad, double width_rad, double edge_m)
      : range(volume.range_m / edge_m) {
    const auto direction = [&](double azimuth, double elevation) -> Eigen::Vector3d {
      return volume.map_from_sensor.linear() * Eigen::Vector3d(std::cos(elevation) * std::cos(bearing_rad + azimuth),
                                                               std::cos(elevation) * std::sin(bearing_rad + azimuth),
                                                               std::sin(elevation));
    };
    const double half_width = width_rad / 2, half_height = volume.height_rad / 2;
    const Eigen::Vector3d ahead = direction(0, 0), left = direction(std::numbers::pi / 2, 0);
    const Eigen::Vector3d up = volume.map_from_sensor.linear().col(2);
    // As steep as the cones above and below are at the edge of the piece.
    const double slope = std::tan(half_height) / std::cos(half_width);
    normals = {ahead, std::sin(half_width) * ahead - std::cos(half_width) * left,
               std::sin(half_width) * ahead + std::cos(half_width) * left, (slope * ahead - up).normalized(),
               (slope * ahead + up).normalized()};
    for (int i = 0; i <= 8; ++i) {
      for (const double azimuth : {-half_width, 0.0, half_width}) {
        const Eigen::Vector3d end = range * direction(azimuth, volume.height_rad * (i / 8.0 - 0.5));
        low = low.cwiseMin(end);
        high = high.cwiseMax(end);
      }
    }
    const double bulge = range * (1.0 - std::cos(std::max(volume.height_rad / 8, half_width))) + 1.0;
    low.array() -= bulge;
    high.array() += bulge;
  }

  /// @param middle  of a cell
  bool touches(const Eigen::Vector3d& middle) const {
    if ((middle.array() < low.array()).any() || (middle.array() > high.array()).any()) return false;
    for (const Eigen::Vector3d& normal : normals) {
      // Cells are open above: a face that only touches one from above has nothing in it.
      const double reach = 0.5 * normal.cwiseAbs().sum() + ((normal.array() <= 0.0).all() ? 1e-9 : -1e-9);
      if (normal.dot(middle) < -reach) return false;
    }
    return (middle.cwiseAbs().array() - 0.5).max(0.0).matrix().norm() <= range + 1e-9;
  }
};

std::set<WideKey> cells_one_by_one(const Lattice& lattice, const InsonifiedVolume& volume) {
  const double edge_m = lattice.resolution_m();
  // Whole cells and the rest in long double: where a product or quotient of doubles is rounded to must not matter.
  using LongVector = Eigen::Matrix<long double, 3, 1>;
  const LongVector origin = volume.map_from_sensor.translation().cast<long double>() / static_cast<long double>(edge_m);
  const LongVector first = origin.array().floor();
  const Eigen::Vector3d in_cell = (origin - first).cast<double>();
  const WideWord centre = WideWord{1} << (lattice.depth() - 1);
  const int pieces = std::max(1, static_cast<int>(std::ceil(volume.width_rad / (5.0 * kDegree_rad))));
  const double width = volume.width_rad / pieces;
  std::set<WideKey> cells;
  for (int i = 0; i < pieces; ++i) {
    const PlainPiece piece(volume, volume.bearing_rad + (i + 0.5) * width - volume.width_rad / 2, width, edge_m);
    const Eigen::Vector3i low = (piece.low.array() - 2.0).floor().cast<int>(),
                          high = (piece.high.array() + 2.0).ceil().cast<int>();
    for (int x = low.x(); x <= high.x(); ++x) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int z = low.z(); z <= high.z(); ++z) {
          const Eigen::Vector3d middle = Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5) - in_cell;
          if (!piece.touches(middle)) continue;
          const auto word = [&](int from_sensor, Eigen::Index axis) {
            const auto cell = static_cast<std::int64_t>(first[axis]) + from_sensor;
            return cell < 0 ? centre - static_cast<WideWord>(-cell) : centre + static_cast<WideWord>(cell);
          };
          cells.insert({word(x, 0), word(y, 1), word(z, 2)});
        }
      }
    }
  }
  return cells;
}

// Kills rows that begin or end a cell off, rows or layers that are left out, bricks and pages that are mixed up, and
// anything that depends on which way the head is turned.
TEST(InsonifiedVolume, MarksTheCellsThatAllHalfSpacesAndTheSphereTouch) {
  std::size_t cells = 0;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const bool is_on_corner = seed % 6 == 1;
    const Lattice lattice(is_on_corner ? 0.05 : uniform(random, 0.02, 0.2), seed % 5 == 0 ? 100 : 16);
    const double tilt = seed % 3 == 0 ? 0.0 : 1.5;
    InsonifiedVolume volume;
    volume.map_from_sensor =
        pose_from_rpy({uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)},
                      uniform(random, -2 * tilt, 2 * tilt), uniform(random, -tilt, tilt), uniform(random, -3, 3));
    if (is_on_corner) {
      // As a person types it: 3 cells of 0.05 m are 0.15, not the double 3 * 0.05.
      volume.map_from_sensor.translation() = (volume.map_from_sensor.translation() * 20.0).array().round() / 20.0;
    }
    volume.bearing_rad = uniform(random, -7, 7);
    volume.width_rad = seed % 7 == 0 ? 0.0 : uniform(random, 0, seed % 11 == 0 ? 60 : 8) * kDegree_rad;
    volume.height_rad = seed % 4 == 0 ? 0.0 : uniform(random, 0, seed % 13 == 0 ? 120 : 50) * kDegree_rad;
    volume.range_m = lattice.resolution_m() * std::exp(uniform(random, std::log(0.2), std::log(50.0)));
    ScanUpdate scan(lattice);
    ASSERT_TRUE(trace_volume(volume, scan));
    const std::set<WideKey> expected = cells_one_by_one(lattice, volume);
    const std::set<WideKey> marked = missed_cells(scan);
    EXPECT_TRUE(marked == expected) << marked.size() << " cells, not " << expected.size();
    cells += expected.size();
  }
  EXPECT_GT(cells, 200'000U);
  RecordProperty("cells", static_cast<int>(cells));
}

// Kills a far end that is cut off by more than the sphere: rows longer than a page, and longer than any fixed buffer.
TEST(InsonifiedVolume, ReachesAsFarAsItsRange) {
  const Lattice lattice(0.001, 32);
  for (const double bearing : {0.0, 0.3, 0.25 * std::numbers::pi, 2.0}) {
    SCOPED_TRACE(bearing);
    ScanUpdate scan(lattice);
    ASSERT_TRUE(trace_volume({Pose::Identity(), bearing, 0.0, 0.0, 20.0}, scan));
    std::size_t missing = 0;
    for (int i = 0; i < 20'000; ++i) {
      const double range_m = (i + 0.25) * 0.001;
      const auto key =
          lattice.key_of<WideWord>({range_m * std::cos(bearing), range_m * std::sin(bearing), 0.25 * 0.001});
      const ScanUpdate::Page& page = scan.page(scan.page_of(*key));
      const std::size_t cell = ScanUpdate::cell_in_page(*key);
      missing += (page.missed[cell / 64] >> (cell % 64) & 1) == 0;
    }
    EXPECT_EQ(missing, 0U);
  }
}

}  // namespace
}  // namespace pingvox
