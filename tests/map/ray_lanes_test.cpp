#include "map/kernels/ray_lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "map/tree_order.hpp"
#include "pingvox/cloud/trace_points.hpp"
#include "pingvox/map/ray_dda.hpp"
#include "support/fan.hpp"
#include "support/lanes.hpp"
#include "support/uniform.hpp"

namespace pingvox::detail {
namespace {

/// Ends all around, short and long; many on corners, edges and faces of cells, where ties are to be decided alike.
std::vector<Eigen::Vector3d> ends_around(const Eigen::Vector3d& from_m, std::mt19937_64& random, std::size_t count) {
  std::vector<Eigen::Vector3d> ends;
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3d end(40.0 * uniform() - 20.0, 40.0 * uniform() - 20.0, 40.0 * uniform() - 20.0);
    const auto kind = random() % 8;
    if (kind == 0) end = end.array().round();
    if (kind == 1) end = from_m.array() + (end - from_m).array().round();  // at 45 degrees, along axes
    if (kind == 2) end = from_m + 0.01 * end;
    if (kind == 3) end *= 3.0;  // some beyond the window
    if (kind == 4) end[static_cast<Eigen::Index>(random() % 3)] = from_m[static_cast<Eigen::Index>(random() % 3)];
    ends.push_back(end);
  }
  ends.emplace_back(std::nan(""), 0.0, 0.0);
  ends.emplace_back(0.0, std::numeric_limits<double>::infinity(), 0.0);
  ends.emplace_back(0.0, 0.0, -1e300);
  return ends;
}

struct PlacesOfPoints {
  std::vector<std::uint64_t> places;
  std::vector<std::uint32_t> outside;
};

/// Finds the places of cells one by one, and expects them of find_cells on each machine.
/// @tparam Point  what points are given as
template <class Point>
PlacesOfPoints expect_places(const RayFan& fan, std::span<const Point> points) {
  PlacesOfPoints expected;
  constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::uint64_t last = kNone;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d at = points[i].template cast<double>() * fan.cells_per_m;
    std::uint64_t place = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double cell = std::floor(at[static_cast<Eigen::Index>(a)]);
      if (!(cell >= fan.lowest[a] && cell <= fan.highest[a])) place = kNone;
      if (place == kNone) break;
      place |= spread_bits(static_cast<std::uint64_t>(static_cast<std::int64_t>(cell) - fan.window_lowest[a])) << a;
    }
    if (place == kNone) expected.outside.push_back(static_cast<std::uint32_t>(i));
    if (place != kNone && place != last) expected.places.push_back(place);
    last = place;
  }
  for (const Lanes lanes : lanes_here()) {
    SCOPED_TRACE(static_cast<int>(lanes));
    std::vector<std::uint64_t> places(points.size() + kWrittenBeyond);
    std::vector<std::uint32_t> outside;
    places.resize(find_cells(lanes, fan, points, places, outside));
    EXPECT_EQ(places, expected.places);
    EXPECT_EQ(outside, expected.outside);
  }
  return expected;
}

template <class Point>
void expect_cells_of_points_in_a_row() {
  std::size_t found_once = 0, found_outside = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const RayFan fan = fan_from({0.3, -0.1, 0.2}, 1.3);
    std::vector<Point> points;
    for (const Eigen::Vector3d& end : ends_around({0.3, -0.1, 0.2}, random, random() % 30)) {
      for (auto n = random() % 12; n > 0; --n) points.push_back(end.cast<typename Point::Scalar>());
    }
    const PlacesOfPoints expected = expect_places(fan, std::span<const Point>(points));
    found_once += points.size() - expected.places.size();
    found_outside += expected.outside.size();
  }
  EXPECT_GT(found_once, 1000U);
  EXPECT_GT(found_outside, 100U);
}

// Kills a cell that is left out where points come back to it, or where a vector begins; one that is named twice in a
// row within a vector or across two; a point outside that is named as a cell, or not told; points of the last, short
// vector that are made up.
TEST(RayLanes, FindTheCellsOfPointsInARow) {
  expect_cells_of_points_in_a_row<Eigen::Vector3d>();
}
// Kills coordinates that change places on their way from single precision, and cells that are found in it.
TEST(RayLanes, FindTheCellsOfPointsInSinglePrecision) {
  expect_cells_of_points_in_a_row<Eigen::Vector3f>();
}

/// A window of 2^bits cells an axis, so many cells from the map's origin, cut by a lattice that ends there.
RayFan window_at(double resolution_m, int bits, double centre, double border) {
  RayFan fan;
  fan.cells_per_m = 1.0 / resolution_m;
  for (std::size_t a = 0; a < 3; ++a) {
    const double lowest = (a == 1 ? -centre : centre) - std::ldexp(1.0, bits - 1);
    fan.window_lowest[a] = static_cast<std::int64_t>(lowest);
    fan.lowest[a] = std::max(lowest, -border);
    fan.highest[a] = std::min(lowest + std::ldexp(1.0, bits), border) - 1.0;
  }
  return fan;
}

/// A coordinate in the window or near it [m], many where it takes most to tell the cell.
float coordinate_in(const RayFan& fan, std::size_t axis, std::mt19937_64& random) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kLeast = std::numeric_limits<float>::denorm_min();
  const double lowest = static_cast<double>(fan.window_lowest[axis]), cells = fan.highest[axis] + 1.0 - lowest;
  const double cell = lowest + cells * static_cast<double>(random() >> 11) * 0x1p-53;
  const auto at_m = static_cast<float>(cell / fan.cells_per_m);
  const auto border_m = static_cast<float>(std::floor(cell) / fan.cells_per_m);
  const std::array<float, 8> rare{0.0F,      -0.0F,      kLeast,        -kLeast,
                                  kInfinity, -kInfinity, std::nanf(""), -std::numeric_limits<float>::max()};
  switch (random() % 64) {
    case 0:
      return rare[random() % rare.size()];
    case 1:
      return static_cast<float>((random() % 2 == 0 ? fan.lowest[axis] : fan.highest[axis] + 1.0) / fan.cells_per_m);
    case 2:
      return static_cast<float>((lowest + (cell - lowest) * 3.0) / fan.cells_per_m);
    case 3:
      return std::ldexp(at_m, static_cast<int>(random() % 60));
    default:
      break;
  }
  switch (random() % 6) {
    case 0:
      return std::nextafter(border_m, -kInfinity);
    case 1:
      return std::nextafter(border_m, kInfinity);
    case 2:
      return border_m;
    case 3:
      return std::round(at_m);  // whole metres: often on a border, when rounded
    default:
      return at_m;
  }
}

// Kills a cell that single precision finds on the wrong side of its border (far from the origin of the map, where the
// scale is no float, where only the product in double precision is on the border), one at the ends of window or lattice
// or of its numbers, numbers that are no coordinates and become cells, vectors half of which are forgotten.
TEST(RayLanes, FindTheCellsOfFloatsWhereverTheWindowIs) {
  std::size_t found = 0, outside = 0, told_by_doubles = 0, rounded_up = 0;
  for (std::uint64_t seed = 1; seed <= 4000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const double resolution_m = std::array{0.0125, 0.05, 0.1, 0.15, 0.3, 0.35, 0.7, 1.0, 3.0}[random() % 9];
    const double centre =
        std::round(std::array{0.0, 10.0, 100.0, 10'000.0, 100'000.0, 3e7}[random() % 6] / resolution_m);
    const int bits = 4 + static_cast<int>(random() % 8);
    const double border = random() % 4 == 0 ? centre + static_cast<double>(random() % (1U << (bits - 1))) : 0x1p40;
    RayFan fan = window_at(resolution_m, bits, centre, border);
    if (random() % 64 == 0) fan.highest.fill(-std::numeric_limits<double>::infinity());  // from outside of the lattice
    std::vector<Eigen::Vector3f> points(random() % 100);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i > 0) points[i] = points[i - 1];
      for (std::size_t a = 0; a < 3; ++a) {
        if (i == 0 || random() % 4 == 0) points[i][static_cast<Eigen::Index>(a)] = coordinate_in(fan, a, random);
      }
    }
    const PlacesOfPoints expected = expect_places(fan, std::span<const Eigen::Vector3f>(points));
    ASSERT_FALSE(HasFailure());
    found += expected.places.size();
    outside += expected.outside.size();
    for (const Eigen::Vector3f& point : points) {
      for (const float x : point) {
        if (!(std::abs(x) < 1e6F)) continue;
        const double product = static_cast<double>(x) * fan.cells_per_m;
        const double of_floats = static_cast<double>(x) * static_cast<double>(static_cast<float>(fan.cells_per_m));
        if (std::floor(product) != std::floor(of_floats)) ++told_by_doubles;
        const double beyond = std::fma(static_cast<double>(x), fan.cells_per_m, -std::floor(product));
        if (beyond < 0.0) ++rounded_up;
      }
    }
  }
  EXPECT_GT(found, 50'000U);
  EXPECT_GT(outside, 20'000U);
  EXPECT_GT(told_by_doubles, 10'000U);
  EXPECT_GT(rounded_up, 1000U);
}

// Kills a scale that is too near where products are rounded, one below one that makes nothing of the least numbers:
// one point at a time, so that no other one of its vector sends it to the doubles.
TEST(RayLanes, FindTheCellOfAFloatNextToABorder) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kLeast = std::numeric_limits<float>::denorm_min();
  // Scales that are nearly half-way between two floats: the nearest is on one side, the margin needed on the other.
  const double above_half = 1.0 / (static_cast<double>(1.99F) - 0.49 * 0x1p-23);
  const double below_half = 1.0 / (static_cast<double>(1.99F) + 0.49 * 0x1p-23);
  for (const double resolution_m :
       {0.05, 0.0625, 0.1, 0.35, 0.7, 1.0, 1.1, 1.5, 2.0, 2.5, 2.9, 3.0, above_half, below_half}) {
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
      SCOPED_TRACE(testing::Message() << resolution_m << " m, seed " << seed);
      std::mt19937_64 random(seed);
      const double far = std::floor(std::exp2(test::uniform(random, 0.0, 14.5)));
      const double border = seed % 4 < 2 ? far : -far;
      const RayFan fan = window_at(resolution_m, 9, border, 0x1p40);
      const double beside = (border + 0.5) * resolution_m;
      auto x = static_cast<float>(border * resolution_m);
      for (auto steps = random() % 3; steps > 0; --steps) x = std::nextafter(x, seed % 2 == 0 ? kInfinity : -kInfinity);
      const Eigen::Vector3f point(x, -static_cast<float>(beside), static_cast<float>(beside));
      expect_places(fan, std::span(&point, 1));
      ASSERT_FALSE(HasFailure());
    }
    const RayFan fan = window_at(resolution_m, 9, 0.0, 0x1p40);
    const auto middle = static_cast<float>(0.5 * resolution_m);
    for (const float x :
         {0.0F, -0.0F, kLeast, -kLeast, 3.0F * kLeast, -3.0F * kLeast, -std::numeric_limits<float>::min()}) {
      SCOPED_TRACE(testing::Message() << resolution_m << " m, " << x);
      const Eigen::Vector3f point(x, middle, -middle);
      expect_places(fan, std::span(&point, 1));
    }
  }
}

// Kills axes that are mixed up, a bit of a place that is lost, the last cells when they fill no vector; a middle that
// is not the lattice's to the last bit.
TEST(RayLanes, FindTheMiddlesOfCells) {
  const Lattice lattice(0.05);
  std::mt19937_64 random(1);
  for (std::size_t count = 0; count <= 40; ++count) {
    SCOPED_TRACE(count);
    RayFan fan;
    for (std::int64_t& lowest : fan.window_lowest) lowest = static_cast<std::int64_t>(random() % 16384) - 8192;
    std::vector<std::uint64_t> places(count);
    std::vector<Eigen::Vector3d> expected;
    for (std::uint64_t& place : places) {
      place = random() >> (64 - 3 * ScanWindow::kMostBits);
      const BasicKey<std::uint64_t> at = key_of_code(place);
      const auto word = [&](std::size_t axis, std::uint64_t n) {
        return static_cast<std::uint16_t>(32768 + fan.window_lowest[axis] + static_cast<std::int64_t>(n));
      };
      expected.push_back(lattice.centre_of(Key{word(0, at.x), word(1, at.y), word(2, at.z)}));
    }
    for (const Lanes lanes : lanes_here()) {
      std::vector<Eigen::Vector3d> middles(count);
      find_middles(lanes, fan, lattice.resolution_m(), places, middles);
      ASSERT_EQ(middles, expected);
    }
  }
}

// Kills a lane that takes another face than the plain stepper (ties, backward steps, ends on faces), a carry that does
// not reach the next bit of its axis, a ray that marks its end, lanes that go on marking when their ray has ended.
TEST(RayLanes, MarkTheCellsOfFaceCrossings) {
  std::size_t marked = 0, taken = 0, left_out = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const double cells_per_m = seed % 3 == 0 ? 1.0 : 1.7;
    Eigen::Vector3d from(0.1 * static_cast<double>(random() % 37), -0.2, 0.05 * static_cast<double>(random() % 100));
    if (seed % 4 == 0) from = Eigen::Vector3d::Zero();
    const RayFan fan = fan_from(from, cells_per_m);
    const std::vector<Eigen::Vector3d> ends = ends_around(from, random, 1 + random() % 100);
    for (const Lanes lanes : lanes_here()) {
      SCOPED_TRACE(static_cast<int>(lanes));
      std::vector<ReadyRay> ready;
      std::vector<std::uint32_t> others;
      prepare_rays(lanes, fan, std::span<const Eigen::Vector3d>(ends), ready, others);
      ASSERT_EQ(ready.size() + others.size(), ends.size());
      left_out += others.size();

      std::set<std::uint64_t> expected, hit;
      std::size_t number = 0;
      for (std::size_t i = 0; i < ends.size(); ++i) {
        const Eigen::Vector3d to = ends[i] * cells_per_m;
        const bool inside = (to.array() >= -64.0).all() && (to.array() < 64.0).all();
        if (std::find(others.begin(), others.end(), i) != others.end()) continue;
        ASSERT_TRUE(inside);
        ASSERT_EQ(ready[number++].end, place_of(cell_of(to)));
        ++taken;
        FaceCrossings crossings(fan.from, to);
        std::array<std::int64_t, 3> cell = cell_of(fan.from);
        while (crossings.left() > 0) {
          expected.insert(place_of(cell));
          const std::size_t axis = crossings.next_axis();
          cell[axis] += crossings.is_ahead(axis) ? 1 : -1;
          crossings.cross(axis);
        }
        ASSERT_EQ(cell, cell_of(to));
      }

      ScanWindow window;
      window.open(kWindowBits);
      mark_rays(lanes, ready, start_of(fan), MissesIn::kMask, window);
      std::set<std::uint64_t> found;
      for (std::uint64_t place = 0; place < std::uint64_t{1} << (3 * kWindowBits); ++place) {
        if (((window.missed()[place / 64] >> (place % 64)) & 1) == 0) continue;
        found.insert(place);
        const std::uint64_t page = place >> ScanWindow::kPageCellBits;
        ASSERT_EQ(window.touched()[page], 1);
      }
      ASSERT_EQ(found, expected);
      marked += found.size();
    }
  }
  EXPECT_GT(marked, 100'000U);
  EXPECT_GT(taken, 4'000U * lanes_here().size());
  EXPECT_GT(left_out, 500U);
}

/// Places that are marked as missed in a window, wherever.
std::set<std::uint64_t> missed_in(ScanWindow& window) {
  std::set<std::uint64_t> missed;
  for (std::uint64_t place = 0; place < std::uint64_t{1} << (3 * kWindowBits); ++place) {
    const std::uint64_t flat = without_z(place);
    const bool is_in_layer =
        window.layer_z() == (place & kAxisBits[2]) && ((window.layer()[flat / 64] >> (flat % 64)) & 1) != 0;
    if (is_in_layer || ((window.missed()[place / 64] >> (place % 64)) & 1) != 0) missed.insert(place);
  }
  return missed;
}

/// Ends in the layer of cells where rays begin: anywhere in the window, at its borders, on corners of cells.
std::vector<Eigen::Vector3d> ends_in_layer(const Eigen::Vector3d& from, std::mt19937_64& random) {
  std::vector<Eigen::Vector3d> ends;
  for (auto n = 20 + random() % 60; n > 0; --n) {
    Eigen::Vector3d end;
    for (const Eigen::Index a : {0, 1}) {
      end[a] = static_cast<double>(random() >> 11) * 0x1p-46 - 64.0;
      if (random() % 8 == 0) end[a] = random() % 2 == 0 ? -64.0 : 63.5;
      if (random() % 8 == 0) end[a] = std::floor(end[a]);
      if (random() % 16 == 0) end[a] = from[a];
    }
    end.z() = std::floor(from.z()) + 0.25 * static_cast<double>(random() % 4);
    ends.push_back(end);
  }
  return ends;
}

// Kills a flat ray that takes another cell than with its third axis (ties, ways back, one axis without faces, borders
// of the window), one that stays in the layer although it or another of its block leaves it (along z only, too), a
// layer at another height, and one that the caller does not look for.
TEST(RayLanes, FlatRaysMarkTheSameCellsInALayer) {
  std::size_t in_layer = 0, in_mask = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto anywhere = [&](double lowest, std::uint64_t cells) {
      return lowest + 0.25 * static_cast<double>(random() % (4 * cells));
    };
    Eigen::Vector3d from(anywhere(-20.0, 40), anywhere(-20.0, 40), anywhere(-64.0, 128));
    if (seed % 4 == 0) from = {-64.0, 63.75, seed % 8 == 0 ? -64.0 : 63.75};
    const RayFan fan = fan_from(from);
    std::vector<Eigen::Vector3d> ends = ends_in_layer(from, random);
    Eigen::Vector3d& one = ends[random() % ends.size()];
    const double beyond = from.z() < 0.0 ? from.z() + 1.0 : from.z() - 1.0;
    if (seed % 3 == 0) one = {seed % 2 == 0 ? from.x() : one.x(), seed % 2 == 0 ? from.y() : one.y(), beyond};
    for (const Lanes lanes : lanes_here()) {
      SCOPED_TRACE(static_cast<int>(lanes));
      std::vector<ReadyRay> ready;
      std::vector<std::uint32_t> others;
      prepare_rays(lanes, fan, std::span<const Eigen::Vector3d>(ends), ready, others);
      const bool is_flat = std::all_of(ready.begin(), ready.end(), [&](const ReadyRay& ray) {
        return ((ray.end ^ start_of(fan)) & kAxisBits[2]) == 0;
      });
      ScanWindow plain, window;
      for (ScanWindow* const each : {&plain, &window}) each->open(kWindowBits);
      mark_rays(Lanes::kOne, ready, start_of(fan), MissesIn::kMask, plain);
      mark_rays(lanes, ready, start_of(fan), MissesIn::kMaskOrLayer, window);
      const std::set<std::uint64_t> found = missed_in(window);
      ASSERT_EQ(found, missed_in(plain));
      if (lanes == Lanes::kOne) continue;
      ASSERT_TRUE(is_flat || !window.layer_z());
      (window.layer_z() ? in_layer : in_mask) += found.size();

      ScanWindow masked;
      masked.open(kWindowBits);
      mark_rays(lanes, ready, start_of(fan), MissesIn::kMask, masked);
      ASSERT_FALSE(masked.layer_z());
      ASSERT_EQ(missed_in(masked), found);
    }
  }
  if (widest_lanes() == Lanes::kOne) return;
  EXPECT_GT(in_layer, 100'000U);
  EXPECT_GT(in_mask, 50'000U);
}

// Kills keys that spill over into the ray behind, a lane that goes on when its ray has ended, a borrow that runs from
// one component of a packed key into the next.
TEST(RayLanes, KeysAreThoseOfTheStepper) {
  const Lattice lattice(0.6);
  std::size_t compared = 0, taken = 0, left_out = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::vector<Segment> segments;
    const std::vector<Eigen::Vector3d> ends = ends_around({0.3, 0.4, 0.1}, random, 40);
    for (std::size_t i = 0; i < ends.size(); ++i) segments.push_back({ends[random() % ends.size()], ends[i]});
    segments.push_back({Eigen::Vector3d::Constant(-19'660.0), Eigen::Vector3d::Constant(19'660.0)});  // to the borders

    std::vector<std::vector<Key>> expected;
    for (const Segment& segment : segments) {
      auto& keys = expected.emplace_back();
      const auto ray = dda<std::uint16_t>(lattice, segment.from_m, segment.to_m);
      if (!ray) continue;
      for (const Key key : *ray) keys.push_back(key);
      compared += keys.size();
    }
    RayKeys found;
    trace_keys(lattice, segments, found);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_TRUE(std::equal(found[i].begin(), found[i].end(), expected[i].begin(), expected[i].end())) << i;
    }

    const KeyGrid grid{1.0 / lattice.resolution_m(), 32768.0};
    for (const Lanes lanes : lanes_here()) {
      SCOPED_TRACE(static_cast<int>(lanes));
      std::vector<ReadyRay> ready(segments.size());
      std::vector<std::uint32_t> others;
      prepare_rays(lanes, grid, segments, ready, others);
      std::vector<std::vector<Key>> written;
      std::vector<Key*> places;
      for (const ReadyRay& ray : ready) written.emplace_back(ray.left + 1);
      for (auto& keys : written) places.push_back(keys.data());
      write_keys(lanes, ready, places);
      for (std::size_t i = 0; i < segments.size(); ++i) {
        if (std::find(others.begin(), others.end(), i) != others.end()) {
          ASSERT_EQ(ready[i].left, 0U);
          ++left_out;
          continue;
        }
        written[i].pop_back();
        ASSERT_EQ(written[i], expected[i]) << i;
        ++taken;
      }
    }
  }
  EXPECT_GT(taken, 3'000U * lanes_here().size());
  EXPECT_GT(left_out, 500U);
  EXPECT_GT(compared, 100'000U);
}

TEST(RayLanes, SpreadBitsAreGatheredAgain) {
  for (std::uint64_t word = 0; word < 2048; ++word) {
    ASSERT_EQ(gathered_bits(spread_bits(word)), word);
    ASSERT_EQ(spread_16_bits(static_cast<std::uint16_t>(word * 32 + 31)), spread_bits(word * 32 + 31));
    ASSERT_EQ(gathered_bits(spread_bits(word) << 1 >> 1 | spread_bits(2047) << 1 | spread_bits(5) << 2), word);
  }
}

}  // namespace
}  // namespace pingvox::detail
