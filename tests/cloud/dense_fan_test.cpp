#include "map/dense_fan.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "map/tree_order.hpp"
#include "pingvox/cloud/trace_points.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "support/differences.hpp"
#include "support/fan.hpp"
#include "support/lanes.hpp"
#include "support/uniform.hpp"

namespace pingvox::detail {
namespace {

constexpr std::size_t kWords = (std::size_t{1} << (3 * kWindowBits)) / 64;

using test::uniform;

/// Where rays begin [m].
Eigen::Vector3d drawn_start(std::mt19937_64& random) {
  return {uniform(random, -3.0, 3.0), uniform(random, -3.0, 3.0), uniform(random, -3.0, 3.0)};
}

/// Beams side by side as bundles of rays, each of its own length; somewhere in all directions.
std::vector<Eigen::Vector3d> bundles(std::mt19937_64& random, const Eigen::Vector3d& from_m, double most_m) {
  constexpr int kAcross = 32, kUp = 64;
  const Eigen::Vector3d axis(uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0));
  const Eigen::AngleAxisd turn(uniform(random, -3.0, 3.0), axis.normalized());
  const double height = uniform(random, 0.3, 0.9), width = uniform(random, 0.05, 0.3);
  std::vector<Eigen::Vector3d> ends_m;
  for (int beam = 0; beam < 12; ++beam) {
    const double range_m = uniform(random, 0.1, 1.0) * most_m;
    for (int up = 0; up < kUp; ++up) {
      for (int across = 0; across < kAcross; ++across) {
        const double bearing = width * (beam + (across + 0.5) / kAcross), elevation = height * ((up + 0.5) / kUp - 0.5);
        const Eigen::Vector3d way(std::cos(elevation) * std::cos(bearing), std::cos(elevation) * std::sin(bearing),
                                  std::sin(elevation));
        ends_m.emplace_back(from_m + turn * (range_m * way));
      }
    }
  }
  return ends_m;
}

struct Marks {
  std::vector<std::uint64_t> missed, hit;
  std::vector<std::uint32_t> others;
  std::size_t walked = 0;
};

Marks taken_from(ScanWindow& window) {
  Marks marks{{window.missed(), window.missed() + kWords}, {window.hit(), window.hit() + kWords}, {}};
  // Each mark lies in a page that is touched.
  for (std::size_t word = 0; word < kWords; ++word) {
    if ((window.missed()[word] | window.hit()[word]) != 0) {
      EXPECT_EQ(window.touched()[word / 64], 1);
      EXPECT_EQ(window.with_hits()[word / 64] | (window.hit()[word] == 0 ? 1 : 0), 1);
    }
    EXPECT_EQ(window.asked()[word], 0U);
  }
  return marks;
}

Marks walked_one_by_one(const RayFan& fan, const std::vector<Eigen::Vector3d>& ends_m) {
  ScanWindow window;
  window.open(kWindowBits);
  std::vector<ReadyRay> ready;
  std::vector<std::uint32_t> others;
  prepare_rays(Lanes::kOne, fan, std::span<const Eigen::Vector3d>(ends_m), ready, others);
  for (const ReadyRay& ray : ready) mark_hit(ray.end, window);
  mark_rays(Lanes::kOne, ready, start_of(fan), MissesIn::kMask, window);
  Marks marks = taken_from(window);
  marks.others = others;
  return marks;
}

/// @param window  the fans before went through it, too
/// @param marked  hits that are marked before
template <class Point>
Marks walked_as_fan(Lanes lanes, const RayFan& fan, const std::vector<Point>& ends_m, std::uint32_t squares,
                    ScanWindow& window, const std::vector<std::uint64_t>& marked = {}) {
  window.open(kWindowBits);
  for (std::uint64_t place = 0; place < 64 * marked.size(); ++place) {
    if ((marked[place / 64] >> (place % 64) & 1) != 0) mark_hit(place, window);
  }
  std::vector<std::uint32_t> others;
  DenseFan<Point> dense(lanes, fan, start_of(fan), squares, window);
  const std::size_t walked = dense.mark(ends_m, marked.empty() ? RayEnds::kHit : RayEnds::kMarked, others);
  Marks marks = taken_from(window);
  std::fill_n(window.missed(), kWords, 0);
  std::fill_n(window.hit(), kWords, 0);
  std::fill_n(window.touched(), window.pages(), std::uint8_t{0});
  std::fill_n(window.with_hits(), window.pages(), std::uint8_t{0});
  std::sort(others.begin(), others.end());
  marks.others = others;
  marks.walked = walked;
  return marks;
}

/// Hits beat misses, so a missed cell that is hit need not be marked as missed.
void expect_same_cells(const Marks& found, const Marks& expected) {
  EXPECT_EQ(found.hit, expected.hit);
  std::size_t different = 0;
  for (std::size_t word = 0; word < kWords; ++word) {
    different += ((found.missed[word] ^ expected.missed[word]) & ~expected.hit[word]) != 0 ? 1 : 0;
  }
  EXPECT_EQ(different, 0U);
}

// Kills a cell that is never asked (beyond a brick or a page, behind a hit, on another face of the cube), a ray that is
// said not to cross a cell which it does, a ray that is taken out and not walked, squares and bounds that forget rays,
// or that remember those of the fan before.
TEST(DenseFan, MarksTheCellsOfWalkingEachRay) {
  std::size_t rays = 0, walked = 0;
  ScanWindow window;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const double cells_per_m = uniform(random, 0.5, 3.0);
    Eigen::Vector3d from_m = drawn_start(random);
    if (seed % 3 == 0) from_m = from_m.array().round() / cells_per_m;  // corners of cells
    std::vector<Eigen::Vector3d> ends_m = bundles(random, from_m, uniform(random, 5.0, 55.0) / cells_per_m);
    // Some leave the window, some are none.
    if (seed % 4 == 0) {
      for (std::size_t i = 0; i < ends_m.size(); i += 97) ends_m[i] *= 20.0;
      ends_m[5].x() = std::nan("");
      ends_m.back().y() = std::numeric_limits<double>::infinity();
    }
    const RayFan fan = fan_from(from_m, cells_per_m);
    const Marks expected = walked_one_by_one(fan, ends_m);
    for (const Lanes lanes : lanes_here()) {
      SCOPED_TRACE(static_cast<int>(lanes));
      const Marks found = walked_as_fan(lanes, fan, ends_m, 48 + 16 * static_cast<std::uint32_t>(seed % 4), window);
      // Rays that are not ready need not be walked where their cells are marked: but those outside are all named.
      EXPECT_TRUE(
          std::includes(expected.others.begin(), expected.others.end(), found.others.begin(), found.others.end()));
      expect_same_cells(found, expected);
      rays += ends_m.size();
      walked += found.walked;
    }
  }
  EXPECT_LT(walked, rays / 2) << "most must not be walked, or this tests nothing";
}

// Kills ends in single precision that are read as others are: the same cells as those of the same numbers in double
// precision, whether they are walked or asked.
TEST(DenseFan, MarksTheSameCellsForEndsInSinglePrecision) {
  std::size_t rays = 0, walked = 0;
  ScanWindow window;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Eigen::Vector3d from_m = drawn_start(random);
    std::vector<Eigen::Vector3f> ends_m;
    std::vector<Eigen::Vector3d> same_m;
    for (const Eigen::Vector3d& end_m : bundles(random, from_m, uniform(random, 10.0, 80.0))) {
      ends_m.push_back(end_m.cast<float>());
      same_m.push_back(ends_m.back().cast<double>());
    }
    const RayFan fan = fan_from(from_m);
    const Marks expected = walked_one_by_one(fan, same_m);
    for (const Lanes lanes : lanes_here()) {
      SCOPED_TRACE(static_cast<int>(lanes));
      const Marks found = walked_as_fan(lanes, fan, ends_m, seed % 4 == 0 ? 4096 : 64, window);
      expect_same_cells(found, expected);
      rays += ends_m.size();
      walked += found.walked;
    }
  }
  EXPECT_LT(walked, rays * 3 / 4);
  EXPECT_GT(walked, rays / 4);
}

// Kills hits that are lost where they are marked already, and rays to them that are taken for such without one, which
// are walked one by one.
TEST(DenseFan, TakesHitsThatAreMarkedAlready) {
  std::size_t rays = 0, walked = 0;
  ScanWindow window;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Eigen::Vector3d from_m = drawn_start(random);
    const std::vector<Eigen::Vector3d> ends_m = bundles(random, from_m, uniform(random, 10.0, 50.0));
    const RayFan fan = fan_from(from_m);
    const Marks expected = walked_one_by_one(fan, ends_m);
    const Marks found = walked_as_fan(widest_lanes(), fan, ends_m, 64, window, expected.hit);
    expect_same_cells(found, expected);
    EXPECT_EQ(found.walked, walked_as_fan(widest_lanes(), fan, ends_m, 64, window).walked);
    rays += ends_m.size();
    walked += found.walked;
  }
  EXPECT_LT(walked, rays * 2 / 3);
}

// Kills marks of a flat fan that go into the window's layer, where no cell that borders on them is looked for.
TEST(DenseFan, FlatFansMarkTheMask) {
  constexpr int kRays = 40'000;
  std::size_t walked = 0;
  ScanWindow window;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Eigen::Vector3d from_m = drawn_start(random);
    const RayFan fan = fan_from(from_m);
    std::vector<Eigen::Vector3d> ends_m;
    for (int ray = 0; ray < kRays; ++ray) {
      const double bearing = 2.0 * ray / kRays, range_m = 40.0 + 15.0 * std::sin(20.0 * bearing);
      ends_m.emplace_back(from_m + range_m * Eigen::Vector3d(std::cos(bearing), std::sin(bearing), 0.0));
    }
    const Marks expected = walked_one_by_one(fan, ends_m);
    for (const Lanes lanes : lanes_here()) {
      SCOPED_TRACE(static_cast<int>(lanes));
      const Marks found = walked_as_fan(lanes, fan, ends_m, 64, window);
      expect_same_cells(found, expected);
      EXPECT_FALSE(window.layer_z());
      walked += found.walked;
    }
  }
  EXPECT_LT(walked, 6 * lanes_here().size() * kRays / 2) << "most must not be walked, or this tests nothing";
}

// Kills sorting rays that go each their own way, and a decision that leaves some of them out.
TEST(DenseFan, WalksEachWhereFewGoSideBySide) {
  std::mt19937_64 random(7);
  const RayFan fan = fan_from({0.1, -0.2, 0.3}, 1.0);
  std::vector<Eigen::Vector3d> ends_m;
  for (int i = 0; i < 10000; ++i) {
    ends_m.emplace_back(uniform(random, -60.0, 60.0), uniform(random, -60.0, 60.0), uniform(random, -60.0, 60.0));
  }
  const Marks expected = walked_one_by_one(fan, ends_m);
  ScanWindow window;
  const Marks found = walked_as_fan(widest_lanes(), fan, ends_m, 64, window);
  EXPECT_EQ(found.walked, ends_m.size());
  expect_same_cells(found, expected);
}

// Kills what a scan keeps of the fan before, where windows grow and shrink with the range; the same for a copy of it.
TEST(DenseFan, AScanMayBeUsedAgain) {
  const Lattice lattice(1.0);
  ScanUpdate used;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Eigen::Vector3d from_m = drawn_start(random);
    const PointScan scan{from_m, bundles(random, from_m, seed % 2 == 0 ? 12.0 : 50.0)};
    ScanUpdate fresh, copied = used;
    OccupancyMap expected, found, of_copy;
    for (auto [update, map] : {std::pair(&fresh, &expected), std::pair(&used, &found), std::pair(&copied, &of_copy)}) {
      trace_points(lattice, scan, {}, *update);
      ASSERT_TRUE(map->apply(*update));
      update->clear();
    }
    ASSERT_FALSE(expected.empty());
    ASSERT_EQ(test::first_difference(test::nodes_of(found), test::nodes_of(expected)), "");
    ASSERT_EQ(test::first_difference(test::nodes_of(of_copy), test::nodes_of(expected)), "");
  }
}

}  // namespace
}  // namespace pingvox::detail
