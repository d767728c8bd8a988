#include "pingvox/geometry/lattice.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

using namespace pingvox;

namespace {

constexpr std::array kDepths{1, 2, 3, 8, 16, 17, 32, 33, 64, 65, 128};

TEST(Lattice, RefusesWhatIsNoGridOfCells) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double resolution_m : {0.0, -0.1, inf, std::nan(""), 5e-324}) {
    const auto lattice = Lattice::make(resolution_m, 16);
    ASSERT_FALSE(lattice) << resolution_m;
    EXPECT_EQ(lattice.error().code, Error::Code::kBadOption);
  }
  for (const int depth : {0, -1, 129}) EXPECT_FALSE(Lattice::make(0.1, depth)) << depth;
  EXPECT_FALSE(Lattice::make(1e300, 128)) << "its edge is no number";
  EXPECT_TRUE(Lattice::make(6e-309, 16)) << "its inverse is a number";
  for (const int depth : kDepths) EXPECT_TRUE(Lattice::make(0.1, depth)) << depth;
}

TEST(Lattice, BordersOfEveryDepthAreHalfOpen) {
  for (const int depth : kDepths) {
    SCOPED_TRACE(depth);
    const Lattice lattice(0.5, depth);
    const double border = std::ldexp(0.25, depth);
    const WideWord half = WideWord{1} << (depth - 1), last = half - 1 + half;
    const auto word = [&](double metre) { return lattice.key_of<WideWord>({metre, 0.0, 0.0}); };
    ASSERT_TRUE(word(0.0) && word(-border) && word(std::nextafter(border, 0.0)) && word(-5e-324));
    EXPECT_TRUE(word(0.0)->x == half);
    EXPECT_TRUE(word(-5e-324)->x == half - 1);
    EXPECT_TRUE(word(-border)->x == 0);
    // Doubles are farther apart than cells out there, when the lattice is deep.
    EXPECT_TRUE(depth > 53 || word(std::nextafter(border, 0.0))->x == last);
    EXPECT_FALSE(word(border));
    EXPECT_FALSE(word(std::nextafter(-border, -1e300)));
    EXPECT_FALSE(word(std::nan("")));
  }
}

// Kills coordinates and keys that round in two ways: 0.15 / 0.05 is below 3, and 0.15 * (1 / 0.05) is 3.
TEST(Lattice, AKeyIsTheFloorOfThePointInCellsOnTypedMultiplesToo) {
  for (const double resolution_m : {0.05, 0.1, 0.0125, 0.02, 0.3, 0.07}) {
    const Lattice lattice(resolution_m);
    for (int n = -2000; n <= 2000; ++n) {
      const Eigen::Vector3d typed_m = Eigen::Vector3d::Constant(std::round(n * resolution_m * 1e6) / 1e6);
      const auto key = lattice.key_of(typed_m);
      ASSERT_TRUE(key);
      ASSERT_EQ(key->x - 32768, std::floor(lattice.in_cells(typed_m).x())) << typed_m.x() << " of " << resolution_m;
    }
  }
}

TEST(Lattice, TheCentreOfACellLiesInTheCellAtEveryDepth) {
  std::mt19937_64 random(1);
  std::size_t checked = 0;
  for (const int depth : kDepths) {
    SCOPED_TRACE(depth);
    const Lattice lattice(0.05, depth);
    with_key_word(depth, [&]<KeyWord W>() {
      for (int i = 0; i < 500; ++i) {
        // Near the centre of the lattice, where doubles can tell the cells apart.
        const WideWord half = WideWord{1} << (depth - 1);
        const WideWord reach = std::min<WideWord>(half, WideWord{1} << 40);
        const auto word = [&] { return static_cast<W>(half - reach + WideWord{random()} % (2 * reach)); };
        const BasicKey<W> key{word(), word(), word()};
        ASSERT_EQ(lattice.key_of<W>(lattice.centre_of(key)), key);
        const int level = static_cast<int>(random() % static_cast<std::uint64_t>(depth + 1));
        const Eigen::Vector3d centre_m = lattice.centre_of(key, level), corner_m = lattice.lowest_corner_of(key, level);
        const double size_m = lattice.cell_size_m(level);
        const Eigen::Vector3d off_m = lattice.centre_of(key) - centre_m;
        ASSERT_LE(off_m.cwiseAbs().maxCoeff(), 0.5 * size_m);
        ASSERT_LE((corner_m.array() + 0.5 * size_m - centre_m.array()).abs().maxCoeff(), 1e-9 * size_m);
        ++checked;
      }
    });
    EXPECT_EQ(lattice.centre_of(WideKey{}, 0), Eigen::Vector3d(0.0, 0.0, 0.0));
  }
  EXPECT_EQ(checked, 500 * kDepths.size());
}

TEST(Lattice, ChildrenShareTheirParentOutToTheLastCorner) {
  const Lattice lattice(1.0, 128);
  const WideKey last{~WideWord{0}, ~WideWord{0}, ~WideWord{0}};
  EXPECT_EQ(lattice.centre_of(last, 1).x(), std::ldexp(1.0, 126));
  EXPECT_EQ(lattice.centre_of(WideKey{}, 1).x(), -std::ldexp(1.0, 126));
  EXPECT_EQ(lattice.lowest_corner_of(WideKey{}, 0).x(), -std::ldexp(1.0, 127));
}

}  // namespace
