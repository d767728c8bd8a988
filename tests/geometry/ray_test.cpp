#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <tuple>

#include "geometry/internal/ray_bresenham.hpp"
#include "geometry/internal/ray_dda.hpp"
#include "support/cells_as_text.hpp"
#include "support/differences.hpp"
#include "support/exact_segment.hpp"
#include "support/random_segments.hpp"
#include "support/rounds.hpp"

using namespace pingvox;
using test::as_text;
using test::ExactSegment;
using test::metres;
using test::RandomSegments;
using Cell = ExactSegment::Cell;
using Point = ExactSegment::Point;

namespace {

static_assert(std::ranges::view<KeyRange<DdaStepper<std::uint16_t>>>);
static_assert(std::ranges::input_range<KeyRange<BresenhamStepper<WideWord>>>);

/// A key counted from the centre of its lattice.
template <KeyWord W>
Cell from_centre(const BasicKey<W>& key, int depth) {
  const WideWord half = WideWord{1} << (depth - 1);
  const auto axis = [&](W word) { return static_cast<std::int64_t>(static_cast<WideWord>(word) - half); };
  return {axis(key.x), axis(key.y), axis(key.z)};
}

template <KeyWord W>
std::vector<Cell> dda_cells(const Lattice& lattice, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m) {
  std::vector<Cell> cells;
  const auto ray = dda<W>(lattice, from_m, to_m);
  EXPECT_TRUE(ray);
  if (!ray) return cells;
  for (const BasicKey<W> key : *ray) cells.push_back(from_centre(key, lattice.depth()));
  return cells;
}

std::int64_t manhattan(const Cell& a, const Cell& b) {
  return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
}

/// What the contract says of the cells of one traversal. @return cells that differ from those of exact arithmetic
std::size_t check_traversal(const std::vector<Cell>& cells, const Point& from, const Point& to) {
  const ExactSegment segment(from, to);
  const Cell start = ExactSegment::cell_of(from), end = ExactSegment::cell_of(to);
  EXPECT_EQ(cells.size(), static_cast<std::size_t>(manhattan(start, end)));
  if (cells.empty()) return 0;
  EXPECT_EQ(cells.front(), start);
  EXPECT_EQ(manhattan(cells.back(), end), 1);
  for (std::size_t i = 1; i < cells.size(); ++i) {
    if (manhattan(cells[i - 1], cells[i]) != 1) {
      ADD_FAILURE() << "a jump after cell " << i;
      return 0;
    }
  }
  const std::vector<Cell> exact = segment.cells();
  if (cells == exact) return 0;
  std::size_t different = 0;
  const std::set<Cell> walked(cells.begin(), cells.end()), crossed(exact.begin(), exact.end());
  for (const Cell& cell : walked) {
    if (crossed.count(cell) != 0) continue;
    ++different;
    EXPECT_TRUE(segment.meets(cell, ExactSegment::kGraze)) << cell[0] << ' ' << cell[1] << ' ' << cell[2];
  }
  for (const Cell& cell : crossed) {
    if (walked.count(cell) != 0) continue;
    ++different;
    EXPECT_FALSE(segment.meets(cell, -ExactSegment::kGraze)) << cell[0] << ' ' << cell[1] << ' ' << cell[2];
  }
  return different;
}

TEST(Dda, CrossesTheCellsOfTheExactSegment) {
  std::size_t cells = 0, different = 0;
  const auto run = [&](const Lattice& lattice, std::int64_t reach, std::size_t count) {
    RandomSegments segments(static_cast<std::uint64_t>(reach), reach);
    for (std::size_t i = 0; i < test::rounds(count); ++i) {
      SCOPED_TRACE(testing::Message() << "reach " << reach << ", segment " << i);
      const auto [from, to] = segments.next();
      with_key_word(lattice.depth(), [&, from = from, to = to]<KeyWord W>() {
        const auto walked =
            dda_cells<W>(lattice, metres(from, lattice.resolution_m()), metres(to, lattice.resolution_m()));
        cells += walked.size();
        different += check_traversal(walked, from, to);
      });
    }
  };
  run(Lattice(1.0, 3), 3, 2'000);
  run(Lattice(0.125, 8), 100, 5'000);
  run(Lattice(0.5), 100, 5'000);
  run(Lattice(0.25), 30'000, 40);
  run(Lattice(1.0, 17), 1'000, 500);
  run(Lattice(1.0, 32), 1'000'000, 6);
  run(Lattice(1.0, 65), 1'000, 500);
  run(Lattice(2.0, 128), 1'000, 500);
  EXPECT_GT(cells, test::rounds(10'000'000));
  // Where a segment runs through edges and corners, rounding may choose; anywhere else it hardly ever comes into it.
  EXPECT_LT(different * 500, cells);
  RecordProperty("cells", static_cast<int>(cells));
  RecordProperty("different", static_cast<int>(different));
}

TEST(Dda, OfAnyResolutionStaysWithinAHairOfTheSegment) {
  std::mt19937_64 random(7);
  std::size_t checked = 0;
  const auto metre = [&] { return (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5) * 100.0; };
  for (std::size_t i = 0; i < test::rounds(3'000); ++i) {
    SCOPED_TRACE(i);
    const double resolution_m = std::array{0.05, 0.1, 0.0125, 0.3}[random() % 4];
    const Lattice lattice(resolution_m);
    const Eigen::Vector3d from_m(metre(), metre(), metre()), to_m(metre(), metre(), metre());
    // In cells, rounded by a thousandth of what counts as a hair.
    const auto exact = [&](const Eigen::Vector3d& point_m) {
      const auto axis = [&](int k) { return std::llround(std::ldexp(point_m[k] * (1.0 / resolution_m), 40)); };
      return Point{axis(0), axis(1), axis(2)};
    };
    const ExactSegment segment(exact(from_m), exact(to_m));
    const auto cells = dda_cells<std::uint16_t>(lattice, from_m, to_m);
    for (const Cell& cell : cells) ASSERT_TRUE(segment.meets(cell, ExactSegment::kGraze));
    const std::set<Cell> walked(cells.begin(), cells.end());
    for (const Cell& cell : segment.cells()) {
      if (walked.count(cell) == 0) {
        ASSERT_FALSE(segment.meets(cell, -ExactSegment::kGraze));
      }
    }
    checked += cells.size();
  }
  EXPECT_GT(checked, test::rounds(1'000'000));
}

TEST(Dda, WalksTheSameCellsOnEveryKeyWidth) {
  RandomSegments segments(11, 100);
  std::size_t walked = 0;
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const auto [from, to] = segments.next();
    const Eigen::Vector3d from_m = metres(from, 1.0), to_m = metres(to, 1.0);
    const auto expected = dda_cells<std::uint8_t>(Lattice(1.0, 8), from_m, to_m);
    for (const int depth : {8, 16, 17, 32, 33, 64, 65, 128}) {
      with_key_word(depth, [&]<KeyWord W>() {
        EXPECT_EQ(dda_cells<W>(Lattice(1.0, depth), from_m, to_m), expected) << depth << " levels";
      });
      EXPECT_EQ(dda_cells<WideWord>(Lattice(1.0, depth), from_m, to_m), expected) << depth << " levels, wide";
      walked += expected.size();
    }
  }
  EXPECT_GT(walked, 100'000U);
}

TEST(Dda, ReachesFromCornerToCornerOfTheLattice) {
  for (const int depth : {1, 2, 8, 16}) {
    const Lattice lattice(1.0, depth);
    const double border = std::ldexp(1.0, depth - 1);
    const double last = std::nextafter(border, 0.0);
    const auto cells = dda_cells<std::uint16_t>(lattice, {-border, last, -border}, {last, -border, last});
    EXPECT_EQ(cells.size(), 3 * ((std::size_t{1} << depth) - 1)) << depth;
    EXPECT_FALSE(dda<std::uint16_t>(lattice, {0.0, 0.0, 0.0}, {border, 0.0, 0.0}));
    EXPECT_FALSE(dda<std::uint16_t>(lattice, {std::nextafter(-border, -1e9), 0.0, 0.0}, {0.0, 0.0, 0.0}));
  }
}

// Kills sums without what is below 2^-62 of the length: they drift by up to a step a face.
TEST(Dda, OfALongSegmentKeepsTheOrderOfTheFacesToItsEnd) {
  const Lattice lattice(1.0, 32);
  constexpr std::int64_t kX = (std::int64_t{1} << 22) - 3, kY = 2'592'302;  // one is odd, the other even
  const auto ray = dda<std::uint32_t>(lattice, {0.5, 0.5, 0.5}, {0.5 + double{kX}, 0.5 + double{kY}, 0.5});
  ASSERT_TRUE(ray);
  std::int64_t x = 0, y = 0;
  std::optional<BasicKey<std::uint32_t>> before;
  for (const auto key : *ray) {
    if (before) {
      // Face n of x lies at (n + 1/2) / kX of the way: these are compared as whole numbers, and no two are equal.
      const bool is_x = (2 * x + 1) * kY < (2 * y + 1) * kX;
      ASSERT_EQ(key.x - before->x, is_x ? 1U : 0U) << x << " " << y;
      ASSERT_EQ(key.y - before->y, is_x ? 0U : 1U) << x << " " << y;
      ++(is_x ? x : y);
    }
    before = key;
  }
  EXPECT_EQ(x + y, kX + kY - 1);
}

TEST(Dda, OfATinySegmentCrossesTheOneFaceBetweenItsEnds) {
  const Lattice lattice(1.0);
  for (const double hair : {1e-20, 1e-300, 5e-324}) {
    EXPECT_EQ(dda_cells<std::uint16_t>(lattice, {-hair, 0.5, 0.5}, {hair, 0.5, 0.5}), (std::vector<Cell>{{-1, 0, 0}}));
    EXPECT_EQ(dda_cells<std::uint16_t>(lattice, {0.0, 0.5, 0.5}, {-hair, 0.5, 0.5}), (std::vector<Cell>{{0, 0, 0}}));
    EXPECT_TRUE(dda_cells<std::uint16_t>(lattice, {0.0, 0.5, 0.5}, {hair, 0.5, 0.5}).empty());
  }
}

TEST(Dda, RefusesWalksThatWouldNeverEndAndEndsThatAreNoPoints) {
  const Lattice deep(1.0, 128);
  EXPECT_FALSE(dda<WideWord>(deep, {0.0, 0.0, 0.0}, {1e30, 0.0, 0.0}));
  EXPECT_FALSE(dda<WideWord>(deep, {0.0, 0.0, 0.0}, {std::nan(""), 0.0, 0.0}));
  EXPECT_TRUE(dda<WideWord>(deep, {1e30, 0.0, 0.0}, {1e30, 0.0, 0.0}));
}

TEST(Bresenham, ShallowRayLeavesItsEndCellOut) {
  EXPECT_EQ(as_text(bresenham(Key{0, 0, 0}, Key{6, 2, 0})),
            "##....\n"
            "..###.\n"
            ".....#\n");
}

template <KeyWord W>
void check_bresenham(const BasicKey<W>& from, const BasicKey<W>& to) {
  __extension__ typedef __int128 Wide;
  const auto distance = [](W a, W b) { return static_cast<Wide>(b) - static_cast<Wide>(a); };
  const std::array<Wide, 3> along{distance(from.x, to.x), distance(from.y, to.y), distance(from.z, to.z)};
  Wide main = 0;
  for (const Wide length : along) main = std::max(main, length < 0 ? -length : length);
  Wide step = 0;
  std::array<Wide, 3> before{};
  for (const BasicKey<W> key : bresenham(from, to)) {
    const std::array<Wide, 3> at{distance(from.x, key.x), distance(from.y, key.y), distance(from.z, key.z)};
    Wide moved = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // At most half a cell off the line, which has come step / main of its way; exactly between two cells, it is the
      // nearer one.
      const Wide off = at[axis] * main - step * along[axis];
      const Wide behind = along[axis] < 0 ? off : -off;
      ASSERT_LE(2 * behind, main) << "step " << static_cast<long>(step);
      ASSERT_LT(-2 * behind, main) << "step " << static_cast<long>(step);
      const Wide change = at[axis] - before[axis];
      moved = std::max(moved, change < 0 ? -change : change);
    }
    ASSERT_EQ(moved, step == 0 ? 0 : 1);
    before = at;
    ++step;
    ASSERT_LE(step, main);
  }
  ASSERT_EQ(step, main);
}

// Kills a line exactly between two cells that takes the farther one.
TEST(Bresenham, StaysWithinHalfACellAndTakesOneStepAlongItsMainAxisAtATime) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 20'000; ++i) {
    SCOPED_TRACE(i);
    const auto word8 = [&] {
      constexpr std::array<std::uint8_t, 4> kBorder{0, 1, 254, 255};
      return random() % 3 == 0 ? kBorder[random() % 4] : static_cast<std::uint8_t>(random());
    };
    const BasicKey<std::uint8_t> from{word8(), word8(), word8()}, to{word8(), word8(), word8()};
    ASSERT_NO_FATAL_FAILURE(check_bresenham(from, to));
    // Wider keys walk the same cells.
    std::vector<Key> narrow, wide;
    for (const auto key : bresenham(from, to)) narrow.push_back(key.as<std::uint16_t>());
    for (const auto key : bresenham(from.as<WideWord>(), to.as<WideWord>())) wide.push_back(key.as<std::uint16_t>());
    ASSERT_EQ(test::first_difference(narrow, wide), "");
  }
  for (int i = 0; i < 50; ++i) {
    SCOPED_TRACE(i);
    const auto word16 = [&] { return static_cast<std::uint16_t>(random()); };
    ASSERT_NO_FATAL_FAILURE(check_bresenham(Key{word16(), 0, word16()}, Key{word16(), 65535, word16()}));
    const auto word64 = [&] { return ~(random() % 3'000); };
    ASSERT_NO_FATAL_FAILURE(check_bresenham(BasicKey<std::uint64_t>{word64(), word64(), word64()},
                                            BasicKey<std::uint64_t>{word64(), word64(), word64()}));
  }
  const auto nothing = bresenham(Key{5, 6, 7}, Key{5, 6, 7});
  EXPECT_TRUE(nothing.begin() == nothing.end());
}

}  // namespace
