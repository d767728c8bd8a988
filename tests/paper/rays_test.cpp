// Section 6 of the paper: which cells a ray's traversals miss.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "bench/paper/paper_dda.hpp"
#include "bench/paper/ray_cells.hpp"
#include "geometry/internal/ray_dda.hpp"

namespace pingvox::bench {
namespace {

using test::ExactSegment;
using Cell = ExactSegment::Cell;

double share(std::size_t part, std::size_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

TEST(PaperRays, BresenhamMissesAThirdOfTheCrossedCellsInThePlaneAndMostInSpaceAndDdaNone) {
  for (const int dimensions : {2, 3}) {
    SCOPED_TRACE(dimensions);
    RayJudgement line, faces;
    for (const RandomSegment& segment : random_segments(1'000, dimensions, 5)) {
      const ExactSegment exact(segment.from, segment.to);
      line.add(exact, bresenham_cells(segment.from_cells(), segment.to_cells()));
      faces.add(exact, dda_cells(segment.from_cells(), segment.to_cells()));
    }
    ASSERT_GT(faces.crossed, 100'000U);
    EXPECT_NEAR(share(line.missed, line.crossed), dimensions == 2 ? 0.35 : 0.55, 0.03);
    EXPECT_NEAR(share(line.strayed, line.walked), dimensions == 2 ? 0.08 : 0.17, 0.02);
    EXPECT_GT(share(line.diagonal, line.walked), 0.4);
    EXPECT_EQ(faces.missed, 0U);
    EXPECT_EQ(faces.strayed, 0U);
    EXPECT_EQ(faces.diagonal, 0U);
  }
}

TEST(RayJudgement, CountsAMissedAStrayAndADiagonalStep) {
  constexpr std::int64_t kUnit = ExactSegment::kUnit;
  // Along y = 0.25 from cell 0 to cell 4.
  const ExactSegment segment({kUnit / 2, kUnit / 4, kUnit / 2}, {4 * kUnit + kUnit / 2, kUnit / 4, kUnit / 2});
  RayJudgement judgement;
  judgement.add(segment, {{0, 0, 0}, {1, 1, 0}, {2, 1, 0}, {3, 0, 0}});
  EXPECT_EQ(judgement.crossed, 4U);
  EXPECT_EQ(judgement.missed, 2U);
  EXPECT_EQ(judgement.walked, 4U);
  EXPECT_EQ(judgement.strayed, 2U);
  EXPECT_EQ(judgement.diagonal, 2U);
}

std::int64_t apart(const Cell& a, const Cell& b) {
  return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
}

// What figures 11 and 12 show, where a ray ends on faces of cells; and that it is the ends, not how we wrote it down.
TEST(PaperRays, DdaAsWrittenLosesItsEndOnRoundNumbersAndOursDoesNot) {
  const Lattice lattice(0.1);
  std::mt19937_64 random(6);
  std::size_t beyond = 0, travelled = 0;
  constexpr std::size_t kRays = 2'000;
  for (std::size_t i = 0; i < kRays; ++i) {
    SCOPED_TRACE(i);
    const auto axis = [&] { return (static_cast<double>(random() % 200) - 100.0 + 0.5) / 10.0; };
    const double x = axis(), y = axis();
    const Eigen::Vector3d to(x - 0.05, y - 0.05, static_cast<double>(random() % 100 + 1) / 10.0);
    const auto key = lattice.key_of(to);
    ASSERT_TRUE(key);
    const Cell end{key->x - 32768, key->y - 32768, key->z - 32768};
    const auto lost = [&](PaperStop stop) {
      const auto cells = paper_dda<double>(Eigen::Vector3d::Zero(), to, 0.1, stop);
      return cells.empty() || apart(cells.back(), end) != 1 ? 1U : 0U;
    };
    beyond += lost(PaperStop::kBeyondLength);
    travelled += lost(PaperStop::kTravelled);
    const auto walk = dda<std::uint16_t>(lattice, Eigen::Vector3d::Zero(), to);
    ASSERT_TRUE(walk);
    Cell last{};
    for (const Key at : *walk) last = {at.x - 32768, at.y - 32768, at.z - 32768};
    EXPECT_EQ(apart(last, end), 1);
  }
  EXPECT_GT(beyond, kRays / 4);
  EXPECT_GT(travelled, kRays / 10);
}

TEST(PaperRays, DdaAsWrittenWalksTheSameCellsAsOursBetweenPointsInsideOfCells) {
  std::size_t same = 0, all = 0;
  for (const RandomSegment& segment : random_segments(1'000, 3, 7)) {
    const Eigen::Vector3d from = segment.from_cells(), to = segment.to_cells();
    same += paper_dda<double>(from, to, 1.0, PaperStop::kBeyondLength) == dda_cells(from, to) ? 1U : 0U;
    ++all;
  }
  EXPECT_GE(same, all - 1);
}

}  // namespace
}  // namespace pingvox::bench
